/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The last source of a program: ends what mcor_prelude.cl has begun. */
#if MCOR_FOR_SIZE
#pragma clang attribute pop
#endif

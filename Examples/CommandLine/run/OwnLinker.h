// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#ifndef OwnLinker_h
#define OwnLinker_h

/// Has the compiler in this process, PoCL's, link kernels by the small linker beside the library,
/// where there is one and COMPILER_PATH names no other. See core/mcor_link.c.
void UseOwnLinker();

#endif

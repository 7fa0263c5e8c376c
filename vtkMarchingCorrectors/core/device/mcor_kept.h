/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_kept_h
#define mcor_kept_h

/* Compiled kernels that all users of a machine share: PoCL's folder of them, made once by
 * `marching-correctors-compile --keep`, beside the library that holds this code, to be read only. They
 * are for one device, driver and source: the name of the file that says that kernels are ready has all of
 * these in it (mcor_ahead.h). Where that file is not there, for any other machine, nothing is taken.
 * MCOR_KERNEL_DIR is the path of another folder; if it is set and empty, there is none. */

#include "mcor.h"

#include <stdbool.h>
#include <stddef.h>

/* Path of a file beside the library that holds this code; false where that is not known. */
bool mcor_library_path(const char* name, char* path, size_t size);
bool mcor_kept_folder(char* path, size_t size);

/* Copies the kept kernels into PoCL's folder if those that `ready` stands for are among them, as which
 * it is there, too, then. */
bool mcor_take_kept(const char* ready);

/* Lets all users read the folder that is kept. */
bool mcor_share_kept(const char* folder);

/* mcor_keep.c. Compiles the usual surfaces' kernels into the folder that is kept; POCL_CACHE_DIR names it. Bit k of
 * sph_kernels: those of mcor_sph_kernel k. */
mcor_status mcor_keep(mcor_context* context, unsigned sph_kernels, const char* folder);

#endif

/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_cache_h
#define mcor_cache_h

/* Compiled programs kept in files. No OpenCL calls.
 *
 * The folder is MCOR_CACHE_DIR; else marching-correctors in XDG_CACHE_HOME, in HOME/.cache or, on
 * Windows, in LOCALAPPDATA. An empty MCOR_CACHE_DIR turns the cache off. A program that
 * was not used for 90 days is removed when another one is stored. Whatever goes wrong with a
 * file, the program is compiled. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* 128 bits, of all that a compiled program depends on. */
typedef struct mcor_cache_key
{
  uint64_t words[2];
} mcor_cache_key;

/* All zero at first; a text's end counts. */
void mcor_cache_add(mcor_cache_key* key, const char* text);
/* NULL where there is none, or none that is whole. Free with free(). */
void* mcor_cache_load(const mcor_cache_key* key, size_t* size);
/* Readers see the whole file or none, also where two write it at once. */
void mcor_cache_store(const mcor_cache_key* key, const void* data, size_t size);

/* Makes a path's folders; false where one is missing then. */
bool mcor_make_folders(const char* path);

/* Where none of POCL_CACHE_DIR, XDG_CACHE_HOME and HOME is set, PoCL compiles into a folder that any user may
 * have made, and runs what is there: sets POCL_CACHE_DIR to one of this user's alone. Before drivers are
 * started. */
void mcor_own_pocl_folder(void);
/* The folder into which PoCL compiles. */
void mcor_pocl_folder(char* path, size_t size);
/* What is wrong with the folder into which PoCL compiles, without which it has no device: a sentence
 * that ends in what to do. False: nothing is. */
bool mcor_pocl_folder_fault(char* text, size_t size);

#endif

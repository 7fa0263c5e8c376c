/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_system_h
#define mcor_system_h

/* What differs between operating systems: mcor_system_posix.c, or mcor_system_windows.c. Paths and
 * values of variables are UTF-8. Threads are pthreads everywhere: on Windows of MinGW's runtime. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define MCOR_PATH_LIMIT 1024

/* The machine's processors; `usable`: those of them that the calling thread may use. At least 1. */
int mcor_system_processors(int* usable);
/* Bytes of the machine's memory; 0: not known. */
uint64_t mcor_system_memory(void);

/* `alignment`: a power of 2. NULL where there is no memory. */
void* mcor_system_allocate(size_t alignment, size_t bytes);
void mcor_system_release(void* memory);
/* Asks for large pages, where the system has such a question. */
void mcor_system_want_large_pages(void* memory, size_t bytes);

/* The environment's variable, which is a path, with / between its parts; false where it is not set, or does not fit. */
bool mcor_system_variable(const char* name, char value[MCOR_PATH_LIMIT]);
/* Where this user's caches are, if XDG_CACHE_HOME does not say it. */
bool mcor_system_cache_folder(char path[MCOR_PATH_LIMIT]);

/* True where it is there then. */
bool mcor_system_make_folder(const char* path);
/* To read: a file of this user and no link, as what is in it is run. */
FILE* mcor_system_open_own(const char* path);
/* To write: a file that was not there. */
FILE* mcor_system_create(const char* path);
/* Takes the place of a file that is there. */
bool mcor_system_move(const char* from, const char* to);
void mcor_system_remove(const char* path);
/* A file's time is that of its last use. */
void mcor_system_mark_used(const char* path);
/* Removes the folder's files with `part` in their names that were not used for so many days. */
void mcor_system_remove_unused(const char* folder, const char* part, int days);

/* clGetPlatformIDs of the system's OpenCL loader, which stays open: drivers do not bear being closed.
 * NULL where there is none. */
typedef void (*mcor_function)(void);
mcor_function mcor_system_opencl(void);

#endif

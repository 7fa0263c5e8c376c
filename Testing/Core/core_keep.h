/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_keep_h
#define core_keep_h

/* Results in files, for bits.cmake, which compares their hashes with Testing/Regression/bits.csv. If the
 * environment's CORE_KEEP names no folder, nothing is kept. */

#include "core_fixture.h"

/* Appends bytes to the file NAME.PART of the folder. */
void core_keep(const char* name, const char* part, const void* data, size_t bytes);
/* Makes NAME a case of the table: its numbers of points and of cells (triangles, lines), or what else it
 * has. cells < 0: the device lacks what the case needs. */
void core_keep_size(const char* name, int64_t points, int64_t cells);

/* Keeps a surface. Parts: geometry (points, triangles, lines, bands), arrays (of points, and measures), keys,
 * and canonical: triangles and pieces of lines, each from its least corner on, with all that corners have but
 * keys, sorted. It stays the same whatever the order of points and triangles. */
void core_keep_surface(const char* name, const mcor_input* input, mcor_surface* surface);

#endif

/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_keep_h
#define core_keep_h

/* Writes results to files. bits.cmake compares their hashes with Testing/Regression/bits.csv. If CORE_KEEP in the
 * environment names no folder, nothing is written. */

#include "core_fixture.h"

/* Appends bytes to the file NAME.PART in the folder of CORE_KEEP. */
void core_keep(const char* name, const char* part, const void* data, size_t bytes);
/* Makes NAME a case of bits.csv, with two counts: usually of points and of cells (triangles or lines). cells < 0: the
 * device cannot do this case. */
void core_keep_size(const char* name, int64_t points, int64_t cells);

/* Writes a surface in four parts, and its counts. geometry: points, triangles, lines, bands. arrays: all other arrays
 * of points; is_closed, area, volume, length. keys: keys of points and triangles. canonical: the sorted triangles and
 * pieces of lines, each from its least corner on, without keys; the order of points and triangles does not matter. */
void core_keep_surface(const char* name, const mcor_input* input, mcor_surface* surface);

#endif

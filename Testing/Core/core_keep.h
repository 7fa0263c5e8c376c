/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef core_keep_h
#define core_keep_h

/* Writes results to files. bits.cmake compares their hashes with Testing/Regression/bits.csv. If CORE_KEEP in the
 * environment names no folder, nothing is written. */

#include "core_fixture.h"

/* Appends bytes to the file NAME.PART in the folder of CORE_KEEP. */
void core_keep(const char* name, const char* part, const void* data, size_t bytes);
/* Makes NAME a case of bits.csv, with two counts: usually points and cells (triangles, lines). cells < 0: the device
 * cannot do this case. */
void core_keep_size(const char* name, int64_t points, int64_t cells);

/* Writes a surface in four parts. geometry: points, triangles, lines, bands. arrays: all arrays of points, and area,
 * volume, length. keys: of points and triangles. canonical: the sorted triangles and pieces of lines, each from its
 * least corner on, without keys; this part does not depend on the order of points and triangles. */
void core_keep_surface(const char* name, const mcor_input* input, mcor_surface* surface);

#endif

/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef mcor_adaptive_level_h
#define mcor_adaptive_level_h

/* Adaptive cubes, as the other phases see them. Vertices are on edges of their level's lattice: node, offset,
 * gradient and correction are in its cells, 2^level cubes. */

#include "mcor_internal.h"

/* Whether this call's cubes are of several levels. */
static inline bool mcor_is_adaptive(const mcor_context* context)
{
  return context->lattice.top > 0;
}

/* Bricks that are marched, or leaves where there may be surface. */
static inline int mcor_marched_count(const mcor_context* context)
{
  return mcor_is_adaptive(context) ? context->adaptive.count : context->bricks.now.count;
}

/* Slots by keys. */
#define MCOR_SLOT_ARGS(c)                                                                          \
  MCOR_INT((c)->bricks.now.count), MCOR_INT((c)->adaptive.bucket_shift),                           \
    MCOR_BUFFER(&(c)->adaptive.keys), MCOR_BUFFER(&(c)->adaptive.buckets)

/* What evaluates the field at vertices does so level by level:
 *
 *   for (int l = 0; l <= context->lattice.top; ++l)
 *     mcor_level_vertices(context, boundary, l, &first, &count);
 *     mcor_view_level(context, l);
 *     ...
 *   mcor_view_level(context, 0); */

/* Vertices of a level, on lattice edges or of the trim boundary. */
void mcor_level_vertices(
  const mcor_context* context, bool boundary, int level, int* first, int* count);

/* From now on MCOR_GRID_ARGS are in cells of a level. */
mcor_status mcor_view_level(mcor_context* context, int level);

/* Work-items [first, first + count) of a heavy loop. On a CPU, where they are launched at once, so many that
 * they take some 0.1 s, as far as one does not take longer:
 *
 *   mcor_span span = { .end = count };
 *   MCOR_TRY(mcor_next_span(context, &span));
 *   while (span.count > 0)
 *     ... MCOR_INT(span.first), MCOR_INT(span.count) ...
 *     MCOR_TRY(mcor_next_span(context, &span)); */
typedef struct mcor_span
{
  int first, count, end;
  double begin; /* when it began */
} mcor_span;

mcor_status mcor_next_span(mcor_context* context, mcor_span* span);

#endif

/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Which vertices a call counts. Vertices on a seam belong to several ranks, and one of them
 * counts each. The triangles of a box and its ring have one order on all ranks, and the rank
 * whose triangle is the first to use a vertex counts it. Cells in the ring beyond all ranks'
 * boxes, where the whole surface ends, are nobody's. A square of a cap in the ring is another
 * rank's: MCOR_CAP_SQUARE is that bit. */

#include "mcor_box.h"

#include <stdlib.h>

/* *owners: [vertex_count], MCOR_OWN for vertices that this call counts; NULL where all of the
 * lattice is owned. The caller frees it, also after a failure. */
mcor_status mcor_find_counted(mcor_context* context, uint8_t** owners)
{
  const mcor_mesh* mesh = &context->mesh;
  const size_t triangles = (size_t)mesh->triangle_count;
  if (!context->box.is_part)
  {
    return MCOR_OK;
  }
  *owners = calloc((size_t)mesh->vertex_count + 1, 1);
  MCOR_TRY(mcor_allocated(context, *owners));
  void *corners = NULL, *cells = NULL;
  if (triangles == 0)
  {
    return MCOR_OK;
  }
  const mcor_mapping views[] = { { &mesh->triangles, 3 * triangles * sizeof(cl_int), &corners },
    { &context->box.cells, triangles * sizeof(cl_ulong), &cells } };
  const mcor_status status = mcor_map_all(context, views, 2);
  for (size_t i = 0; i < 3 * triangles && status == MCOR_OK; ++i)
  {
    const cl_ulong cell = ((const cl_ulong*)cells)[i / 3];
    uint8_t* of = *owners + ((const cl_int*)corners)[i]; /* of the first triangle with the vertex */
    *of = *of                    ? *of
      : !(cell & MCOR_RING_CELL) ? MCOR_OWN
      : cell & MCOR_OTHERS_CELL  ? MCOR_ANOTHERS
                                 : 0;
  }
  return mcor_unmap_all(context, views, 2, status);
}

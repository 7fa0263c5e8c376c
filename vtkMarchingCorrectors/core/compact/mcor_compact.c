/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Compact contours. Where the surface passes close to a node, Marching Cubes makes slivers.
 * Therefore the vertices of one node that are joined by edges are merged into their mean [Moore and
 * Warren], which then moves along the gradient onto the surface. Triangles with two equal corners
 * vanish.
 *
 * The vertices of one merged vertex are a bunch. If it does not reach the surface, or turns a
 * triangle over, its bunch is taken apart again, which is always possible. This may turn over
 * triangles beside it, so this is done in two rounds. Then the vertices of the remaining slivers
 * move (mcor_compact_face.c).
 *
 * Merged vertices, and vertices that moved, are appended to the mesh. At the end all vertices are
 * sorted by node, because keys need this order. */

#include "mcor_compact.h"
#include "mcor_adaptive.h"
#include "mcor_box.h"
#include "mcor_cap.h"
#include "mcor_parallel.h"

#include <stdlib.h>
#include <string.h>

/* Sets the state of all bunches that lean on bunch `first`. */
static void mcor_drop_leaning(mcor_bunches* bunches, int32_t first, int state)
{
  for (int32_t e = bunches->leans[first] ? -1 : bunches->star[first]; e >= 0;
       e = bunches->before[e])
  {
    const cl_int* corner = bunches->triangles + e / 3 * 3;
    for (int c = 0; c < 3; ++c)
    {
      if (mcor_state_of(bunches, bunches->first[corner[c]]) == MCOR_BUNCH_LEANING)
      {
        mcor_set_state(bunches, bunches->first[corner[c]], state);
      }
    }
  }
}

/* ---- Vertices ---- */

typedef struct mcor_sorted_bunch
{
  uint64_t key;
  int32_t first;
} mcor_sorted_bunch;

/* Returns a key that sorts nodes in the order of vertices. */
static uint64_t mcor_order_key(const mcor_bunches* bunches, const cl_int node[4])
{
  return mcor_node_key(&bunches->context->lattice, node) << 3 | (uint64_t)(node[3] & 3) << 1;
}

static int mcor_compare_bunches(const void* x, const void* y)
{
  const mcor_sorted_bunch *a = x, *b = y;
  return a->key != b->key ? (a->key > b->key) - (a->key < b->key)
                          : (a->first > b->first) - (a->first < b->first);
}

/* Lists the mesh's vertices in order, without cuts and caps. Returns their number. */
static int mcor_order_vertices(mcor_bunches* bunches)
{
  const mcor_sorted_bunch *merged = bunches->sorted, *end = merged + bunches->sorted_count;
  int count = 0;
  for (int32_t v = 0; v <= bunches->march_count; ++v)
  {
    const bool is_last = v == bunches->march_count;
    if (!is_last && mcor_is_merged(bunches, bunches->first[v]) && !bunches->held[v])
    {
      continue; /* a merged vertex is listed at its bunch's node */
    }
    const uint64_t key =
      is_last ? UINT64_MAX : mcor_order_key(bunches, mcor_marched_node(bunches, v));
    for (; merged < end && merged->key < key; ++merged)
    {
      if (mcor_is_merged(bunches, merged->first))
      {
        bunches->order[count++] = -1 - merged->first;
      }
    }
    if (!is_last)
    {
      bunches->order[count++] = v;
    }
  }
  return count;
}

/* Vertices that are being appended to the mesh. They are corrected on lines that begin at `starts`,
 * or, if this is NULL, at the means of bunches. */
typedef struct mcor_adding
{
  const mcor_bunches* bunches;
  const double (*starts)[3]; /* in edges, counted from the nodes */
  cl_int* node;
  uint8_t* data; /* real [][4]: where the lines begin, as offsets */
} mcor_adding;

static void mcor_add_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_adding* to = data;
  const mcor_bunches* bunches = to->bunches;
  const mcor_context* context = bunches->context;
  for (int64_t i = first; i < last; ++i)
  {
    const int32_t v = mcor_vertex_of(bunches->order[i]);
    double start[4] = { 0 };
    int count = 0;
    mcor_entry_node(bunches, bunches->order[i], to->node + 4 * i);
    if (to->starts)
    {
      memcpy(start, to->starts[i], sizeof to->starts[i]);
    }
    for (int32_t w = to->starts ? -1 : v; w >= 0; w = bunches->next[w], ++count)
    {
      const double low = mcor_get_real(context, bunches->ends, 2 * (int64_t)w),
                   high = mcor_get_real(context, bunches->ends, 2 * (int64_t)w + 1);
      const int axis = mcor_marched_node(bunches, w)[3] & 3;
      const bool is_upper = fabs(low) > fabs(high);
      start[axis] += mcor_get_real(context, bunches->offset, 4 * (int64_t)w + axis) - is_upper;
    }
    for (int k = 0; k < 4; ++k)
    {
      mcor_put_real(context, to->data, 4 * i + k, count > 0 ? start[k] / count : start[k]);
    }
  }
  (void)slice;
}

/* Notes that the first `count` vertices of the order are in the mesh from `at` on, and where each
 * level begins. */
static void mcor_note_places(mcor_bunches* bunches, int at, int count, cl_int level_first[])
{
  const int levels = bunches->context->lattice.levels;
  int level = 0;
  for (int i = 0; i < count; ++i)
  {
    const int32_t entry = bunches->order[i];
    *mcor_place_in(bunches, entry) = at + i;
    for (; level < levels &&
         level <= mcor_marched_node(bunches, mcor_vertex_of(entry))[3] >> MCOR_LEVEL_SHIFT;
         ++level)
    {
      level_first[level] = at + i;
    }
  }
  for (; level <= levels; ++level)
  {
    level_first[level] = at + count;
  }
}

mcor_status mcor_add_vertices(mcor_bunches* bunches, const double (*starts)[3], int count)
{
  mcor_context* context = bunches->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t o = (size_t)mesh->vertex_count, n = (size_t)count, real = context->cl.real_size,
               width = 4 * real;
  mcor_buffer* const of_edges[] = { &mesh->linear, &mesh->evaluations, &mesh->ends };
  const size_t widths[] = { real, 1, 2 * real };
  mcor_adding add = { .bunches = bunches,
    .starts = starts,
    .node = malloc(n * 16 + 1),
    .data = malloc(n * width + 1) };
  mcor_status status = mcor_allocated(context, add.node && add.data);
  MCOR_THEN(
    status, mcor_parallel_run(context, count, MCOR_LIGHT_GRAIN, mcor_add_slice, &add, NULL));
  MCOR_THEN(status, mcor_extend_vertices(context, (int)o, (int)(o + n)));
  for (size_t i = 0; i < 3; ++i) /* arrays may lack entries of cuts and caps */
  {
    const size_t old = o * widths[i], size = of_edges[i]->size;
    MCOR_THEN(
      status, mcor_extend(context, of_edges[i], size < old ? size : old, (o + n) * widths[i]));
  }
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->node, o * 16, add.node, n * 16));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->offset, o * width, add.data, n * width));
  free(add.node);
  free(add.data);
  MCOR_TRY(status);
  mcor_note_places(bunches, mesh->vertex_count, count, mesh->level_first[1]);
  mesh->march_count = mesh->vertex_count;
  mesh->vertex_count += count;
  return mcor_launch_correction(context, MCOR_ON_BOUNDARY, true);
}

/* Makes the merged vertices; the mesh has all other vertices. */
static mcor_status mcor_place_vertices(mcor_bunches* bunches)
{
  mcor_sorted_bunch* sorted = bunches->sorted;
  int count = 0;
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    if (mcor_is_merged(bunches, v))
    {
      cl_int node[4];
      mcor_entry_node(bunches, -1 - v, node);
      sorted[bunches->sorted_count++] = (mcor_sorted_bunch){ mcor_order_key(bunches, node), v };
    }
  }
  qsort(sorted, (size_t)bunches->sorted_count, sizeof *sorted, mcor_compare_bunches);
  for (int i = 2; i < bunches->sorted_count; ++i) /* a node has keys for only two merged vertices */
  {
    if (sorted[i].key == sorted[i - 2].key)
    {
      mcor_set_state(bunches, sorted[i].first, MCOR_BUNCH_APART);
      mcor_drop_leaning(bunches, sorted[i].first, MCOR_BUNCH_APART);
    }
  }
  for (int32_t v = 0; v < bunches->vertex_count; ++v)
  {
    bunches->place[v] = v;
  }
  for (int i = 0; i < bunches->sorted_count; ++i)
  {
    if (mcor_is_merged(bunches, sorted[i].first))
    {
      bunches->order[count++] = -1 - sorted[i].first;
    }
  }
  return mcor_add_vertices(bunches, NULL, count);
}

/* Takes apart the bad bunches, and the bunches that lean on them. */
static mcor_status mcor_take_apart(mcor_bunches* bunches)
{
  for (bunches->round = 0; bunches->round < MCOR_COMPACT_ROUNDS; ++bunches->round)
  {
    MCOR_TRY(mcor_find_bad(bunches));
    if (!atomic_load(&bunches->bad))
    {
      return MCOR_OK;
    }
    for (int i = 0; i < bunches->sorted_count; ++i)
    {
      if (mcor_state_of(bunches, bunches->sorted[i].first) == MCOR_BUNCH_BAD)
      {
        mcor_drop_leaning(bunches, bunches->sorted[i].first, MCOR_BUNCH_BAD);
      }
    }
    for (int i = 0; i < bunches->sorted_count; ++i)
    {
      const int32_t first = bunches->sorted[i].first;
      const int state = mcor_state_of(bunches, first);
      if (state == MCOR_BUNCH_BAD || state == MCOR_BUNCH_FRESH)
      {
        mcor_set_state(
          bunches, first, state == MCOR_BUNCH_BAD ? MCOR_BUNCH_FRESH : MCOR_BUNCH_APART);
      }
    }
  }
  return MCOR_OK;
}

/* ---- In order again ---- */

typedef struct mcor_gathering
{
  const int32_t* from;
  size_t width;
  void *in, *out;
} mcor_gathering;

static void mcor_gather_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_gathering* g = data;
  for (int64_t i = first; i < last; ++i)
  {
    memcpy((uint8_t*)g->out + (size_t)i * g->width,
      (const uint8_t*)g->in + (size_t)g->from[i] * g->width, g->width);
  }
  (void)slice;
}

/* Gathers an array's elements, `width` bytes each. */
static mcor_status mcor_gather(
  mcor_context* context, mcor_buffer* array, size_t width, const int32_t* from, int old, int count)
{
  mcor_buffer in = *array;
  mcor_gathering g = { .from = from, .width = width };
  *array = (mcor_buffer){ 0 };
  mcor_status status = mcor_reserve(context, array, (size_t)count * width);
  MCOR_THEN(status, mcor_map(context, &in, (size_t)old * width, false, &g.in));
  MCOR_THEN(status, mcor_map(context, array, (size_t)count * width, true, &g.out));
  MCOR_THEN(
    status, mcor_parallel_run(context, count, MCOR_LIGHT_GRAIN, mcor_gather_slice, &g, NULL));
  const mcor_mapping mapped[] = { { &in, 0, &g.in }, { array, 0, &g.out } };
  status = mcor_unmap_all(context, mapped, 2, status);
  mcor_release(context, &in);
  return status;
}

static mcor_status mcor_gather_vertices(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  mcor_mesh* mesh = &context->mesh;
  const size_t real = context->cl.real_size, means = (size_t)context->attributes.count * real;
  const int old = mesh->vertex_count, march_count = mcor_order_vertices(bunches);
  int count = march_count;
  for (int32_t v = bunches->march_count; v < bunches->vertex_count; ++v)
  {
    bunches->order[count++] = v;
  }
  int32_t* from = malloc((size_t)count * sizeof *from);
  MCOR_TRY(mcor_allocated(context, from));
  for (int i = 0; i < count; ++i)
  {
    from[i] = *mcor_place_in(bunches, bunches->order[i]);
  }
  struct
  {
    mcor_buffer* array;
    size_t width;
  } const arrays[] = { { &mesh->node, 16 }, { &mesh->offset, 4 * real }, { &mesh->linear, real },
    { &mesh->field_value, real }, { &mesh->gradient, 4 * real }, { &mesh->vertex_weight, real },
    { &mesh->evaluations, 1 }, { &mesh->flag, 1 }, { &mesh->means, means } };
  mcor_status status = MCOR_OK;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0] && status == MCOR_OK; ++i)
  {
    status = arrays[i].width > 0
      ? mcor_gather(context, arrays[i].array, arrays[i].width, from, old, count)
      : MCOR_OK;
  }
  free(from);
  MCOR_TRY(status);
  mcor_note_places(bunches, 0, march_count, mesh->level_first[0]);
  const int shift = march_count - bunches->march_count; /* moves the vertices of cuts and caps */
  for (int i = march_count; i < count; ++i)
  {
    bunches->place[i - shift] = i;
  }
  for (int l = 0; l < context->lattice.levels; ++l)
  {
    mesh->level_first[1][l] = bunches->cut_first[l] + shift;
  }
  mesh->cap_first += shift;
  mesh->march_count = march_count;
  mesh->vertex_count = count;
  for (int i = 0; i < bunches->cut_count; ++i)
  {
    cl_ulong* cut = &bunches->cut[i];
    *cut = (cl_ulong)bunches->place[*cut >> 32] << 32 | (cl_ulong)bunches->place[*cut & UINT32_MAX];
  }
  if (bunches->cut_count > 0)
  {
    MCOR_TRY(mcor_write(context, &mesh->cut_edges, bunches->cut,
      (size_t)bunches->cut_count * sizeof *bunches->cut));
  }
  return mcor_find_places(bunches);
}

/* ---- Triangles ---- */

typedef struct mcor_filing
{
  const mcor_bunches* bunches;
  int64_t first[MCOR_SLICES], count[MCOR_SLICES]; /* triangles that are left */
} mcor_filing;

/* Moves a slice's remaining triangles to the slice's beginning. */
static void mcor_file_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_filing* filing = data;
  const mcor_bunches* bunches = filing->bunches;
  int64_t to = first;
  for (int64_t t = first; t < last; ++t)
  {
    int32_t corners[3];
    if (!mcor_places_of(bunches, t, corners))
    {
      continue;
    }
    memcpy(bunches->triangles + 3 * to, corners, sizeof corners);
    if (bunches->cells)
    {
      bunches->cells[to] = bunches->cells[t];
    }
    ++to;
  }
  filing->first[slice] = first;
  filing->count[slice] = to - first;
}

static mcor_status mcor_file_triangles(mcor_bunches* bunches)
{
  mcor_context* context = bunches->context;
  mcor_filing filing = { .bunches = bunches };
  int slices;
  size_t n = 0;
  MCOR_TRY(mcor_parallel_run(
    context, bunches->triangle_count, MCOR_LIGHT_GRAIN, mcor_file_slice, &filing, &slices));
  for (int i = 0; i < slices; ++i)
  {
    const size_t first = (size_t)filing.first[i], count = (size_t)filing.count[i];
    memmove(bunches->triangles + 3 * n, bunches->triangles + 3 * first, 3 * count * sizeof(cl_int));
    if (bunches->cells)
    {
      memmove(bunches->cells + n, bunches->cells + first, count * sizeof(cl_ulong));
    }
    n += count;
  }
  context->mesh.triangle_count = (int)n;
  MCOR_TRY(
    mcor_write(context, &context->mesh.triangles, bunches->triangles, 3 * n * sizeof(cl_int)));
  return bunches->cells
    ? mcor_write(context, &context->box.cells, bunches->cells, n * sizeof(cl_ulong))
    : MCOR_OK;
}

/* ---- All of it ---- */

/* Allocates the host's memory in one block, and copies the mesh into it. */
static mcor_status mcor_begin_bunches(mcor_bunches* b)
{
  mcor_context* context = b->context;
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)b->vertex_count, march = (size_t)b->march_count,
               triangles = (size_t)b->triangle_count, real = context->cl.real_size,
               cuts = (size_t)b->cut_count * sizeof *b->cut,
               cells = mcor_follows_cells(context) ? triangles * sizeof *b->cells : 0;
  struct
  {
    void** array;
    size_t bytes;
  } const parts[] = { { (void**)&b->state, n * sizeof *b->state },
    { (void**)&b->wide, n * sizeof *b->wide }, { (void**)&b->leans, n * sizeof *b->leans },
    { (void**)&b->held, n * sizeof *b->held }, /* all zero at first */
    { (void**)&b->key, n * sizeof *b->key }, { (void**)&b->first, n * sizeof *b->first },
    { (void**)&b->next, n * sizeof *b->next }, { (void**)&b->star, n * sizeof *b->star },
    { (void**)&b->before, 3 * triangles * sizeof *b->before },
    { (void**)&b->triangles, 3 * triangles * sizeof *b->triangles }, { (void**)&b->cells, cells },
    { (void**)&b->cut, cuts }, { (void**)&b->sorted, n * sizeof *b->sorted },
    { (void**)&b->order, 2 * n * sizeof *b->order }, { (void**)&b->place, n * sizeof *b->place },
    { (void**)&b->merged_place, n * sizeof *b->merged_place },
    { (void**)&b->now, n * sizeof *b->now }, { (void**)&b->node, 4 * n * sizeof *b->node },
    { &b->ends, 2 * march * real }, { &b->offset, 4 * n * real } };
  const size_t count = sizeof parts / sizeof parts[0];
  size_t bytes = 0;
  for (size_t i = 0; i < count; ++i)
  {
    bytes += (parts[i].bytes + 15) / 16 * 16;
  }
  b->memory = malloc(bytes);
  MCOR_TRY(mcor_allocated(context, b->memory));
  mcor_use_large_pages(b->memory, bytes);
  uint8_t* at = b->memory;
  for (size_t i = 0; i < count; ++i)
  {
    *parts[i].array = parts[i].bytes > 0 ? at : NULL;
    at += (parts[i].bytes + 15) / 16 * 16;
  }
  memset(b->memory, 0, (size_t)((uint8_t*)b->key - b->memory));
  memcpy(b->cut_first, mesh->level_first[1], sizeof b->cut_first);
  MCOR_TRY(
    mcor_read(context, &mesh->triangles, 0, b->triangles, 3 * triangles * sizeof *b->triangles));
  MCOR_TRY(mcor_read(context, &context->box.cells, 0, b->cells, cells));
  MCOR_TRY(mcor_read(context, &mesh->cut_edges, 0, b->cut, cuts));
  MCOR_TRY(mcor_read(context, &mesh->node, 0, b->node, 4 * n * sizeof *b->node));
  MCOR_TRY(mcor_read(context, &mesh->ends, 0, b->ends, 2 * march * real));
  return mcor_read(context, &mesh->offset, 0, b->offset, 4 * n * real);
}

mcor_status mcor_compact(mcor_context* context)
{
  mcor_mesh* mesh = &context->mesh;
  mcor_bunches bunches = { .context = context,
    .corners = mcor_is_plane(context) ? 2 : 3,
    .march_count = mesh->march_count,
    .vertex_count = mesh->vertex_count,
    .triangle_count = mesh->triangle_count,
    .cut_count = mesh->cap_first - mesh->march_count };
  if (mesh->triangle_count == 0 || mesh->march_count == 0)
  {
    return MCOR_OK;
  }
  mcor_status status = mcor_begin_bunches(&bunches);
  MCOR_THEN(status, mcor_find_bunches(&bunches));
  MCOR_THEN(status, mcor_place_vertices(&bunches));
  MCOR_THEN(status, mcor_take_apart(&bunches));
  MCOR_THEN(status, mcor_move_slivers(&bunches));
  MCOR_THEN(status, mcor_gather_vertices(&bunches));
  MCOR_THEN(status, mcor_file_triangles(&bunches));
  free(bunches.memory);
  free(bunches.points);
  return status;
}

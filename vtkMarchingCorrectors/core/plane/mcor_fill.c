/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Filling: makes triangles of the regions between lines, in two dimensions. First the field is
 * evaluated at all nodes that particles reach. For each iso value, three things are kept: the
 * vertices of its lines, the points where trimming cuts these lines, and which nodes are above the
 * iso value. When all lines are made, each node is in a band between two successive iso values.
 *
 * The vertices of lines divide the border of each square of the lattice into parts, and each part
 * lies in one band. Parts of the border and the lines that join them enclose a polygon, which lies
 * in one band, too. Trimming cuts off a part of the polygon; the rest becomes triangles. Corners of
 * triangles are points of lines, nodes, and points where trimming cuts lattice edges. Neighbouring
 * triangles share their corners. A square is filled only if all its nodes are valid, as for lines.
 * Borders are followed with the inside on the left. */

#include "mcor_box.h"
#include "mcor_cap.h"

#include <stdlib.h>
#include <string.h>

/* The lines of one iso value, after trimming. */
typedef struct mcor_fill_line
{
  double iso, value; /* iso: less context->value_shift, as on the device; value: the caller's */
  int iso_number;
  int vertex_count, cut_count;
  mcor_table edges;        /* the line's vertices by lattice edge */
  mcor_table joined;       /* lowest nodes of ambiguous squares that join their two nodes above */
  double *offset, *margin; /* [vertex_count]: position along the edge; trim margin */
  cl_ulong* cuts;          /* [cut_count], see mcor_trim.cl; ascending */
  int32_t* number;         /* [vertex_count + cut_count]: number of the surface's point; -1: none */
} mcor_fill_line;

/* corner: a node's index, or (node_count + a cut's index), or (-1 - a surface point's index). */
typedef struct mcor_fill_triangle
{
  int32_t corner[3];
  int32_t band;
  uint64_t square;
} mcor_fill_triangle;

/* A corner of a square's border: a node, or a vertex of a line. Also describes the part of the
 * border from this corner to the next one. */
typedef struct mcor_fill_corner
{
  mcor_cap_corner corner; /* must be the first member; vertex: a corner of mcor_fill_triangle */
  int level;              /* index of the line in `lines`; -1: the corner is a node */
  bool begins_line;       /* in the current polygon, a line leads to the next corner */
  int32_t vertex;
  bool falls; /* at this corner, the border goes from above the line to below it */
  int band;   /* band of this part of the border */
  bool done;  /* a polygon has this part */
  /* This part of the border is number `part` among the parts of a lattice edge: the edge that goes
   * up from `node` along `axis`. */
  cl_int node[3];
  int axis, part;
} mcor_fill_corner;

typedef struct mcor_filling
{
  mcor_fill_line* lines; /* [line_count], ascending by iso value, without repetitions */
  int line_count;
  mcor_cap_nodes nodes; /* the plane's nodes, stored as nodes of caps are */
  int32_t* band;        /* [nodes.node_count]: number of iso values that the node reaches */
  int32_t* number;      /* points of the surface at nodes, then at cuts; -1: none */
  mcor_cap_job cap;     /* vertices: points where trimming ends the region */
  MCOR_LIST(mcor_fill_triangle) triangles;
  MCOR_LIST(mcor_cap_vertex) vertices; /* the points of the surface that lines lack */
  /* The square that is being filled. */
  uint64_t square;
  int64_t lowest;           /* number of its lowest node */
  cl_int node[2];           /* the lowest node */
  mcor_fill_corner* border; /* [4 + 4 * line_count] */
  int count;                /* number of corners of its border */
  int polygon_band;         /* band of the current polygon */
} mcor_filling;

/* ---- Before all lines ---- */

mcor_status mcor_begin_fill(mcor_context* context)
{
  const mcor_options* options = context->run.options;
  if (!options->filled || options->iso_count == 0 || context->box.is_empty)
  {
    return MCOR_OK;
  }
  mcor_filling* fill = context->run.fill = calloc(1, sizeof *fill);
  context->run.iso = (mcor_iso){ .number = 0 };
  MCOR_TRY(mcor_allocated(context, fill));
  fill->cap.context = context;
  fill->lines = calloc((size_t)options->iso_count, sizeof *fill->lines);
  MCOR_TRY(mcor_allocated(context, fill->lines));
  for (int i = 0; i < options->iso_count; ++i) /* by iso value; equal values become one line */
  {
    const double iso = mcor_real_of(context, options->iso_values[i] - context->value_shift);
    int at = fill->line_count;
    while (at > 0 && fill->lines[at - 1].iso > iso)
    {
      --at;
    }
    if (at == 0 || fill->lines[at - 1].iso != iso)
    {
      mcor_fill_line* line = &fill->lines[at];
      memmove(line + 1, line, (size_t)(fill->line_count - at) * sizeof *line);
      *line = (mcor_fill_line){ .iso = iso, .value = options->iso_values[i], .iso_number = i };
      ++fill->line_count;
    }
  }
  const double least = fill->lines[0].value;
  MCOR_FAIL_IF(options->field == MCOR_SUM && options->node_threshold == 0 && least <= 0, context,
    MCOR_INVALID_ARGUMENT, MCOR_SAY(REGION_WITHOUT_END), least);
  const mcor_box* box = &context->box;
  mcor_cap_nodes* nodes = &fill->nodes;
  *nodes = (mcor_cap_nodes){ .axis = 2,
    .upper = 1,
    .across = { 0, 1 },
    .range = { { box->first[0], box->last[0] }, { box->first[1], box->last[1] } } };
  MCOR_TRY(mcor_find_cap_bricks(context, 1, nodes));
  nodes->value = calloc((size_t)nodes->node_count, sizeof *nodes->value);
  fill->band = calloc((size_t)nodes->node_count, sizeof *fill->band);
  MCOR_TRY(mcor_allocated(context, nodes->value && fill->band));
  return mcor_ask_cap_nodes(context, nodes, false);
}

/* ---- The lines of one iso value ---- */

/* Returns the lines of the current iso value if they are to be filled, else NULL. */
static mcor_fill_line* mcor_line_under_way(const mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  for (int i = 0; fill && i < fill->line_count; ++i)
  {
    if (fill->lines[i].iso_number == context->run.iso.number)
    {
      return &fill->lines[i];
    }
  }
  return NULL;
}

static mcor_status mcor_take_vertices(mcor_context* context, mcor_fill_line* line)
{
  const mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)mesh->march_count, cuts = (size_t)(mesh->vertex_count - (int)n),
               real = context->cl.real_size;
  line->offset = malloc(n * sizeof *line->offset);
  line->margin = malloc(n * sizeof *line->margin);
  line->cuts = malloc(cuts * sizeof *line->cuts + 1);
  line->number = malloc((n + cuts) * sizeof *line->number);
  MCOR_TRY(mcor_allocated(context, line->offset && line->margin && line->cuts && line->number));
  memset(line->number, 0xff, (n + cuts) * sizeof *line->number);
  line->vertex_count = (int)n;
  line->cut_count = (int)cuts;
  if (cuts > 0)
  {
    MCOR_TRY(
      mcor_read(context, &context->mesh.cut_edges, 0, line->cuts, cuts * sizeof *line->cuts));
  }
  void *node = NULL, *offset = NULL, *quantity = NULL;
  const mcor_mapping mappings[] = { { &mesh->node, n * 4 * sizeof(cl_int), &node },
    { &mesh->offset, n * 4 * real, &offset },
    { mcor_trim_quantity(context), n * real, &quantity } };
  const int count = mcor_is_trimmed(context) ? 3 : 2;
  mcor_status status = mcor_map_all(context, mappings, count);
  const double threshold = mcor_real_of(context, mcor_trim_threshold(context));
  for (int v = 0; v < line->vertex_count && status == MCOR_OK; ++v)
  {
    const cl_int *at = (const cl_int*)node + 4 * (size_t)v, axis = at[3] & 3;
    const cl_int edge[3] = { at[0], at[1], axis };
    line->offset[v] = mcor_get_real(context, offset, 4 * (int64_t)v + axis);
    line->margin[v] = quantity ? mcor_get_real(context, quantity, v) - threshold : INFINITY;
    status = mcor_allocated(context, mcor_table_number(&line->edges, mcor_cap_key(edge), v) >= 0);
  }
  return mcor_unmap_all(context, mappings, count, status);
}

/* Keeps the vertices of the lines of the current iso value. Adds 1 to the band (the number of iso
 * values that a node reaches) of each node above this value. For nodes that marching squares has
 * evaluated, takes its results, because the lines are made from these results. */
mcor_status mcor_take_lines(mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  mcor_fill_line* line = mcor_line_under_way(context);
  if (!line)
  {
    return MCOR_OK;
  }
  if (context->mesh.march_count > 0)
  {
    MCOR_TRY(mcor_take_vertices(context, line));
  }
  mcor_cap_nodes* nodes = &fill->nodes;
  for (int64_t b = 0; b < nodes->bricks.count; ++b)
  {
    mcor_cap_brick* brick = &nodes->bricks.of[b];
    brick->is_known = false;
    brick->joined = 0;
  }
  MCOR_TRY(mcor_take_cap_masks(context, nodes));
  for (int64_t n = MCOR_SIDE_NODES; n < nodes->node_count; ++n)
  {
    const mcor_cap_brick* brick = &nodes->bricks.of[n / MCOR_SIDE_NODES];
    const int bit = (int)(n % MCOR_SIDE_NODES);
    const bool above = brick->above >> bit & 1, joined = brick->joined >> bit & 1;
    fill->band[n] += brick->is_known ? above : nodes->value[n] >= line->iso;
    MCOR_TRY(
      mcor_allocated(context, !joined || mcor_table_number(&line->joined, (uint64_t)n, 0) >= 0));
  }
  return MCOR_OK;
}

void mcor_number_lines(mcor_context* context, const cl_int* scanned, int64_t base)
{
  mcor_fill_line* line = mcor_line_under_way(context);
  for (int v = 0; line && v < line->vertex_count + line->cut_count; ++v)
  {
    line->number[v] = mcor_is_output(scanned, v) ? (int32_t)(base + scanned[v]) : -1;
  }
}

/* ---- The border of a square ---- */

static mcor_status mcor_does_not_fit(mcor_context* context, const mcor_fill_corner* at)
{
  return mcor_fail(context, MCOR_DEVICE_ERROR, MCOR_SAY(FILLED_FAULT), at->node[0], at->node[1]);
}

/* Packs a lattice edge, and the number of a part of the edge, into a key. */
static uint64_t mcor_edge_part(const mcor_fill_corner* corner, int part)
{
  const cl_int edge[3] = { corner->node[0], corner->node[1], corner->axis };
  return mcor_cap_key(edge) ^ (uint64_t)part << 44;
}

/* Appends the corners on side s of the current square to fill->border: the node at the beginning of
 * the side, then the vertices of lines. The node at the end belongs to the next side. */
static mcor_status mcor_add_border_side(mcor_filling* fill, int s)
{
  const int64_t begin = mcor_corner_index(&fill->nodes, fill->lowest, s),
                end = mcor_corner_index(&fill->nodes, fill->lowest, (s + 1) % 4);
  const int first = fill->band[begin], last = fill->band[end], parts = abs(last - first);
  for (int i = 0; i <= parts; ++i)
  {
    mcor_fill_corner* corner = &fill->border[fill->count++];
    *corner = (mcor_fill_corner){
      .corner = { .vertex = (int32_t)begin,
        .at = { fill->node[0] + mcor_corner_u(s), fill->node[1] + mcor_corner_v(s) },
        .margin = fill->nodes.margin[begin] },
      .level = -1,
      .falls = last < first,
      .band = last < first ? first - i : first + i,
      .node = { fill->node[0] + (s == 1), fill->node[1] + (s == 2), 0 },
      .axis = s & 1,
      .part = s < 2 ? i : parts - i
    };
    if (i > 0) /* the corner is a line's vertex */
    {
      corner->level = last < first ? first - i : first + i - 1;
      const mcor_fill_line* line = &fill->lines[corner->level];
      const int32_t v = mcor_find_number(&line->edges, mcor_edge_part(corner, 0));
      if (v < 0 || (line->margin[v] > 0 && line->number[v] < 0))
      {
        return mcor_does_not_fit(fill->cap.context, corner);
      }
      corner->corner.vertex = -1 - line->number[v];
      corner->corner.margin = line->margin[v];
      corner->vertex = v;
      corner->corner.at[corner->axis] = corner->node[corner->axis] + line->offset[v];
    }
  }
  return MCOR_OK;
}

/* ---- Polygons ---- */

static mcor_status mcor_add_fill_fan(void* data, const mcor_cap_corner* corners, int count)
{
  mcor_filling* fill = data;
  for (int i = 1; i + 1 < count; ++i)
  {
    MCOR_APPEND(fill->cap.context, &fill->triangles,
      (mcor_fill_triangle){ { corners[0].vertex, corners[i].vertex, corners[i + 1].vertex },
        fill->polygon_band, fill->square });
  }
  return MCOR_OK;
}

/* Packs a node into a key. The nodes of each 4 x 4 square have successive keys, so that nodes with
 * successive keys are near each other. */
static uint64_t mcor_fill_node_key(const cl_int node[3])
{
  const cl_int u = node[0], v = node[1];
  return (uint64_t)(v >> 2) << 24 | (uint64_t)(u >> 2) << 4 | (uint64_t)((v & 3) << 2 | (u & 3));
}

/* Finds the point where trimming cuts a side of a polygon. If the side is a part of a line, the
 * point exists, because trimming has cut the line there. If the side is on the square's border,
 * makes the point, unless a neighbouring square has made it before. */
static mcor_status mcor_cut_fill_side(
  void* data, const mcor_cap_corner* from, const mcor_cap_corner* to, mcor_cap_corner* cut)
{
  mcor_filling* fill = data;
  const mcor_fill_corner *p = (const mcor_fill_corner*)from, *q = (const mcor_fill_corner*)to;
  if (p->begins_line)
  {
    const mcor_fill_line* line = &fill->lines[p->level];
    const int found = mcor_find_cut(line->cuts, line->cut_count, p->vertex, q->vertex);
    const int32_t number = found < 0 ? -1 : line->number[line->vertex_count + found];
    cut->vertex = -1 - number;
    return number >= 0 ? MCOR_OK : mcor_does_not_fit(fill->cap.context, p);
  }
  const bool inside = from->margin > 0;
  const int32_t nodes = (int32_t)fill->nodes.node_count;
  const mcor_cap_vertex vertex = { .band = p->band,
    .number = nodes + (int32_t)fill->cap.vertices.count,
    .key = { mcor_fill_node_key(p->node) | UINT64_C(1) << 62,
      (uint64_t)p->axis << 32 | (uint32_t)p->part },
    .flag = 2 };
  MCOR_TRY(mcor_find_cap_cut(
    &fill->cap, mcor_edge_part(p, p->part), inside ? from : to, inside ? to : from, vertex, cut));
  cut->vertex += nodes;
  return MCOR_OK;
}

/* Adds the triangles of the polygon whose first corner is corner i of the border. */
static mcor_status mcor_add_polygon(mcor_filling* fill, int i)
{
  const mcor_cap_corner* corners[MCOR_POLYGON_MOST];
  int count = 0;
  fill->polygon_band = fill->border[i].band;
  for (int at = i; !fill->border[at].done;)
  {
    mcor_fill_corner *corner = &fill->border[at], *next = &fill->border[(at + 1) % fill->count];
    const bool meets_line = next->level >= 0;
    if (count + 1 + meets_line > MCOR_POLYGON_MOST || corner->band != fill->polygon_band)
    {
      return mcor_does_not_fit(fill->cap.context, corner);
    }
    corner->done = true;
    corner->begins_line = false;
    corners[count++] = &corner->corner;
    at = (at + 1) % fill->count;
    if (meets_line)
    {
      next->begins_line = true;
      corners[count++] = &next->corner;
      /* Goes to the other end of the line. Lines of one iso value have two ends on the border, or
       * four. If there are four, the two lines surround the nodes below the iso value if `joined`,
       * else the nodes above. */
      const int level = next->level;
      const bool joined = mcor_find_number(&fill->lines[level].joined, (uint64_t)fill->lowest) >= 0;
      const int step = next->falls == joined ? 1 : fill->count - 1;
      do
      {
        at = (at + step) % fill->count;
      } while (fill->border[at].level != level);
    }
  }
  return mcor_clip_polygon(corners, count, 1, mcor_cut_fill_side, mcor_add_fill_fan, fill);
}

/* ---- Squares ---- */

/* A square is filled if all its nodes are valid, and any of them is above the lowest iso value. */
static mcor_status mcor_visit_fill_square(
  void* data, const mcor_cap_nodes* nodes, int64_t lowest, const cl_int node[3])
{
  mcor_filling* fill = data;
  bool valid = true, above = false;
  for (int k = 0; k < 4; ++k)
  {
    const int64_t at = mcor_corner_index(nodes, lowest, k);
    valid = valid && (nodes->bricks.of[at / MCOR_SIDE_NODES].valid >> at % MCOR_SIDE_NODES & 1);
    above = above || fill->band[at] > 0;
  }
  fill->square = (uint64_t)node[1] << 21 | (uint64_t)node[0];
  fill->lowest = lowest;
  fill->node[0] = node[0];
  fill->node[1] = node[1];
  fill->count = 0;
  for (int s = 0; s < 4 && valid && above; ++s)
  {
    MCOR_TRY(mcor_add_border_side(fill, s));
  }
  for (int i = 0; i < fill->count; ++i)
  {
    if (fill->border[i].band > 0 && !fill->border[i].done)
    {
      MCOR_TRY(mcor_add_polygon(fill, i));
    }
  }
  return MCOR_OK;
}

/* ---- Points ---- */

static int mcor_compare_cuts(const void* x, const void* y)
{
  const uint64_t *a = ((const mcor_cap_vertex*)x)->key, *b = ((const mcor_cap_vertex*)y)->key;
  const int i = a[0] == b[0];
  return (a[i] > b[i]) - (a[i] < b[i]);
}

/* Appends to the surface the points that lines lack: first the nodes that triangles use, then the
 * points where trimming cuts lattice edges. Writes the points' numbers to fill->number. Points are
 * appended as if they were vertices of caps, in a mesh of their own. They get the iso value of the
 * line below their band, and the residual from this iso value. */
static mcor_status mcor_make_fill_points(
  mcor_context* context, mcor_filling* fill, const mcor_input* input, mcor_surface* surface)
{
  const mcor_cap_job* cap = &fill->cap;
  const size_t refs = (size_t)(fill->nodes.node_count + cap->vertices.count);
  const int64_t base = surface->point_count;
  fill->number = malloc(refs * sizeof *fill->number);
  MCOR_TRY(mcor_allocated(context, fill->number));
  memset(fill->number, 0xff, refs * sizeof *fill->number);
  for (int64_t i = 0; i < 3 * fill->triangles.count; ++i)
  {
    const int32_t ref = fill->triangles.of[i / 3].corner[i % 3];
    if (ref >= 0)
    {
      fill->number[ref] = 0;
    }
  }
  for (int32_t n = 0; n < fill->nodes.node_count; ++n)
  {
    if (fill->number[n] == 0)
    {
      mcor_cap_vertex vertex = { .band = fill->band[n], .number = n, .flag = MCOR_CAP_FLAG };
      mcor_cap_node(&fill->nodes, n, vertex.node);
      vertex.key[0] = mcor_fill_node_key(vertex.node);
      MCOR_APPEND(context, &fill->vertices, vertex);
    }
  }
  for (int64_t i = 0; i < cap->vertices.count; ++i)
  {
    MCOR_APPEND(context, &fill->vertices, cap->vertices.of[i]);
  }
  mcor_cap_vertex* vertices = fill->vertices.of;
  const int64_t count = fill->vertices.count;
  MCOR_FAIL_IF(count > MCOR_COUNT_LIMIT, context, MCOR_OUT_OF_CAPACITY, MCOR_SAY(FILLED_TOO_LARGE),
    (long long)count, MCOR_COUNT_LIMIT);
  if (count == 0)
  {
    return MCOR_OK;
  }
  qsort(vertices + (count - cap->vertices.count), (size_t)cap->vertices.count, sizeof *vertices,
    mcor_compare_cuts);
  for (int64_t i = 0; i < count; ++i)
  {
    fill->number[vertices[i].number] = (int32_t)(base + i);
  }
  mcor_mesh* mesh = &context->mesh;
  mesh->march_count = mesh->vertex_count = mesh->cap_first = mesh->triangle_count = 0;
  context->run.iso = (mcor_iso){ .number = context->run.options->iso_count };
  MCOR_TRY(mcor_load_attributes(context, input, 0));
  MCOR_TRY(mcor_append_cap_vertices(context, vertices, count));
  mcor_release(context, &context->attributes.sorted);
  MCOR_TRY(mcor_append_output(context, input, true, surface));
  for (int64_t i = base; i < surface->point_count; ++i)
  {
    const mcor_fill_line* line = &fill->lines[vertices[i - base].band - 1];
    if (surface->iso_value)
    {
      surface->iso_value[i] = line->value;
    }
    if (surface->residual)
    {
      surface->residual[i] = (float)(surface->residual[i] - line->iso);
    }
  }
  return MCOR_OK;
}

/* ---- The filled region ---- */

mcor_status mcor_fill_lines(mcor_context* context, const mcor_input* input, mcor_surface* surface)
{
  mcor_filling* fill = context->run.fill;
  if (!fill)
  {
    return MCOR_OK;
  }
  free(fill->nodes.value); /* no longer needed: the bands are known */
  fill->nodes.value = NULL;
  fill->border = malloc((4 + 4 * (size_t)fill->line_count) * sizeof *fill->border);
  MCOR_TRY(mcor_allocated(context, fill->border));
  MCOR_TRY(mcor_visit_cap_squares(context, &fill->nodes, mcor_visit_fill_square, fill));
  if (!context->run.options->preview)
  {
    MCOR_TRY(mcor_place_cap_cuts(&fill->cap));
  }
  MCOR_TRY(mcor_make_fill_points(context, fill, input, surface));
  const int64_t first = surface->triangle_count, count = fill->triangles.count;
  MCOR_TRY(mcor_grow(context, (void**)&surface->triangles, first, count, 3 * sizeof(int32_t)));
  MCOR_TRY(mcor_grow(context, (void**)&surface->band_value, 0, count, sizeof(double)));
  MCOR_TRY(mcor_extend_kept(context, count, surface));
  for (int64_t t = 0; t < count; ++t)
  {
    const mcor_fill_triangle* from = &fill->triangles.of[t];
    for (int c = 0; c < 3; ++c)
    {
      const int32_t ref = from->corner[c];
      surface->triangles[3 * (first + t) + c] = ref < 0 ? -1 - ref : fill->number[ref];
    }
    surface->band_value[t] = fill->lines[from->band - 1].value;
    mcor_keep_cell(context, surface, first + t, context->run.options->iso_count, from->square);
  }
  surface->triangle_count += count;
  return MCOR_OK;
}

void mcor_end_fill(mcor_context* context)
{
  mcor_filling* fill = context->run.fill;
  for (int i = 0; fill && i < fill->line_count; ++i)
  {
    mcor_fill_line* line = &fill->lines[i];
    mcor_table_free(&line->edges);
    mcor_table_free(&line->joined);
    free(line->offset);
    free(line->margin);
    free(line->cuts);
    free(line->number);
  }
  if (fill)
  {
    mcor_free_cap_nodes(&fill->nodes);
    mcor_free_cap_job(&fill->cap);
    free(fill->lines);
    free(fill->band);
    free(fill->number);
    free(fill->triangles.of);
    free(fill->vertices.of);
    free(fill->border);
  }
  free(fill);
  context->run.fill = NULL;
}

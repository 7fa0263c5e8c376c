/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Sections as patches, and patches as cells. Sections made of triangles are oriented: if they form
 * a closed surface, normals point outwards. */

#include "mcor_flux.h"
#include "mcor_plane.h"
#include "mcor_vector.h"

#include <stdlib.h>
#include <string.h>

/* Most cells near particles, of all sections together; most cells of one patch along an edge. */
#define MCOR_FLUX_MOST (1 << 24)
#define MCOR_FLUX_MOST_ALONG 4e15

/* ---- closed sections ---- */

/* An edge of a triangle, its lesser end first. turned: the triangle has it the other way round. */
typedef struct mcor_flux_edge
{
  double ends[2][3];
  bool turned;
} mcor_flux_edge;

static int mcor_compare_numbers(const double* a, const double* b, int count)
{
  for (int i = 0; i < count; ++i)
  {
    if (a[i] != b[i])
    {
      return a[i] < b[i] ? -1 : 1;
    }
  }
  return 0;
}

static int mcor_compare_flux_edges(const void* a, const void* b)
{
  const mcor_flux_edge *left = a, *right = b;
  const int order = mcor_compare_numbers(left->ends[0], right->ends[0], 6);
  return order != 0 ? order : (int)left->turned - (int)right->turned;
}

/* Sets sign to -1 if the triangles form a closed surface with normals inwards, else to 1. */
static mcor_status mcor_orient_triangles(
  mcor_context* context, const double* points, int64_t point_count, double* sign)
{
  mcor_flux_edge* edges = malloc((size_t)point_count * sizeof *edges);
  MCOR_TRY(mcor_allocated(context, edges));
  double volume = 0;
  for (int64_t i = 0; i < point_count; ++i)
  {
    const double *from = points + 3 * i, *to = points + 3 * (i % 3 == 2 ? i - 2 : i + 1);
    edges[i].turned = mcor_compare_numbers(from, to, 3) > 0;
    memcpy(edges[i].ends[edges[i].turned], from, sizeof edges[i].ends[0]);
    memcpy(edges[i].ends[!edges[i].turned], to, sizeof edges[i].ends[0]);
    if (i % 3 == 0)
    {
      double corners[3][3], product[3];
      for (int c = 0; c < 3; ++c)
      {
        mcor_subtract(from + 3 * c, points, corners[c]);
      }
      mcor_cross(corners[1], corners[2], product);
      volume += mcor_dot(corners[0], product);
    }
  }
  qsort(edges, (size_t)point_count, sizeof *edges, mcor_compare_flux_edges);
  bool closed = point_count % 2 == 0;
  /* each edge occurs once in each direction */
  for (int64_t i = 0; i + 1 < point_count && closed; i += 2)
  {
    closed = !edges[i].turned && edges[i + 1].turned &&
      mcor_compare_numbers(edges[i].ends[0], edges[i + 1].ends[0], 6) == 0;
  }
  free(edges);
  *sign = closed && volume < 0 ? -1 : 1;
  return MCOR_OK;
}

/* ---- sections ---- */

static mcor_gauge_label mcor_label_section(const mcor_flux_job* job, int64_t number)
{
  return mcor_label_gauge(job->sections[number].name, number);
}

/* Appends a patch given in the caller's coordinates. normal: has length 1. */
static mcor_status mcor_add_patch(mcor_flux_job* job, int64_t number, mcor_patch_shape shape,
  const double corner[3], const double along[3], const double across[3], const double normal[3])
{
  const mcor_plane* plane = job->plane;
  mcor_patch patch = { .shape = shape, .section = number };
  double product[3];
  mcor_cross(along, across, product);
  patch.measure =
    sqrt(shape == MCOR_PATCH_LINE ? mcor_dot(along, along) : mcor_dot(product, product));
  const double share = shape == MCOR_PATCH_TRIANGLE ? 0.5
    : shape == MCOR_PATCH_QUARTER                   ? MCOR_PI / 4
                                                    : 1;
  job->found[number].area += share * patch.measure;
  for (int a = 0; a < 3; ++a)
  {
    const int axis = mcor_plane_axis(plane, a);
    patch.corner[a] = corner[axis] - (a == 2 ? plane->at : 0);
    patch.along[a] = along[axis];
    patch.across[a] = across[axis];
    const double ends[2] = { along[axis], across[axis] };
    mcor_add_range(&job->around, a, patch.corner[a] + fmin(ends[0], 0) + fmin(ends[1], 0),
      patch.corner[a] + fmax(ends[0], 0) + fmax(ends[1], 0));
  }
  for (int c = 0, axis = 0; axis < 3; ++axis)
  {
    /* A velocity of two components has none along the constant axis. */
    if (job->velocity_components == 3 || axis != job->across)
    {
      patch.normal[c++] = normal[axis];
    }
  }
  MCOR_APPEND(job->edges.context, &job->patches, patch);
  return MCOR_OK;
}

static mcor_status mcor_leaves_plane(const mcor_flux_job* job, int64_t number)
{
  return mcor_fail(job->edges.context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_OUT_OF_PLANE),
    mcor_label_section(job, number).text, 'x' + job->across, job->plane->at);
}

static mcor_status mcor_add_line(mcor_flux_job* job, int64_t number, const double corner[3],
  const double along[3], const double normal[3])
{
  static const double none[3] = { 0 };
  return mcor_add_patch(job, number, MCOR_PATCH_LINE, corner, along, none, normal);
}

/* Appends a rectangle; in two dimensions, the line along which it crosses the plane. */
static mcor_status mcor_add_rectangle(mcor_flux_job* job, int64_t number, const double corner[3],
  const double edges[2][3], const double normal[3])
{
  if (!job->is_plane)
  {
    return mcor_add_patch(job, number, MCOR_PATCH_RECTANGLE, corner, edges[0], edges[1], normal);
  }
  const int w = job->across, u = (w + 1) % 3, v = (w + 2) % 3;
  const double at = job->plane->at;
  for (int e = 0; e < 2; ++e)
  {
    const double *line = edges[e], *through = edges[1 - e];
    if (line[w] == 0 && through[u] == 0 && through[v] == 0 && (line[u] != 0 || line[v] != 0))
    {
      const double low = corner[w] + fmin(through[w], 0), high = corner[w] + fmax(through[w], 0);
      double begin[3] = { corner[0], corner[1], corner[2] };
      begin[w] = at;
      return low <= at && at <= high ? mcor_add_line(job, number, begin, line, normal) : MCOR_OK;
    }
  }
  return mcor_leaves_plane(job, number);
}

/* Appends a rectangle or triangle from a corner and the ends of its edges, if it has an area. sign:
 * 1, or -1 to turn the normal round. */
static mcor_status mcor_add_corners(
  mcor_flux_job* job, int64_t number, mcor_patch_shape shape, const double x[9], double sign)
{
  double edges[2][3], normal[3];
  mcor_subtract(x + 3, x, edges[0]);
  mcor_subtract(x + 6, x, edges[1]);
  mcor_cross(edges[0], edges[1], normal);
  for (int a = 0; a < 3; ++a)
  {
    normal[a] *= sign;
  }
  return !(mcor_normalise(normal) > 0) ? MCOR_OK
    : shape == MCOR_PATCH_RECTANGLE
    ? mcor_add_rectangle(job, number, x, (const double(*)[3])edges, normal)
    : mcor_add_patch(job, number, shape, x, edges[0], edges[1], normal);
}

/* Appends the quarters of a disc; in two dimensions, the line along which it crosses the plane. */
static mcor_status mcor_add_disc(
  mcor_flux_job* job, int64_t number, const double centre[3], const double normal[3], double radius)
{
  double axes[2][3], axis[3] = { 0 };
  int least = 0;
  if (job->is_plane)
  {
    const int w = job->across;
    const double off = job->plane->at - centre[w],
                 half = sqrt(fmax(radius * radius - off * off, 0));
    double corner[3], along[3];
    axis[w] = 1;
    mcor_cross(axis, normal, along);
    for (int a = 0; a < 3; ++a)
    {
      corner[a] = a == w ? job->plane->at : centre[a] - half * along[a];
      along[a] *= 2 * half;
    }
    return normal[w] != 0 ? mcor_leaves_plane(job, number)
      : half > 0          ? mcor_add_line(job, number, corner, along, normal)
                          : MCOR_OK;
  }
  for (int a = 1; a < 3; ++a)
  {
    least = fabs(normal[a]) < fabs(normal[least]) ? a : least;
  }
  axis[least] = 1;
  mcor_cross(normal, axis, axes[0]);
  mcor_normalise(axes[0]);
  mcor_cross(normal, axes[0], axes[1]);
  for (int quarter = 0; quarter < 4; ++quarter)
  {
    double along[3], across[3];
    for (int a = 0; a < 3; ++a)
    {
      along[a] = (quarter / 2 ? -radius : radius) * axes[quarter % 2][a];
      across[a] = ((quarter + 1) / 2 % 2 ? -radius : radius) * axes[1 - quarter % 2][a];
    }
    MCOR_TRY(mcor_add_patch(job, number, MCOR_PATCH_QUARTER, centre, along, across, normal));
  }
  return MCOR_OK;
}

static mcor_status mcor_add_shape(mcor_flux_job* job, int64_t number)
{
  const mcor_section* section = &job->sections[number];
  const double *x = section->points, *end = x + 3 * section->point_count;
  const int w = job->across, first = w == 0 ? 1 : 0, second = w == 2 ? 1 : 2;
  double normal[3] = { 0 }, sign = 1;
  switch (section->shape)
  {
    case MCOR_SECTION_RECTANGLE:
      return mcor_add_corners(job, number, MCOR_PATCH_RECTANGLE, x, 1);
    case MCOR_SECTION_DISC:
      memcpy(normal, x + 3, sizeof normal);
      return mcor_normalise(normal) > 0 && section->radius > 0
        ? mcor_add_disc(job, number, x, normal, section->radius)
        : MCOR_OK;
    case MCOR_SECTION_BOX:
      for (int side = 0; side < 6; ++side)
      {
        const int a = side / 2, is_high = side % 2;
        double corner[3] = { x[0], x[1], x[2] }, edges[2][3] = { { 0 } }, outwards[3] = { 0 };
        corner[a] = x[3 * is_high + a];
        outwards[a] = is_high ? 1 : -1;
        for (int e = 1; e < 3; ++e)
        {
          const int along = (a + e) % 3;
          edges[is_high ? e - 1 : 2 - e][along] = x[3 + along] - x[along];
        }
        MCOR_TRY(job->is_plane && a == w
            ? MCOR_OK
            : mcor_add_rectangle(job, number, corner, (const double(*)[3])edges, outwards));
      }
      return MCOR_OK;
    case MCOR_SECTION_TRIANGLES:
      MCOR_TRY(mcor_orient_triangles(job->edges.context, x, section->point_count, &sign));
      for (; x < end; x += 9)
      {
        MCOR_TRY(job->is_plane ? mcor_leaves_plane(job, number)
                               : mcor_add_corners(job, number, MCOR_PATCH_TRIANGLE, x, sign));
      }
      return MCOR_OK;
    default:
      MCOR_FAIL_IF(!job->is_plane, job->edges.context, MCOR_INVALID_ARGUMENT,
        MCOR_SAY(SECTION_IS_LINE), mcor_label_section(job, number).text);
      for (; x < end; x += 6)
      {
        double along[3];
        mcor_subtract(x + 3, x, along);
        normal[w] = 0;
        normal[first] = along[second];
        normal[second] = -along[first];
        MCOR_TRY(x[w] != job->plane->at || x[3 + w] != job->plane->at
            ? mcor_leaves_plane(job, number)
            : mcor_normalise(normal) > 0 ? mcor_add_line(job, number, x, along, normal)
                                         : MCOR_OK);
      }
      return MCOR_OK;
  }
}

mcor_status mcor_add_section(mcor_flux_job* job, int64_t number)
{
  static const int points[MCOR_SECTION_SHAPE_COUNT] = { 3, 2, 2, 3, 2 };
  mcor_context* context = job->edges.context;
  const mcor_section* section = &job->sections[number];
  const mcor_gauge_label label = mcor_label_section(job, number);
  const int64_t n = section->point_count;
  const bool is_known = (unsigned)section->shape < MCOR_SECTION_SHAPE_COUNT;
  const bool is_list =
    section->shape == MCOR_SECTION_TRIANGLES || section->shape == MCOR_SECTION_LINES;
  MCOR_FAIL_IF(!is_known || !section->points || n <= 0 ||
      (is_list ? n % points[section->shape] != 0 : n != points[section->shape]),
    context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_POINTS), label.text, (long long)n);
  for (int64_t i = 0; i < n; ++i)
  {
    const double* p = section->points + 3 * i;
    MCOR_FAIL_IF(!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]), context,
      MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_NOT_FINITE), label.text, p[0], p[1], p[2]);
  }
  MCOR_TRY(mcor_add_shape(job, number));
  /* Whether the section has an area or, in two dimensions, may have one outside of the plane. */
  const double* x = section->points;
  bool has_size = section->shape == MCOR_SECTION_DISC
    ? section->radius > 0 && mcor_dot(x + 3, x + 3) > 0
    : section->shape == MCOR_SECTION_BOX || job->found[number].area > 0 || job->is_plane;
  for (int a = 0; a < 3 && section->shape == MCOR_SECTION_BOX; ++a)
  {
    const bool flat = job->is_plane && a == job->across;
    has_size = has_size && (x[a] < x[3 + a] || (flat && x[a] == x[3 + a]));
  }
  MCOR_FAIL_IF(
    !has_size, context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_WITHOUT_AREA), label.text);
  MCOR_FAIL_IF(!isfinite(job->found[number].area), context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(SECTION_TOO_LARGE), label.text);
  return MCOR_OK;
}

/* ---- places ---- */

void mcor_map_patch(const void* data, const double parameters[3], double point[3])
{
  const mcor_flux_job* job = data;
  const mcor_patch* patch = &job->patches.of[(int64_t)parameters[2]];
  double along = parameters[0], across = parameters[1];
  if (patch->shape == MCOR_PATCH_QUARTER)
  {
    /* (1 - v^2, 2 v) / (1 + v^2) is on the unit circle and has the same bits everywhere; sine
     * and cosine have not. */
    const double v = parameters[1], radius = parameters[0] / (1 + v * v);
    along = radius * (1 - v * v);
    across = radius * (2 * v);
  }
  for (int a = 0; a < 3; ++a)
  {
    point[a] = patch->corner[a] + along * patch->along[a] + across * patch->across[a];
  }
}

double mcor_patch_measure(const mcor_patch* patch, const double uv[2])
{
  return patch->shape == MCOR_PATCH_QUARTER ? patch->measure * (2 * uv[0] / (1 + uv[1] * uv[1]))
                                            : patch->measure;
}

/* ---- cells ---- */

/* Cells [first, last) along u and v of a patch. */
typedef struct mcor_flux_block
{
  int64_t patch, first[2], last[2];
} mcor_flux_block;

typedef struct mcor_flux_reach
{
  double low[3], high[3];
  double (*owned)[2]; /* cells of the box that this call owns; NULL: it owns all */
} mcor_flux_reach;

/* Whether a block of cells comes near the reach. */
static bool mcor_is_near(
  const mcor_flux_job* job, const mcor_flux_reach* reach, const mcor_flux_block* block)
{
  const mcor_patch* patch = &job->patches.of[block->patch];
  double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
  for (int corner = 0; corner < 4; ++corner)
  {
    const double at[3] = { (double)(corner % 2 ? block->last[0] : block->first[0]) /
        patch->counts[0],
      (double)(corner / 2 ? block->last[1] : block->first[1]) / patch->counts[1],
      (double)block->patch };
    double point[3];
    mcor_map_patch(job, at, point);
    for (int a = 0; a < 3; ++a)
    {
      low[a] = fmin(low[a], point[a]);
      high[a] = fmax(high[a], point[a]);
    }
  }
  /* The farthest that an arc is from its chord. */
  const double turn = (double)(block->last[1] - block->first[1]) / patch->counts[1];
  const double bulge =
    patch->shape == MCOR_PATCH_QUARTER ? 0.5 * sqrt(patch->measure) * turn * turn : 0;
  for (int a = 0; a < 3; ++a)
  {
    if (high[a] + bulge < reach->low[a] || low[a] - bulge > reach->high[a])
    {
      return false;
    }
  }
  return true;
}

static mcor_status mcor_list_block(
  mcor_flux_job* job, const mcor_flux_reach* reach, const mcor_flux_block* block)
{
  const mcor_patch* patch = &job->patches.of[block->patch];
  const int64_t counts[2] = { block->last[0] - block->first[0], block->last[1] - block->first[1] };
  if (!mcor_is_near(job, reach, block) ||
    (patch->shape == MCOR_PATCH_TRIANGLE &&
      (double)(block->first[0] + block->first[1]) >= patch->counts[0]))
  {
    return MCOR_OK;
  }
  if (counts[0] > 1 || counts[1] > 1)
  {
    const int longer = counts[1] > counts[0];
    mcor_flux_block halves[2] = { *block, *block };
    halves[0].last[longer] = halves[1].first[longer] = block->first[longer] + counts[longer] / 2;
    MCOR_TRY(mcor_list_block(job, reach, &halves[0]));
    return mcor_list_block(job, reach, &halves[1]);
  }
  const double middle[3] = { ((double)block->first[0] + 0.5) / patch->counts[0],
    ((double)block->first[1] + 0.5) / patch->counts[1], (double)block->patch };
  double point[3];
  mcor_map_patch(job, middle, point);
  if (reach->owned && !mcor_owns_point(job->edges.context, point, reach->owned))
  {
    return MCOR_OK;
  }
  mcor_context* context = job->edges.context;
  MCOR_FAIL_IF(job->cells.count >= MCOR_FLUX_MOST, context, MCOR_INVALID_ARGUMENT,
    MCOR_SAY(SECTION_CELLS), mcor_label_section(job, patch->section).text, MCOR_FLUX_MOST,
    MCOR_FLUX_CELL * job->smoothing_length);
  MCOR_APPEND(
    context, &job->cells, (mcor_flux_cell){ block->patch, block->first[0], block->first[1] });
  return MCOR_OK;
}

mcor_status mcor_list_flux_cells(mcor_flux_job* job)
{
  mcor_context* context = job->edges.context;
  const mcor_lattice* lattice = &context->lattice;
  job->smoothing_length = context->run.options->h_scale * context->measure.h_min;
  const double step = MCOR_FLUX_CELL * job->smoothing_length;
  const double* box = job->edges.box;
  double owned[3][2];
  mcor_flux_reach reach = { .owned = box ? owned : NULL };
  if (box)
  {
    mcor_own_cells(context, box, owned);
  }
  for (int a = 0; a < 3; ++a)
  {
    const bool periodic = lattice->period[a] > 0; /* there are particles all along a period */
    reach.low[a] = periodic ? -INFINITY : context->measure.low[a] - lattice->cube;
    reach.high[a] = periodic ? INFINITY : context->measure.high[a] + lattice->cube;
    if (box && !periodic)
    {
      reach.low[a] = fmax(reach.low[a], box[2 * a] - 2 * step);
      reach.high[a] = fmin(reach.high[a], box[2 * a + 1] + 2 * step);
    }
  }
  for (int64_t p = 0; p < job->patches.count; ++p)
  {
    mcor_patch* patch = &job->patches.of[p];
    double third[3];
    mcor_subtract(patch->across, patch->along, third);
    double lengths[2] = { sqrt(mcor_dot(patch->along, patch->along)),
      sqrt(mcor_dot(patch->across, patch->across)) };
    if (patch->shape == MCOR_PATCH_TRIANGLE)
    {
      lengths[0] = lengths[1] = fmax(fmax(lengths[0], lengths[1]), sqrt(mcor_dot(third, third)));
    }
    lengths[1] *= patch->shape == MCOR_PATCH_QUARTER ? 2 : 1; /* the longest that its arc can be */
    for (int u = 0; u < 2; ++u)
    {
      patch->counts[u] = fmax(ceil(lengths[u] / step), 1);
    }
    MCOR_FAIL_IF(
      !(patch->counts[0] <= MCOR_FLUX_MOST_ALONG) || !(patch->counts[1] <= MCOR_FLUX_MOST_ALONG),
      context, MCOR_INVALID_ARGUMENT, MCOR_SAY(SECTION_CELLS_ALONG),
      mcor_label_section(job, patch->section).text, fmax(patch->counts[0], patch->counts[1]),
      context->measure.h_min, MCOR_FLUX_MOST_ALONG);
    const mcor_flux_block whole = { .patch = p,
      .last = { (int64_t)patch->counts[0], (int64_t)patch->counts[1] } };
    MCOR_TRY(mcor_list_block(job, &reach, &whole));
  }
  return MCOR_OK;
}

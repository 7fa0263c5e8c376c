/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Evaluates the field at points of caps and of filled regions, and appends these points to the
 * mesh's vertices. */

#include "mcor_box.h"
#include "mcor_cap.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- The field ---- */

/* Evaluates the points of the batch, calls p->take for each of them, and empties the batch. */
static mcor_status mcor_take_cap_points(mcor_context* context, mcor_cap_points* p)
{
  if (p->count == 0)
  {
    return MCOR_OK;
  }
  const size_t n = (size_t)p->count, bytes = n * context->cl.real_size;
  mcor_field_points* on_device = &p->on_device;
  const mcor_mapping mappings[] = { { &on_device->value, bytes, &p->value },
    { &on_device->gradient, 4 * bytes, &p->gradient }, { &on_device->weight, bytes, &p->weight },
    { &p->eigenvalues, bytes, &p->eigenvalue } };
  const int mapped = mcor_trims_by_eigenvalue(context) ? 4 : 3;
  int groups;
  MCOR_TRY(mcor_reserve_points(context, on_device, n));
  MCOR_TRY(mcor_write(context, &on_device->node, p->node, n * 4 * sizeof(cl_int)));
  MCOR_TRY(mcor_write(context, &on_device->offset, p->offset, 4 * bytes));
  MCOR_TRY(mcor_evaluate_points(context, on_device, 0, p->count, &groups));
  if (mapped == 4)
  {
    MCOR_TRY(mcor_reserve(context, &p->eigenvalues, bytes));
    MCOR_TRY(MCOR_LAUNCH(context, "mcor_boundary_points", MCOR_HEAVY, groups,
      MCOR_GRID_ARGS(context), MCOR_INT(groups), MCOR_BUFFER(&context->points.groups),
      MCOR_BUFFER(&on_device->node), MCOR_BUFFER(&on_device->offset), MCOR_INT(context->space.flat),
      MCOR_BUFFER(&p->eigenvalues)));
  }
  mcor_status status = mcor_map_all(context, mappings, mapped);
  for (int i = 0; i < p->count && status == MCOR_OK; ++i)
  {
    p->take(context, p, i, p->data);
  }
  p->count = 0;
  MCOR_TRY(mcor_unmap_all(context, mappings, mapped, status));
  return mcor_report_launch(context);
}

mcor_status mcor_add_cap_point(mcor_context* context, mcor_cap_points* p, const cl_int node[3],
  const double offset[3], int64_t to)
{
  if (!p->node)
  {
    p->node = calloc(MCOR_CAP_BATCH, 4 * sizeof *p->node);
    p->offset = calloc(MCOR_CAP_BATCH, 4 * context->cl.real_size);
    p->to = malloc(MCOR_CAP_BATCH * sizeof *p->to);
    MCOR_TRY(mcor_allocated(context, p->node && p->offset && p->to));
  }
  memcpy(p->node + 4 * (size_t)p->count, node, 3 * sizeof *node);
  for (int a = 0; a < 3; ++a)
  {
    mcor_put_real(context, p->offset, 4 * (int64_t)p->count + a, offset ? offset[a] : 0);
  }
  p->to[p->count++] = to;
  return p->count < MCOR_CAP_BATCH ? MCOR_OK : mcor_take_cap_points(context, p);
}

mcor_status mcor_end_cap_points(mcor_context* context, mcor_cap_points* p, mcor_status status)
{
  MCOR_THEN(status, mcor_take_cap_points(context, p));
  MCOR_RELEASE_EACH(context, &p->on_device);
  mcor_release(context, &p->eigenvalues);
  free(p->node);
  free(p->offset);
  free(p->to);
  return status;
}

/* Returns the weight of the fluid alone. */
static double mcor_cap_fluid(const mcor_context* context, const mcor_cap_points* p, int64_t i)
{
  return context->cl.build.solids ? mcor_get_real(context, p->gradient, 4 * i + 3)
                                  : mcor_get_real(context, p->weight, i);
}

double mcor_cap_margin(const mcor_context* context, const mcor_cap_points* p, int64_t i)
{
  const double weight = mcor_get_real(context, p->weight, i), share = mcor_fluid_share(context);
  const double fluid = mcor_cap_fluid(context, p, i);
  const double quantity = p->eigenvalue ? mcor_get_real(context, p->eigenvalue, i) : weight;
  const double threshold = context->run.options->field == MCOR_WEIGHT_SUM
    ? DBL_MAX
    : quantity - mcor_real_of(context, mcor_vertex_threshold(context));
  const double ends = share > 0 ? fluid - share * weight : DBL_MAX;
  const double margin = threshold < ends ? threshold : ends;
  return fluid > mcor_real_of(context, mcor_least_fluid(context)) ||
      context->run.options->field != MCOR_SHEPARD
    ? margin
    : fmin(margin, 0);
}

bool mcor_cap_is_valid(const mcor_context* context, const mcor_cap_points* p, int64_t i)
{
  const mcor_options* options = context->run.options;
  const double weight = mcor_get_real(context, p->weight, i);
  return options->field == MCOR_WEIGHT_SUM ||
    (weight >= mcor_real_of(context, options->node_threshold) &&
      (options->field == MCOR_SUM ||
        mcor_cap_fluid(context, p, i) >= mcor_real_of(context, MCOR_LEAST_NODE_WEIGHT)));
}

int mcor_cap_plane(const mcor_context* context, int axis, int upper)
{
  const mcor_lattice* lattice = &context->lattice;
  const mcor_box* box = &context->box;
  const mcor_options* options = context->run.options;
  double ends[2];
  const int* sides = upper ? (options->ranks ? box->whole_last : box->last)
                           : (options->ranks ? box->whole_first : box->first);
  mcor_place_sides(lattice, axis, NULL, ends);
  const int side = sides[axis], last = (int)ends[upper];
  if (options->capping == MCOR_CAP_BOX && side != last)
  {
    return side;
  }
  return options->capping && lattice->period[axis] > 0 ? last : -1;
}

/* ---- Vertices ---- */

void mcor_end_caps(mcor_context* context)
{
  free(context->mesh.cap_keys);
  context->mesh.cap_keys = NULL;
}

mcor_status mcor_append_cap_vertices(
  mcor_context* context, const mcor_cap_vertex* vertices, int64_t count)
{
  mcor_mesh* mesh = &context->mesh;
  const size_t n = (size_t)count, old = (size_t)mesh->vertex_count,
               width = 4 * context->cl.real_size;
  if (count == 0)
  {
    return MCOR_OK;
  }
  MCOR_FAIL_IF(count > MCOR_COUNT_LIMIT - mesh->vertex_count, context, MCOR_OUT_OF_CAPACITY,
    MCOR_SAY(CAP_VERTICES));
  mcor_end_caps(context);
  cl_int* node = calloc(n, 4 * sizeof *node);
  void* offset = calloc(n, width);
  uint8_t* flag = malloc(n);
  uint64_t* keys = mesh->cap_keys = malloc(n * sizeof vertices->key);
  mcor_status status = mcor_allocated(context, node && offset && flag && keys);
  for (size_t i = 0; i < n && status == MCOR_OK; ++i)
  {
    memcpy(node + 4 * i, vertices[i].node, sizeof vertices[i].node);
    flag[i] = vertices[i].flag;
    for (size_t a = 0; a < 3; ++a)
    {
      mcor_put_real(context, offset, (int64_t)(4 * i + a), vertices[i].offset[a]);
    }
    keys[2 * i] = vertices[i].key[0] & ~MCOR_RING_CELL;
    keys[2 * i + 1] = vertices[i].key[1];
  }
  const size_t place = 4 * sizeof *node;
  MCOR_THEN(status, mcor_extend_vertices(context, (int)old, (int)(old + n)));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->node, old * place, node, n * place));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->offset, old * width, offset, n * width));
  MCOR_THEN(status, mcor_append_bytes(context, &mesh->flag, old, flag, n));
  free(node);
  free(offset);
  free(flag);
  MCOR_TRY(status);
  mesh->vertex_count += (int)count;
  int groups;
  MCOR_TRY(mcor_make_groups(context, &mesh->node, (int)old, (int)count, &groups));
  return MCOR_LAUNCH(context, "mcor_field_points", MCOR_HEAVY, groups, MCOR_GRID_ARGS(context),
    MCOR_INT(groups), MCOR_BUFFER(&context->points.groups), MCOR_BUFFER(&mesh->node),
    MCOR_REAL(context->run.iso.relative), MCOR_BUFFER(&mesh->offset),
    MCOR_BUFFER(&mesh->field_value), MCOR_BUFFER(&mesh->gradient),
    MCOR_BUFFER(&mesh->vertex_weight), MCOR_ATTRIBUTE_ARGS(context, &mesh->means));
}

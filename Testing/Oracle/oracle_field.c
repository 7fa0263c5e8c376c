/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */
#include "oracle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- particles ---- */

particle_set particle_set_make(int64_t count)
{
  return (particle_set){ .count = count,
    .capacity = count,
    .position = oracle_allocate(count, 3 * sizeof(double)),
    .smoothing_length = oracle_allocate(count, sizeof(double)),
    .volume = oracle_allocate(count, sizeof(double)),
    .scalar = oracle_allocate(count, sizeof(double)),
    .solid = oracle_allocate(count, 1) };
}

void particle_set_free(particle_set* set)
{
  free(set->position);
  free(set->smoothing_length);
  free(set->volume);
  free(set->scalar);
  free(set->solid);
  memset(set, 0, sizeof(*set));
}

void particle_set_add(particle_set* set, const double x[3], double h, double volume, double scalar)
{
  const int64_t n = set->count++, capacity = set->capacity;
  int64_t room[4] = { capacity, capacity, capacity, capacity };
  set->position = oracle_grow(set->position, n, &room[0], 3 * sizeof(double));
  set->smoothing_length = oracle_grow(set->smoothing_length, n, &room[1], sizeof(double));
  set->volume = oracle_grow(set->volume, n, &room[2], sizeof(double));
  set->scalar = oracle_grow(set->scalar, n, &room[3], sizeof(double));
  set->solid = oracle_grow(set->solid, n, &set->capacity, 1);
  memcpy(&set->position[3 * n], x, 3 * sizeof(double));
  set->smoothing_length[n] = h;
  set->volume[n] = volume;
  set->scalar[n] = scalar;
  set->solid[n] = 0;
}

void particle_set_append(particle_set* set, const particle_set* from, int64_t i)
{
  const double x[3] = { from->position[3 * i], from->position[3 * i + 1],
    from->position[3 * i + 2] };
  particle_set_add(set, x, from->smoothing_length[i], from->volume[i], from->scalar[i]);
  set->solid[set->count - 1] = from->solid[i];
}

double oracle_scalar_range(const particle_set* particles)
{
  double low = INFINITY;
  double high = -INFINITY;
  for (int64_t j = 0; j < particles->count; ++j)
  {
    if (!particles->solid[j])
    {
      low = fmin(low, particles->scalar[j]);
      high = fmax(high, particles->scalar[j]);
    }
  }
  return high >= low ? high - low : 0.0;
}

double oracle_smallest_h(const particle_set* particles)
{
  double smallest = INFINITY;
  for (int64_t j = 0; j < particles->count; ++j)
  {
    if (!particles->solid[j])
    {
      smallest = fmin(smallest, particles->smoothing_length[j]);
    }
  }
  return smallest;
}

/* ---- kd-tree: a node has the particles order[begin] to order[end - 1]; each of its two children has half of the
 * node's particles; a leaf has at most ORACLE_LEAF_SIZE particles ---- */

enum
{
  ORACLE_LEAF_SIZE = 12
};

typedef struct oracle_tree_node
{
  double low[3], high[3]; /* bounds of the particles' centres */
  double reach;           /* largest support radius below this node */
} oracle_tree_node;

struct oracle_tree
{
  int64_t* order;
  oracle_tree_node* node; /* children of n at 2n+1 and 2n+2 */
};

typedef struct oracle_sort_item
{
  double key;
  int64_t particle;
} oracle_sort_item;

static int oracle_compare_items(const void* a, const void* b)
{
  const oracle_sort_item* x = a;
  const oracle_sort_item* y = b;
  if (x->key != y->key)
  {
    return x->key < y->key ? -1 : 1;
  }
  return (x->particle > y->particle) - (x->particle < y->particle);
}

static double oracle_reach(const oracle_field* field, int64_t j)
{
  return oracle_support(field->kernel) * field->h_scale * field->particles->smoothing_length[j];
}

static void oracle_bound_node(
  const oracle_field* field, oracle_tree_node* node, int64_t begin, int64_t end)
{
  node->reach = 0.0;
  for (int axis = 0; axis < 3; ++axis)
  {
    node->low[axis] = INFINITY;
    node->high[axis] = -INFINITY;
  }
  for (int64_t s = begin; s < end; ++s)
  {
    const int64_t j = field->tree->order[s];
    node->reach = fmax(node->reach, oracle_reach(field, j));
    for (int axis = 0; axis < 3; ++axis)
    {
      node->low[axis] = fmin(node->low[axis], field->particles->position[3 * j + axis]);
      node->high[axis] = fmax(node->high[axis], field->particles->position[3 * j + axis]);
    }
  }
}

static void oracle_build_node(
  const oracle_field* field, oracle_sort_item* items, int64_t n, int64_t begin, int64_t end)
{
  oracle_tree_node* node = &field->tree->node[n];
  oracle_bound_node(field, node, begin, end);
  if (end - begin <= ORACLE_LEAF_SIZE)
  {
    return;
  }
  int axis = 0;
  for (int a = 1; a < 3; ++a)
  {
    if (node->high[a] - node->low[a] > node->high[axis] - node->low[axis])
    {
      axis = a;
    }
  }
  for (int64_t s = begin; s < end; ++s)
  {
    items[s].particle = field->tree->order[s];
    items[s].key = field->particles->position[3 * items[s].particle + axis];
  }
  qsort(items + begin, (size_t)(end - begin), sizeof(*items), oracle_compare_items);
  for (int64_t s = begin; s < end; ++s)
  {
    field->tree->order[s] = items[s].particle;
  }
  const int64_t middle = begin + (end - begin) / 2;
  oracle_build_node(field, items, 2 * n + 1, begin, middle);
  oracle_build_node(field, items, 2 * n + 2, middle, end);
}

oracle_field oracle_make_field(
  const particle_set* particles, oracle_kernel kernel, oracle_kind kind, double scale)
{
  oracle_field field = { .particles = particles,
    .kernel = kernel,
    .kind = kind,
    .h_scale = scale,
    .tree = oracle_allocate(1, sizeof(oracle_tree)) };
  oracle_sort_item* items = oracle_allocate(particles->count, sizeof(*items));
  int64_t nodes = 1;
  for (int64_t leaf = particles->count; leaf > ORACLE_LEAF_SIZE; leaf = (leaf + 1) / 2)
  {
    nodes = 2 * nodes + 1;
  }
  field.tree->order = oracle_allocate(particles->count, sizeof(int64_t));
  field.tree->node = oracle_allocate(nodes, sizeof(oracle_tree_node));
  for (int64_t j = 0; j < particles->count; ++j)
  {
    field.tree->order[j] = j;
  }
  oracle_build_node(&field, items, 0, 0, particles->count);
  free(items);
  return field;
}

void oracle_free_field(oracle_field* field)
{
  if (field->tree)
  {
    free(field->tree->order);
    free(field->tree->node);
    free(field->tree);
  }
  memset(field, 0, sizeof(*field));
}

typedef void (*oracle_visitor)(const oracle_field* field, int64_t particle, void* user);

/* Calls the visitor for all particles that may reach `point` or, if radius > 0, may lie within
 * radius of it. */
static void oracle_visit(const oracle_field* field, const double point[3], double radius,
  oracle_visitor visitor, void* user, int64_t n, int64_t begin, int64_t end)
{
  const oracle_tree_node* node = &field->tree->node[n];
  const double distance = radius > 0.0 ? radius : node->reach;
  for (int axis = 0; axis < 3; ++axis)
  {
    /* Because of the margin, rounding leaves out no particle. It may add particles that are just out of reach. */
    if (point[axis] - node->high[axis] > distance * (1.0 + 1e-12) ||
      node->low[axis] - point[axis] > distance * (1.0 + 1e-12))
    {
      return;
    }
  }
  if (end - begin <= ORACLE_LEAF_SIZE)
  {
    for (int64_t s = begin; s < end; ++s)
    {
      visitor(field, field->tree->order[s], user);
    }
    return;
  }
  const int64_t middle = begin + (end - begin) / 2;
  oracle_visit(field, point, radius, visitor, user, 2 * n + 1, begin, middle);
  oracle_visit(field, point, radius, visitor, user, 2 * n + 2, middle, end);
}

/* ---- sums ---- */

typedef struct oracle_sums
{
  double point[3];
  const double* scalar;
  double fw, w, solid_w; /* sum V A W, sum V W of fluid, of solids */
  double grad_fw[3], grad_w[3], grad_solid[3];
  double magnitude;           /* the sum of the magnitudes of the gradient's terms */
  double center, unit, error; /* for oracle_rounding */
} oracle_sums;

static double oracle_offset_kernel(
  const oracle_field* field, const double point[3], int64_t j, double gradient[3])
{
  const double* x = &field->particles->position[3 * j];
  const double offset[3] = { point[0] - x[0], point[1] - x[1], point[2] - x[2] };
  return oracle_kernel_value(
    field->kernel, field->h_scale * field->particles->smoothing_length[j], offset, gradient);
}

static void oracle_add_particle(const oracle_field* field, int64_t j, void* user)
{
  oracle_sums* sums = user;
  double gradient[3];
  const double volume = field->particles->volume[j];
  const double w = oracle_offset_kernel(field, sums->point, j, gradient);
  if (field->particles->solid[j])
  {
    sums->solid_w += volume * w;
    for (int axis = 0; axis < 3; ++axis)
    {
      sums->grad_solid[axis] += volume * gradient[axis];
    }
    return;
  }
  const double amount = field->kind == ORACLE_WEIGHT ? 1.0 : fabs(sums->scalar[j] - sums->center);
  sums->magnitude += volume * amount *
    sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  sums->fw += volume * sums->scalar[j] * w;
  sums->w += volume * w;
  for (int axis = 0; axis < 3; ++axis)
  {
    sums->grad_fw[axis] += volume * sums->scalar[j] * gradient[axis];
    sums->grad_w[axis] += volume * gradient[axis];
  }
}

void oracle_evaluate(
  const oracle_field* field, const double* scalar, const double point[3], oracle_sample* sample)
{
  oracle_sums sums;
  memset(&sums, 0, sizeof(sums));
  memcpy(sums.point, point, sizeof(sums.point));
  sums.scalar = scalar ? scalar : field->particles->scalar;
  sums.center = field->kind == ORACLE_SHEPARD ? field->center : 0.0;
  memset(sample, 0, sizeof(*sample));
  if (field->particles->count > 0)
  {
    oracle_visit(field, point, 0.0, oracle_add_particle, &sums, 0, 0, field->particles->count);
  }
  const int solids = !field->particles->ignore_solids;
  sample->weight = sums.w;
  sample->trim_weight = sums.w + (solids ? sums.solid_w : 0.0);
  for (int axis = 0; axis < 3; ++axis)
  {
    sample->weight_gradient[axis] = sums.grad_w[axis];
    sample->trim_gradient[axis] = sums.grad_w[axis] + (solids ? sums.grad_solid[axis] : 0.0);
    sample->gradient[axis] = field->kind == ORACLE_WEIGHT ? sums.grad_w[axis] : sums.grad_fw[axis];
  }
  sample->value = field->kind == ORACLE_WEIGHT ? sums.w : sums.fw;
  sample->gradient_scale = sums.magnitude;
  if (field->kind == ORACLE_SHEPARD)
  {
    sample->value = sums.w != 0.0 ? sums.fw / sums.w : 0.0;
    sample->gradient_scale = sums.w != 0.0 ? sums.magnitude / fabs(sums.w) : 0.0;
    for (int axis = 0; axis < 3; ++axis)
    {
      sample->gradient[axis] =
        sums.w != 0.0 ? (sums.grad_fw[axis] - sample->value * sums.grad_w[axis]) / sums.w : 0.0;
    }
  }
}

double oracle_side(const oracle_field* field, const oracle_sample* sample, double iso)
{
  const double difference = sample->value - iso;
  return field->kind == ORACLE_SHEPARD && sample->weight < 0.0 ? -difference : difference;
}

/* ---- the boundary eigenvalue ---- */

typedef struct oracle_matrix
{
  double point[3];
  double m[3][3];
} oracle_matrix;

static void oracle_add_matrix(const oracle_field* field, int64_t j, void* user)
{
  oracle_matrix* sum = user;
  const particle_set* p = field->particles;
  double gradient[3];
  if (p->solid[j] && p->ignore_solids)
  {
    return;
  }
  oracle_offset_kernel(field, sum->point, j, gradient);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 3; ++column)
    {
      const double part = (p->position[3 * j + row] - sum->point[row]) * gradient[column] +
        (p->position[3 * j + column] - sum->point[column]) * gradient[row];
      sum->m[row][column] += 0.5 * p->volume[j] * part;
    }
  }
}

/* Writes the roots of the characteristic polynomial. Let m = q + s b, where b has trace 0, and the squares of its
 * entries add up to 6. The roots are q + 2 s cos(angle) at three angles a third of a turn apart, with cos(3 angle) =
 * det(b) / 2. */
static void oracle_eigenvalues(double m[3][3], double eigenvalues[3])
{
  const double q = (m[0][0] + m[1][1] + m[2][2]) / 3.0;
  double square = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    m[a][a] -= q;
    square += m[a][0] * m[a][0] + m[a][1] * m[a][1] + m[a][2] * m[a][2];
  }
  const double s = sqrt(square / 6.0);
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
    m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
    m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  const double cosine = s > 0.0 ? determinant / (2.0 * s * s * s) : 0.0;
  const double angle = acos(fmax(-1.0, fmin(1.0, cosine))) / 3.0;
  const double third = acos(-0.5); /* of a turn */
  eigenvalues[0] = q + 2.0 * s * cos(angle + third);
  eigenvalues[1] = q + 2.0 * s * cos(angle - third);
  eigenvalues[2] = q + 2.0 * s * cos(angle);
}

void oracle_boundary_eigenvalues(
  const oracle_field* field, const double point[3], double eigenvalues[3])
{
  oracle_matrix sum;
  memset(&sum, 0, sizeof(sum));
  memcpy(sum.point, point, sizeof(sum.point));
  if (field->particles->count > 0)
  {
    oracle_visit(field, point, 0.0, oracle_add_matrix, &sum, 0, 0, field->particles->count);
  }
  oracle_eigenvalues(sum.m, eigenvalues);
}

static void oracle_add_error(const oracle_field* field, int64_t j, void* user)
{
  oracle_sums* sums = user;
  if (field->particles->solid[j])
  {
    return;
  }
  double gradient[3];
  const double w = oracle_offset_kernel(field, sums->point, j, gradient);
  const double slope = fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]);
  const double amount =
    field->kind == ORACLE_WEIGHT ? 1.0 : fabs(field->particles->scalar[j] - sums->center);
  sums->w += field->particles->volume[j] * w;
  sums->error += field->particles->volume[j] * amount * sums->unit *
    (16.0 * fabs(w) + 4.0 * oracle_reach(field, j) * slope);
}

double oracle_rounding(const oracle_field* field, const double point[3], double unit)
{
  oracle_sample sample;
  oracle_evaluate(field, NULL, point, &sample);
  oracle_sums sums;
  memset(&sums, 0, sizeof(sums));
  memcpy(sums.point, point, sizeof(sums.point));
  sums.center = field->kind == ORACLE_SHEPARD ? sample.value : 0.0;
  sums.unit = unit;
  oracle_visit(field, point, 0.0, oracle_add_error, &sums, 0, 0, field->particles->count);
  if (field->kind != ORACLE_SHEPARD)
  {
    return sums.error;
  }
  return sums.w != 0.0 ? sums.error / fabs(sums.w) : INFINITY;
}

/* ---- volumes ---- */

typedef struct oracle_volume_sum
{
  int64_t j;
  int dimensions;
  double variance; /* of the kernel */
  const double* mass;
  double density, number;     /* number: sum h_k^d W */
  double fluid[3], solids[3]; /* the gradients of `number` */
} oracle_volume_sum;

static void oracle_add_density(const oracle_field* field, int64_t k, void* user)
{
  oracle_volume_sum* at = user;
  const particle_set* p = field->particles;
  if (p->ignore_solids && p->solid[k])
  {
    return;
  }
  double offset[3], gradient[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    offset[axis] = p->position[3 * at->j + axis] - p->position[3 * k + axis];
  }
  const double size = pow(p->smoothing_length[k], at->dimensions);
  const double w = oracle_kernel_value(field->kernel, p->smoothing_length[at->j], offset, gradient);
  at->density += (at->mass ? at->mass[k] : 1.0) * w;
  at->number += size * w;
  for (int axis = 0; axis < 3; ++axis)
  {
    (p->solid[k] ? at->solids : at->fluid)[axis] += size * gradient[axis];
  }
}

static double oracle_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns the factor F_j of oracle_compute_volumes (oracle.h). */
static double oracle_one_sided(const oracle_field* field, const oracle_volume_sum* at)
{
  const double h = field->particles->smoothing_length[at->j];
  const double square = oracle_dot(at->solids, at->solids);
  const double share =
    square > 0.0 ? fmin(fmax(-oracle_dot(at->fluid, at->solids) / square, 0.0), 1.0) : 0.0;
  double g[3];
  for (int axis = 0; axis < 3; ++axis)
  {
    g[axis] = at->fluid[axis] + share * at->solids[axis];
  }
  return 1.0 + 5.0 / 3.0 * at->variance * h * h * oracle_dot(g, g) / (at->number * at->number);
}

void oracle_compute_volumes(particle_set* particles, oracle_kernel kernel, int dimensions,
  const double* mass, const double* density)
{
  if (mass && density)
  {
    for (int64_t j = 0; j < particles->count; ++j)
    {
      particles->volume[j] = mass[j] / density[j];
    }
    return;
  }
  oracle_field field = oracle_make_field(particles, kernel, ORACLE_WEIGHT, 1.0);
  const double variance = oracle_kernel_variance(kernel, dimensions);
  for (int64_t j = 0; j < particles->count; ++j)
  {
    oracle_volume_sum at = { .j = j, .dimensions = dimensions, .variance = variance, .mass = mass };
    oracle_visit(&field, &particles->position[3 * j], oracle_reach(&field, j), oracle_add_density,
      &at, 0, 0, particles->count);
    /* The sum at an ignored solid may be 0; its volume is used nowhere. */
    particles->volume[j] = at.density == 0.0 ? 0.0
                                             : (mass ? mass[j] : 1.0) / at.density /
        (particles->solid[j] ? 1.0 : oracle_one_sided(&field, &at));
  }
  oracle_free_field(&field);
}

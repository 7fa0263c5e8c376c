/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Integrates an SPH kernel along the line of sight, then over rectangles of the image, and keeps
 * the integrals in a table. Uses only operations that all processors round alike. */

#include "mcor_plane.h"
#include "mcor_project.h"

#include <stdlib.h>

/* MCOR_COLUMN_CELLS, MCOR_COLUMN_FINE_CELLS: how many cells the table has along an axis, from the
 * centre to the end of the support. The fine table serves if the shorter side of a pixel is below
 * MCOR_SMALL_PIXEL times the greatest h. Errors fall at least with the third power of a cell's
 * size. If h is 3 pixels, errors are about 1e-8 of the most that a particle adds to a pixel; if h
 * is 50 pixels, below 1e-6. MCOR_PROFILE: how many steps job->profile has over the support. */
#define MCOR_COLUMN_CELLS 128
#define MCOR_COLUMN_FINE_CELLS 256
#define MCOR_SMALL_PIXEL 0.125
#define MCOR_PROFILE 2048
/* SPH kernels have kinks, where two polynomials meet, only at multiples of this number, in h. */
#define MCOR_KINK 0.5
#define MCOR_KINKS 16 /* room for the kinks on a line of sight through a tensor kernel */

/* Gauss quadrature from 0 to 1: the points and their weights. A cell of the table has
 * MCOR_CELL_POINTS points along an axis. A piece of a line of sight has MCOR_LINE_POINTS points,
 * with which the integral of a product of three cubic polynomials is exact. */
#define MCOR_CELL_POINTS 4
static const double mcor_cell_at[MCOR_CELL_POINTS] = { 0.069431844202973712388,
  0.33000947820757186760, 0.66999052179242813240, 0.93056815579702628761 };
static const double mcor_cell_weight[MCOR_CELL_POINTS] = { 0.17392742256872692869,
  0.32607257743127307131, 0.32607257743127307131, 0.17392742256872692869 };
#define MCOR_LINE_POINTS 5
static const double mcor_line_at[MCOR_LINE_POINTS] = { 0.046910077030668003601,
  0.23076534494715845448, 0.5, 0.76923465505284154552, 0.95308992296933199640 };
static const double mcor_line_weight[MCOR_LINE_POINTS] = { 0.11846344252809454376,
  0.23931433524968323402, 0.28444444444444444444, 0.23931433524968323402, 0.11846344252809454376 };

typedef struct mcor_column_job
{
  mcor_sph_kernel kernel;
  bool is_plane, is_aligned;
  const double (*axes)[3];
  double support;
  double profile[MCOR_PROFILE + 4]; /* column density at r = (index - 1) support / MCOR_PROFILE */
  mcor_column* column;
  double* sums;   /* [places along x][cells + 1]: integral of `values` along y */
  double* values; /* [places along x][cells + 1]: the density, times both lengths of the cell */
} mcor_column_job;

double mcor_column_reach(mcor_sph_kernel kernel, const double along[3])
{
  const double support = mcor_support_factor(kernel);
  return mcor_kernel_of(kernel)->is_tensor
    ? support * (fabs(along[0]) + fabs(along[1]) + fabs(along[2]))
    : support;
}

/* Returns the integral of a tensor kernel of h = 1 along a line of sight. x, y: where the line
 * crosses the image, from the kernel's centre. */
static double mcor_integrate_tensor(const mcor_column_job* job, double x, double y)
{
  double from[3], kinks[MCOR_KINKS], sum = 0;
  const double* along = job->axes[2];
  int count = 0;
  for (int a = 0; a < 3; ++a)
  {
    from[a] = x * job->axes[0][a] + y * job->axes[1][a];
    for (int k = -2; k <= 2 && along[a] != 0; ++k)
    {
      kinks[count++] = (k - from[a]) / along[a];
    }
  }
  qsort(kinks, (size_t)count, sizeof kinks[0], mcor_compare_doubles);
  for (int i = 1; i < count; ++i)
  {
    double piece = 0;
    for (int g = 0; g < MCOR_LINE_POINTS; ++g)
    {
      const double at = kinks[i - 1] + mcor_line_at[g] * (kinks[i] - kinks[i - 1]);
      double w = mcor_line_weight[g];
      for (int a = 0; a < 3; ++a)
      {
        w *= mcor_w_of(job->kernel, fabs(from[a] + at * along[a]));
      }
      piece += w;
    }
    sum += piece * (kinks[i] - kinks[i - 1]);
  }
  return sum;
}

/* Returns the column density of a kernel of h = 1 at (x, y) from its centre; in two dimensions,
 * returns the kernel itself. The unit is arbitrary: mcor_fill_nodes normalizes the table. */
static double mcor_density_at(const mcor_column_job* job, double x, double y)
{
  if (!job->column->is_radial)
  {
    return job->is_plane || job->is_aligned
      ? mcor_w_of(job->kernel, fabs(x)) * mcor_w_of(job->kernel, fabs(y))
      : mcor_integrate_tensor(job, x, y);
  }
  const double r = sqrt(x * x + y * y);
  if (job->is_plane || r >= job->support)
  {
    return job->is_plane ? mcor_w_of(job->kernel, r) : 0;
  }
  const double at = r * (MCOR_PROFILE / job->support);
  const int i = (int)at;
  const double t = at - i, *p = job->profile + i; /* p[1] is the value at t = 0 */
  return p[1] +
    0.5 * t *
    (p[2] - p[0] +
      t * (2 * p[0] - 5 * p[1] + 4 * p[2] - p[3] + t * (3 * (p[1] - p[2]) + p[3] - p[0])));
}

/* Writes to job->profile, for radii r, the integrals of w(sqrt(r^2 + z^2)) over z > 0. The range of
 * z is divided into pieces, which are longer for larger z. No piece extends beyond a place where w
 * changes to another polynomial. */
static void mcor_profile_slice(void* data, int slice, int64_t first, int64_t last)
{
  mcor_column_job* job = data;
  const double support = job->support;
  for (int64_t i = first; i < last; ++i)
  {
    const double r = (double)i * support / MCOR_PROFILE, least = fmax(r, support / 4096);
    double sum = 0, z = 0;
    for (double kink = MCOR_KINK * (floor(r / MCOR_KINK) + 1); kink <= support; kink += MCOR_KINK)
    {
      const double last_z = sqrt(kink * kink - r * r);
      while (z < last_z)
      {
        const double end = fmin(z + fmax(z, least), last_z);
        double piece = 0;
        for (int g = 0; g < MCOR_LINE_POINTS; ++g)
        {
          const double at = z + mcor_line_at[g] * (end - z);
          piece += mcor_line_weight[g] * mcor_w_of(job->kernel, sqrt(r * r + at * at));
        }
        sum += piece * (end - z);
        z = end;
      }
    }
    job->profile[i + 1] = sum;
  }
  (void)slice;
}

/* Returns the coordinate, in h, of evaluation i along an axis. The density is evaluated at the
 * nodes, then at the quadrature points of each cell. *length: how fast the coordinate grows there,
 * per cell. Cells of radial kernels are shorter near the centre, where the density may have a
 * cusp. */
static double mcor_place_of(const mcor_column* column, int axis, int64_t i, double* length)
{
  const double n = column->cells, reach = column->reach[axis];
  const int64_t point = i - column->cells - 1;
  const double t =
    (point < 0 ? (double)i
               : (double)(point / MCOR_CELL_POINTS) + mcor_cell_at[point % MCOR_CELL_POINTS]) /
    n;
  *length = reach / n * (column->is_radial ? 2 * t : column->is_odd ? 1 : 2);
  return reach * (column->is_radial ? t * t : column->is_odd ? t : 2 * t - 1);
}

static void mcor_column_slice(void* data, int slice, int64_t first, int64_t last)
{
  const mcor_column_job* job = data;
  const mcor_column* column = job->column;
  const int n = column->cells;
  for (int64_t i = first; i < last; ++i)
  {
    double width, height;
    const double x = mcor_place_of(column, 0, i, &width);
    double *sums = job->sums + i * (n + 1), *values = job->values + i * (n + 1);
    for (int l = 0; l <= n; ++l)
    {
      double cell = 0;
      const double y = mcor_place_of(column, 1, l, &height);
      values[l] = mcor_density_at(job, x, y) * width * height;
      for (int g = 0; g < MCOR_CELL_POINTS && l > 0; ++g)
      {
        const int point = n + 1 + MCOR_CELL_POINTS * (l - 1) + g;
        const double at = mcor_place_of(column, 1, point, &height);
        cell += mcor_cell_weight[g] * mcor_density_at(job, x, at) * width * height;
      }
      sums[l] = l > 0 ? sums[l - 1] + cell : 0;
    }
  }
  (void)slice;
}

/* Writes the nodes of the table. Integrates along x the sums along y that mcor_column_slice wrote,
 * then divides all numbers by the integral over the whole kernel. */
static void mcor_fill_nodes(const mcor_column_job* job)
{
  mcor_column* column = job->column;
  const int n = column->cells, width = n + 1;
  for (int l = 0; l <= n; ++l)
  {
    double sum = 0, values = 0;
    for (int k = 0; k <= n; ++k)
    {
      double* node = column->nodes + 4 * ((size_t)l * (size_t)width + (size_t)k);
      for (int g = 0; g < MCOR_CELL_POINTS && k > 0; ++g)
      {
        const int point = (n + 1 + MCOR_CELL_POINTS * (k - 1) + g) * width + l;
        sum += mcor_cell_weight[g] * job->sums[point];
        values += mcor_cell_weight[g] * job->values[point];
      }
      node[0] = sum;
      node[1] = job->sums[k * width + l];
      node[2] = values;
      node[3] = job->values[k * width + l];
    }
  }
  const size_t count = (size_t)width * (size_t)width;
  const double scale = 1 / (column->nodes[4 * (count - 1)] * (column->is_odd ? 4 : 1));
  for (size_t i = 0; i < 4 * count; ++i)
  {
    column->nodes[i] *= scale;
  }
  column->highest = mcor_density_at(job, 0, 0) * scale;
}

mcor_status mcor_make_column(
  const mcor_project_job* project, double least_pixel, mcor_column* column)
{
  mcor_context* context = project->context;
  const mcor_sph_kernel kernel = context->run.options->sph_kernel;
  mcor_column_job job = { .kernel = kernel,
    .is_plane = mcor_is_plane(context),
    .is_aligned = project->is_aligned,
    .axes = project->axes,
    .support = mcor_support_factor(kernel),
    .column = column };
  const int cells = least_pixel < MCOR_SMALL_PIXEL ? MCOR_COLUMN_FINE_CELLS : MCOR_COLUMN_CELLS;
  *column = (mcor_column){ .is_radial = !mcor_kernel_of(kernel)->is_tensor };
  column->is_odd = column->is_radial || job.is_plane || job.is_aligned;
  column->cells = column->is_odd ? cells : 2 * cells;
  for (int a = 0; a < 2; ++a)
  {
    column->reach[a] = mcor_column_reach(kernel, project->axes[a]);
  }
  const int places = column->cells + 1 + MCOR_CELL_POINTS * column->cells;
  const size_t width = (size_t)column->cells + 1;
  job.sums = malloc((size_t)places * width * sizeof(double));
  job.values = malloc((size_t)places * width * sizeof(double));
  column->nodes = malloc(4 * width * width * sizeof(double));
  mcor_status status = mcor_allocated(context, job.sums && job.values && column->nodes);
  if (status == MCOR_OK && column->is_radial && !job.is_plane)
  {
    status = mcor_parallel_run(context, MCOR_PROFILE, 64, mcor_profile_slice, &job, NULL);
    job.profile[0] = job.profile[2];
  }
  MCOR_THEN(status, mcor_parallel_run(context, places, 16, mcor_column_slice, &job, NULL));
  if (status == MCOR_OK)
  {
    mcor_fill_nodes(&job);
  }
  free(job.sums);
  free(job.values);
  return status;
}

mcor_column_side mcor_side_of(const mcor_column* column, int axis, double at)
{
  const double sign = column->is_odd && at < 0 ? -1 : 1;
  const double share = sign * at / column->reach[axis]; /* from -1 to 1; from 0 to 1 if E is odd */
  const double t = column->cells *
    (column->is_radial   ? sqrt(share)
        : column->is_odd ? share
                         : 0.5 * share + 0.5);
  const double clamped = t < 0 ? 0 : t < column->cells ? t : column->cells;
  mcor_column_side side;
  side.cell = (int)clamped < column->cells ? (int)clamped : column->cells - 1;
  const double v = clamped - side.cell, u = 1 - v;
  side.weight[0] = sign * (1 + 2 * v) * u * u;
  side.weight[1] = sign * v * u * u;
  side.weight[2] = sign * v * v * (3 - 2 * v);
  side.weight[3] = -sign * v * v * u;
  return side;
}

void mcor_sum_corners(const mcor_column* column, const mcor_column_side* sides, int count,
  const mcor_column_side* side, double* sums)
{
  const size_t width = 4 * ((size_t)column->cells + 1);
  const double *lower = column->nodes + (size_t)side->cell * width, *upper = lower + width;
  const double v0 = side->weight[0], v1 = side->weight[1], v2 = side->weight[2],
               v3 = side->weight[3];
  for (int i = 0; i < count; ++i)
  {
    const double *p = lower + 4 * sides[i].cell, *q = upper + 4 * sides[i].cell;
    const double* w = sides[i].weight;
    /* a0, a2: E at the lower and the upper end of the cell along x. a1, a3: dE/dx at these ends. */
    const double a0 = v0 * p[0] + v1 * p[2] + v2 * q[0] + v3 * q[2];
    const double a1 = v0 * p[1] + v1 * p[3] + v2 * q[1] + v3 * q[3];
    const double a2 = v0 * p[4] + v1 * p[6] + v2 * q[4] + v3 * q[6];
    const double a3 = v0 * p[5] + v1 * p[7] + v2 * q[5] + v3 * q[7];
    sums[i] = w[0] * a0 + w[1] * a1 + w[2] * a2 + w[3] * a3;
  }
}

/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* The boundary eigenvalue: the second boundary detector of the trimming.
 *
 *   S. Marrone, A. Colagrossi, D. Le Touze, G. Graziani: Fast free-surface detection and level-set
 *   function definition in SPH solvers. Journal of Computational Physics 229, 2010.
 *
 * It is the smallest eigenvalue of the symmetric part of a matrix M. M is the inverse of the
 * renormalisation matrix:
 *
 *   M(x) = sum V (x_j - x) (outer product) grad W(x - x_j)
 *
 * M is about the identity where particles surround x. Where they do not, the eigenvalue is low. */

typedef struct
{
  realv xx, yy, zz, xy, yz, zx;
} mcor_symmetric;

realv mcor_dot(const realv a[3], const realv b[3])
{
  return MCOR_FMA(a[2], b[2], MCOR_FMA(a[1], b[1], a[0] * b[0]));
}

/* Finds the gradient g of W / norm * h^3, and the derivative d of g along the unit vector e, which
 * is the Hessian times e. */
void mcor_weight_second(const realv u[3], real inv_h, const realv e[3], realv g[3], realv d[3])
{
#if MCOR_TENSOR
  realv w[3], slope[3], bend[3];
  for (int a = 0; a < 3; ++a)
  {
    const realv q = fabs(u[a]) * inv_h;
    w[a] = MCOR_W(q);
    slope[a] = sign(u[a]) * MCOR_DW(q) * inv_h;
    bend[a] = MCOR_DDW(q) * inv_h * inv_h;
  }
  for (int a = 0; a < 3; ++a)
  {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    g[a] = slope[a] * w[b] * w[c];
    d[a] = MCOR_FMA(bend[a] * w[b] * w[c], e[a],
      slope[a] * MCOR_FMA(slope[b] * w[c], e[b], slope[c] * w[b] * e[c]));
  }
#else
  const realv r2 = mcor_square(u[0], u[1], u[2]);
  const realv inv_r = mcor_rsqrt(r2), q = r2 * inv_r * inv_h;
  const realv slope = MCOR_DW(q) * inv_h, bend = MCOR_DDW(q) * inv_h * inv_h;
  const realv along = mcor_dot(e, u) * inv_r;
  for (int a = 0; a < 3; ++a)
  {
    const realv n = u[a] * inv_r;
    g[a] = slope * n;
    d[a] = MCOR_FMA(bend * along, n, slope * inv_r * MCOR_FMA(-along, n, e[a]));
  }
#endif
}

/* An element of M beside the diagonal counts as 0 if it is smaller in magnitude. So no product is a
 * denormal number, which some devices do not have. (M is about the identity.) */
#define MCOR_EIGEN_LEAST (MCOR_DOUBLE ? (real)1e-100 : (real)1e-9f)

/* Makes Jacobi's rotation of axes p and q, which turns element pq into 0. r is the third axis. vp,
 * vq: the axes p and q themselves, which are rotated, too. */
void mcor_eigen_rotate(
  realv* pp, realv* qq, realv* pq, realv* rp, realv* rq, realv vp[3], realv vq[3])
{
  const realv off = fabs(*pq) < MCOR_EIGEN_LEAST ? (realv)0 : *pq;
  const realv d = *qq - *pp, root2 = d * d + (real)4 * off * off;
  const realv t =
    (d < 0 ? (realv)-2 : (realv)2) * off / (fabs(d) + root2 * mcor_rsqrt(root2) + (real)1e-30f);
  const realv c = mcor_rsqrt((real)1 + t * t), s = t * c, p = *rp, q = *rq;
  *pp -= t * off;
  *qq += t * off;
  *pq = 0;
  *rp = c * p - s * q;
  *rq = s * p + c * q;
  for (int a = 0; a < 3; ++a)
  {
    const realv x = vp[a], y = vq[a];
    vp[a] = c * x - s * y;
    vq[a] = s * x + c * y;
  }
}

/* Returns the smallest eigenvalue of a symmetric matrix, and finds its eigenvector e. No division
 * is by 0, so any matrix is allowed. If eigenvalues coincide, e is one of their eigenvectors. */
realv mcor_eigen_smallest(const mcor_symmetric* m, realv e[3])
{
  mcor_symmetric a = *m;
  realv v[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  for (int sweep = 0; sweep < (MCOR_DOUBLE ? 6 : 5); ++sweep)
  {
    mcor_eigen_rotate(&a.xx, &a.yy, &a.xy, &a.zx, &a.yz, v[0], v[1]);
    mcor_eigen_rotate(&a.yy, &a.zz, &a.yz, &a.xy, &a.zx, v[1], v[2]);
    mcor_eigen_rotate(&a.zz, &a.xx, &a.zx, &a.yz, &a.xy, v[2], v[0]);
  }
  const fixv x = a.xx <= a.yy && a.xx <= a.zz, y = a.yy <= a.zz;
  realv n2 = 0;
  for (int c = 0; c < 3; ++c)
  {
    e[c] = x ? v[0][c] : y ? v[1][c] : v[2][c];
    n2 += e[c] * e[c];
  }
  const realv scale = mcor_rsqrt(n2);
  for (int c = 0; c < 3; ++c)
  {
    e[c] *= scale;
  }
  /* The Rayleigh quotient's error is only quadratic in the error of e. */
  return m->xx * e[0] * e[0] + m->yy * e[1] * e[1] + m->zz * e[2] * e[2] +
    (real)2 * (m->xy * e[0] * e[1] + m->yz * e[1] * e[2] + m->zx * e[2] * e[0]);
}

/* Finds the eigenvalue at all points and, if wanted, its gradient, which is e . (dM/dx_k) e with
 * the unit eigenvector e. The gradient is useless where the two smallest eigenvalues coincide.
 * plane: in two dimensions, uses only the matrix's elements of x and y. */
void mcor_evaluate_boundary(const mcor_grid* grid, mcor_query* query, mcor_tile* tile,
  const mcor_points* points, bool plane, bool want_gradient, mcor_quantity* boundary)
{
  mcor_symmetric m = { 0, 0, 0, 0, 0, 0 };
  realv at[3], e[3], u[3], g[3], d[3], slope, sum[3] = { 0, 0, 0 };
  mcor_points_relative(grid, query, points, at);
  for (bool first = true; mcor_tile_next(grid, query, tile, first); first = false)
  {
    for (int i = 0; i < tile->count; ++i)
    {
      mcor_points_from(
        at, points, MCOR_EACH(tile, x, i), MCOR_EACH(tile, y, i), MCOR_EACH(tile, z, i), u);
      const mcor_length length = mcor_length_of(u);
      mcor_weight_gradient(u, &length, MCOR_EACH(tile, inv_h, i), &slope, g);
      const realv v = MCOR_EACH(tile, MCOR_TRIM_WEIGHT, i) * slope, half_v = (real)0.5 * v;
      m.xx = MCOR_FMA(-v, u[0] * g[0], m.xx);
      m.yy = MCOR_FMA(-v, u[1] * g[1], m.yy);
      m.zz = MCOR_FMA(-v, u[2] * g[2], m.zz);
      m.xy = MCOR_FMA(-half_v, MCOR_FMA(u[0], g[1], u[1] * g[0]), m.xy);
      m.yz = MCOR_FMA(-half_v, MCOR_FMA(u[1], g[2], u[2] * g[1]), m.yz);
      m.zx = MCOR_FMA(-half_v, MCOR_FMA(u[2], g[0], u[0] * g[2]), m.zx);
    }
  }
  if (plane) /* the smallest eigenvalue must be one of the plane's two, not the third axis's */
  {
    m.zz = (real)4 * (fabs(m.xx) + fabs(m.yy) + (real)1);
  }
  boundary->value = mcor_eigen_smallest(&m, e);
  for (bool first = true; want_gradient && mcor_tile_next(grid, query, tile, first); first = false)
  {
    for (int i = 0; i < tile->count; ++i)
    {
      mcor_points_from(
        at, points, MCOR_EACH(tile, x, i), MCOR_EACH(tile, y, i), MCOR_EACH(tile, z, i), u);
      mcor_weight_second(u, MCOR_EACH(tile, inv_h, i), e, g, d);
      const realv along_u = mcor_dot(e, u), along_g = mcor_dot(e, g);
      for (int a = 0; a < 3; ++a)
      {
        sum[a] = MCOR_FMA(
          -MCOR_EACH(tile, MCOR_TRIM_WEIGHT, i), MCOR_FMA(e[a], along_g, along_u * d[a]), sum[a]);
      }
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    boundary->gradient[a] = sum[a];
  }
}

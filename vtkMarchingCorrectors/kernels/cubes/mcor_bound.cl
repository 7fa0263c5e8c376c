/* SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
 * SPDX-License-Identifier: BSD-3-Clause */

/* Bounds the field in a box [III-C]: finds, from the particles that reach the box, whether all
 * nodes in the box certainly have too low weights (void), are above the iso value, or below it.
 *
 * With c_j = V_j norm / h_j^3 * f_j, where f_j is A_j - iso (Shepard), A_j (sum) or 1 (weight sum),
 * the sign of field - iso is the sign of F = sum c_j w_j - level, with level = 0 (Shepard) or iso.
 * At every point of the box, each w_j lies between its least and its greatest value in the box, so
 * that
 *
 *   F >= sum of c_j * (least w_j where c_j > 0, greatest where c_j < 0) - level,
 *
 * and F has an upper bound in the same way. This holds for kernels with negative lobes, too. */

/* Rounding. u is the unit roundoff, n the number of particles that reach the box. The relative
 * error of a distance that a node's evaluation computes is at most 8 u. The bound uses distances
 * that are shorter or longer by this error. A slightly larger box covers the rounding of positions.
 * Given the distance, the relative error of w is less than 96 u, because no kernel subtracts large
 * terms where w is small. The error of a sum of n terms, each a product of a few factors, is at
 * most about (n + 16) u times the sum of the absolute terms, whatever the order of the terms. Hence
 * the errors of the bound and of a node's value together are at most
 *
 *   k / (1 - k) * sum |c_j| * greatest |w_j|,  k = (2 n + 256) u,
 *
 * where c_j has the factor |A_j - iso| for a Shepard mean. A mean is the quotient of two sums, so
 * its error needs the factor |A_j| + |iso|. The code takes |A_j - iso| + 2 |iso|, which is not
 * less. */
#define MCOR_UNIT_ROUNDOFF (MCOR_DOUBLE ? (real)1.1102230246251565e-16 : (real)5.9604645e-8f)
#define MCOR_BOUND_ROUNDINGS ((real)256)
#define MCOR_BOUND_LARGER ((real)1 + 16 * MCOR_UNIT_ROUNDOFF)
#define MCOR_BOUND_NEARER ((real)1 - 8 * MCOR_UNIT_ROUNDOFF)
#define MCOR_BOUND_FARTHER ((real)1 + 8 * MCOR_UNIT_ROUNDOFF)

#if MCOR_TENSOR
/* Finds the least and the greatest one-dimensional w for distances from |d| - e to |d| + e. As the
 * distance grows, w falls below 0, then rises to 0. */
void mcor_bound_interval(realv d, real e, realv inv_h, realv* low, realv* high)
{
  const realv near = fmax(fabs(d) - e, (realv)0) * (inv_h * MCOR_BOUND_NEARER);
  const realv far = (fabs(d) + e) * (inv_h * MCOR_BOUND_FARTHER);
  const realv a = MCOR_W(near), b = MCOR_W(far);
  *high = fmax(a, b);
  *low = (near < mcor_turning_mprime4 && far > mcor_turning_mprime4) ? (realv)mcor_lowest_mprime4
                                                                     : fmin(a, b);
}

/* Finds the least and the greatest value of a particle's w at the points of a box. e: half the size
 * of the box; dx, dy, dz: from the box's centre to the particle. */
void mcor_bound_weights(
  realv dx, realv dy, realv dz, const real e[3], realv inv_h, realv* least, realv* greatest)
{
  realv xl, xh, yl, yh, zl, zh;
  mcor_bound_interval(dx, e[0], inv_h, &xl, &xh);
  mcor_bound_interval(dy, e[1], inv_h, &yl, &yh);
  mcor_bound_interval(dz, e[2], inv_h, &zl, &zh);
  const realv al = fmin(fmin(xl * yl, xl * yh), fmin(xh * yl, xh * yh));
  const realv ah = fmax(fmax(xl * yl, xl * yh), fmax(xh * yl, xh * yh));
  *least = fmin(fmin(al * zl, al * zh), fmin(ah * zl, ah * zh));
  *greatest = fmax(fmax(al * zl, al * zh), fmax(ah * zl, ah * zh));
}
#else
/* Returns a particle's w at the point of a box that is nearest to the particle (side -1) or
 * farthest from it (side 1). dx, dy, dz: from the box's centre to the particle; e: the box's half
 * size. */
realv mcor_bound_weight(realv dx, realv dy, realv dz, const real e[3], real side, realv inv_h)
{
  const realv x = fmax(fabs(dx) + side * e[0], (realv)0);
  const realv y = fmax(fabs(dy) + side * e[1], (realv)0);
  const realv z = fmax(fabs(dz) + side * e[2], (realv)0);
  const real off = side > 0 ? MCOR_BOUND_FARTHER : MCOR_BOUND_NEARER;
  return MCOR_W(mcor_sqrt(mcor_square(x, y, z)) * (inv_h * off));
}

/* Finds a particle's least w, at the farthest point of the box, and the greatest w, at the nearest
 * point: w falls with the distance. */
void mcor_bound_weights(
  realv dx, realv dy, realv dz, const real e[3], realv inv_h, realv* least, realv* greatest)
{
  *least = mcor_bound_weight(dx, dy, dz, e, (real)1, inv_h);
  *greatest = mcor_bound_weight(dx, dy, dz, e, (real)-1, inv_h);
}
#endif

/* Sums over the particles that reach a box; the comment on rounding above explains `size`. */
typedef struct
{
  int count;
  realv low, high;   /* bounds of F + level */
  realv size;        /* sum of the absolute terms */
  realv weight;      /* sum of the trimming weights times the greatest w */
  realv weight_size; /* sum of the absolute values of these terms, if terms may be negative */
} mcor_bound;

/* Adds the tile's particles to the sums for the query's box. */
void mcor_bound_add(const mcor_query* query, const mcor_tile* tile, real iso, mcor_bound* bound)
{
  const mcor_span box = query->box;
  const real e[3] = { box.half_size[0] * MCOR_BOUND_LARGER, box.half_size[1] * MCOR_BOUND_LARGER,
    box.half_size[2] * MCOR_BOUND_LARGER };
  for (int i = 0; i < tile->count; i += MCOR_LANES)
  {
    const realv x = MCOR_TILE(tile, x, i) - box.center[0];
    const realv y = MCOR_TILE(tile, y, i) - box.center[1];
    const realv z = MCOR_TILE(tile, z, i) - box.center[2];
    const realv weight = MCOR_TILE(tile, weight, i);
#if MCOR_FIELD == MCOR_WEIGHT_SUM
    const realv c = weight;
#else
    const realv c = weight * MCOR_FIELD_TERM(MCOR_TILE(tile, value, i), iso);
#endif
    realv least, greatest;
    mcor_bound_weights(x, y, z, e, MCOR_TILE(tile, inv_h, i), &least, &greatest);
    const realv most = MCOR_TENSOR ? fmax(fabs(least), fabs(greatest)) : greatest;
    const realv above = fmax(c, (realv)0), below = fmin(c, (realv)0);
    bound->low = MCOR_FMA(above, least, MCOR_FMA(below, greatest, bound->low));
    bound->high = MCOR_FMA(above, greatest, MCOR_FMA(below, least, bound->high));
    bound->size = MCOR_FMA(fabs(c), most, bound->size);
#if MCOR_FIELD == MCOR_SHEPARD
    bound->size = MCOR_FMA(weight * (2 * fabs(iso)), most, bound->size);
#endif
#if MCOR_FIELD != MCOR_WEIGHT_SUM
    const realv trim_weight = MCOR_TILE(tile, MCOR_TRIM_WEIGHT, i);
    bound->weight = MCOR_FMA(trim_weight, greatest, bound->weight);
#if MCOR_TENSOR
    bound->weight_size = MCOR_FMA(trim_weight, most, bound->weight_size);
#endif
#endif
  }
  bound->count += tile->count;
}

/* Returns the state that the sums prove for the box: MCOR_VOID, MCOR_ABOVE or MCOR_BELOW. Returns
 * MCOR_EXAMINE if they prove none of these states. */
int mcor_bound_state(const mcor_bound* bound, real iso, real node_threshold)
{
  const real k = (2 * (real)bound->count + MCOR_BOUND_ROUNDINGS) * MCOR_UNIT_ROUNDOFF;
  if (k >= (real)0.5)
  {
    return MCOR_EXAMINE;
  }
  const real share = k / (1 - k), level = MCOR_FIELD == MCOR_SHEPARD ? (real)0 : iso;
  const real margin = share * (mcor_lane_sum(bound->size) + fabs(level));
#if MCOR_FIELD != MCOR_WEIGHT_SUM
  const real weight = mcor_lane_sum(bound->weight);
  const real weight_size = MCOR_TENSOR ? mcor_lane_sum(bound->weight_size) : weight;
  if (weight + share * (weight_size + fabs(node_threshold)) < node_threshold)
  {
    return MCOR_VOID;
  }
#endif
  return mcor_lane_sum(bound->low) > level + margin ? MCOR_ABOVE
    : mcor_lane_sum(bound->high) < level - margin   ? MCOR_BELOW
                                                    : MCOR_EXAMINE;
}

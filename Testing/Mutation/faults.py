# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Small faults, each a text that stands in one place of the library (white space does not matter), what
it becomes, and the tests of which one must fail."""
from typing import NamedTuple


class Fault(NamedTuple):
    name: str
    tests: list
    old: str
    new: str


FAULTS = [
    # ---- reuse between calls ----
    Fault("reuse: a changed h_scale is ignored", ["core_reuse"],
          "options->h_scale == o->h_scale &&", ""),
    Fault("reuse: a changed ignore_solids is ignored", ["core_reuse"],
          "particles && parameters && uses_solids == context->uses_solids;",
          "particles && parameters;"),
    Fault("reuse: a changed constant is ignored", ["core_reuse"],
          "&& (a->data || a->constant == b->constant);", ";"),
    Fault("reuse: flags stay set after a failed call", ["core_reuse"],
          "if (status != MCOR_OK) { context->grid_valid = context->value_valid = context->nodes_valid = false;",
          "if (status != MCOR_OK) {"),
    Fault("reuse: another component of the scalar is ignored", ["core_reuse"],
          "input->scalar_component == last->scalar_component &&", ""),
    Fault("release: a buffer is forgotten", ["core_reuse"],
          "&t->keys, &t->distinct, &t->index,", "&t->distinct, &t->index,"),
    # ---- particles and volumes ----
    Fault("estimate: the smoothing length is 8 % too large", ["core_grid"],
          "*estimate = 1.3 * mcor_median_of", "*estimate = 1.4 * mcor_median_of"),
    Fault("volumes: those computed of solids are off", ["core_grid"],
          "weight[i] = solid[order[i]] ? (real)0 : w;",
          "weight[i] = solid[order[i]] ? (real)0 : w; trim_weight[i] = solid[order[i]] ? mass[i] : w;"),
    # ---- gathering particles ----
    Fault("gather: vertices that move up leave what was gathered", ["core_correct"],
          "MCOR_ANY(*t < reached_low || *t > reached_high)", "MCOR_ANY(*t < reached_low)"),
    Fault("gather: vertices that move down leave what was gathered", ["core_correct"],
          "MCOR_ANY(*t < reached_low || *t > reached_high)", "MCOR_ANY(*t > reached_high)"),
    Fault("gather: ends at the first point's upper side", ["core_correct"],
          "most = fmax(most, last);", ""),
    Fault("gather: begins at the first point's lower side", ["core_correct"],
          "least = fmin(least, first);", ""),
    Fault("gather: edges count by their lower side only", ["core_correct"],
          "high * e->ax, high * e->ay, high * e->az", "low * e->ax, low * e->ay, low * e->az"),
    Fault("gather: rows of cells stop short upwards", ["core_grid", "core_correct"],
          "min(mcor_cell_of(level, a, mcor_query_beyond(query->high[a], reach)), level->cells[a] - 1);",
          "min(mcor_cell_of(level, a, query->high[a]), level->cells[a] - 1);"),
    Fault("gather: rows stop short upwards", ["core_grid", "core_correct"],
          "high = mcor_query_beyond(query->high[0], reach);", "high = query->high[0];"),
    Fault("gather: planes of rows stop short upwards", ["core_grid", "core_correct"],
          "const int z = next < end ? mcor_cell_of_particle(level, 2, grid->pz[next]) : level->cells[2];",
          "const int z = next + 1 < end ? mcor_cell_of_particle(level, 2, grid->pz[next]) : level->cells[2];"),
    # ---- periods, ranks ----
    Fault("period: search cells are not those of the first period again", ["core_period"],
          "if (period == 0)\n  {\n    level->inv_cell", "if (period >= 0)\n  {\n    level->inv_cell"),
    Fault("ranks: rounds end before cells of other boxes have grown", ["core_ranks", "core_period"],
          "*grown = fresh != 0;", "*grown = false;"),
    Fault("ranks: boxes side by side share a layer of cells", ["core_box", "core_ranks"],
          "ceil(sides[2 * axis + s] / lattice->cube - 0.5);",
          "ceil(sides[2 * axis + s] / lattice->cube - 0.5) + s;"),
    Fault("box: particles that reach its upper side alone are left out", ["core_box"],
          "low <= 0 && high >= 0;", "low <= 0 && high >= reach;"),
    Fault("period: the last image of a particle is left out", ["core_period"],
          "(int)floor(high / period) : 0;", "(int)ceil(low / period) : 0;"),
    # ---- probe, derivatives ----
    Fault("probe: a point at the threshold is not valid", ["core_probe"],
          "valid = weight >= job->threshold &&", "valid = weight > job->threshold &&"),
    Fault("probe: points below the threshold are valid", ["core_probe"],
          "valid = weight >= job->threshold &&", "valid ="),
    Fault("derive: differences are values", ["core_derive"],
          "MCOR_CONVERT_REALV(MCOR_AS_FIXV(value) - own[c]);", "MCOR_CONVERT_REALV(MCOR_AS_FIXV(value));"),
    # ---- adaptive cubes ----
    Fault("tree: a level begins above its least smoothing length", ["core_tree"],
          "level < top && h >= ldexp(h_min, level + 1)", "level < top && h > ldexp(h_min, level + 1)"),
    Fault("tree: a brick that touches by a corner is not divided", ["core_tree"],
          "for (int d = 0; d < 8 && made; ++d)", "for (int d = 0; d < 7 && made; ++d)"),
    Fault("tree: particles split bricks of their own level alone that hold them", ["core_tree"],
          "h[i] * job->reach, &job", "0, &job"),
    Fault("graded: smoothing lengths keep the unit of the finest cubes", ["core_graded"],
          "MCOR_REAL(ldexp(1, level)), MCOR_BUFFER(&grid->view_inv_h)",
          "MCOR_REAL(1), MCOR_BUFFER(&grid->view_inv_h)"),
    Fault("graded: inside is proved by any lane for all", ["core_graded"],
          "MCOR_ALL(sums.w[g] > iso * (real)1.0001f); } return inside;",
          "MCOR_ANY(sums.w[g] > iso * (real)1.0001f); } return inside;"),
    Fault("graded: a leaf does not see finer bricks up along an edge of it", ["core_graded"],
          "d < 27 && split; ++d)", "d < 25 && split; ++d)"),
    # ---- graded cells ----
    Fault("graded: diagonals on an edge of the cell", ["core_graded_cell", "core_graded_trees"],
          "(common & 0xffffff) != 0 || (faces & (faces - 1)) != 0;", "(common & 0xffffff) != 0;"),
    Fault("graded: whole faces end runs at split edges", ["core_graded_cell", "core_graded_trees"],
          "while (above >> ring[next] & 1)", "while (above >> ring[next] & ring[next] % 2 & 1)"),
    # ---- marching ----
    Fault("march: the second diagonal of pinched edges", ["core_march"],
          "crossed & ((q[0] & q[3] & ~q[1] & ~q[2]) | (q[1] & q[2] & ~q[0] & ~q[3]));",
          "crossed & (q[0] & q[3] & ~q[1] & ~q[2]);"),
    Fault("march: edges next to cells that are not used are not told apart", ["core_trim"],
          "(q[1] & q[2] & ~q[0] & ~q[3])); to[a] = crossed; to[3 + a] = crossed & ~(q[0] & q[1] & q[2] & q[3]);",
          "(q[1] & q[2] & ~q[0] & ~q[3])); to[a] = crossed; to[3 + a] = 0;"),
    # ---- complete seeds ----
    Fault("seeds: M'4's lowest lobe is missing in the bound", ["core_bound"],
          "far > mcor_turning_mprime4) ? (realv)mcor_lowest_mprime4", "far > mcor_turning_mprime4) ? (realv)0"),
    Fault("seeds: inside is proved by any lane for all", ["core_bound"],
          "MCOR_ALL(sums.w[g] > iso * (real)1.0001f); } } return inside;",
          "MCOR_ANY(sums.w[g] > iso * (real)1.0001f); } } return inside;"),
    Fault("seeds: one diagonal row of neighbours is skipped", ["core_bound", "core_seed"],
          "d < 9; ++d) { const int y = brick.y + d % 3 - 1,", "d < 8; ++d) { const int y = brick.y + d % 3 - 1,"),
    # ---- order, correction ----
    Fault("grid: a fluid and a solid particle at one point have no order", ["core_context"],
          "volume[i] < volume[j] : solid[i] < solid[j];", "volume[i] < volume[j] : 0;"),
    Fault("correct: Newton's step may leave the bracket", ["core_correct"],
          "next > low && next < high && newton", "newton"),
    # ---- trimming, normals ----
    Fault("trim: a corner at the threshold is inside", ["core_trim"],
          "(weight[t[c]] > threshold) << c", "(weight[t[c]] >= threshold) << c"),
    Fault("trim: the gradient of the fluid's share leaves solids out", ["core_wall"],
          "at->fx - fluid_share * at->wx", "at->fx"),
    Fault("trim: where the surface ends at solids alone", ["core_wall"],
          "fmin(quantity[i] - threshold, share)", "share"),
    Fault("trim: the weight's gradient leaves solids out", ["core_trim"],
          "at->wx = tx; at->wy = ty; at->wz = tz;", "at->wx = wx; at->wy = wy; at->wz = wz;"),
    Fault("normal: triangles are not added up", ["core_normal"],
          "sums[3 * (int64_t)t[c / 3] + c % 3] += n[c % 3];",
          "sums[3 * (int64_t)t[c / 3] + c % 3] = n[c % 3];"),
    # Last, as kernels of the other precision may run on such data for ever.
    Fault("reuse: a changed precision is ignored", ["core_reuse"],
          "&& options->precision == o->precision &&", "&&"),
    # ---- adaptive cubes: decisions of the field, progress ----
    Fault("graded: the field decides on faces beside finer cells, too", ["core_graded_topology"],
          "const ulong reached = between & (u[0]", "const ulong reached = (u[0]"),
    Fault("tree: nobody is asked while particles split bricks", ["core_tree"],
          "MCOR_TRY(job->failed[s] ? mcor_fail_leaves(context) : MCOR_OK); } MCOR_TRY(mcor_report_launch(context));",
          "MCOR_TRY(job->failed[s] ? mcor_fail_leaves(context) : MCOR_OK); }"),
]

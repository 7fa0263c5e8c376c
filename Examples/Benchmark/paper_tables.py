# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Table c: Tables I to V of the paper, in the paper's form, each figure beside the paper's own.

The paper: B. Schindler, R. Fuchs, J. Waser, R. Peikert: Marching Correctors - Fast and Precise
Polygonal Isosurfaces of SPH Data, 2011; one core of a Xeon E5430 and a GeForce GTX 295. Its data
sets are not public. Ours have the same numbers of particles and neighbours, the same kernels, and
iso values that give about as many triangles. As in the paper, the field is the plain sum (--field
sum), and seeds come from pairs of particles (--seeds pairs).

What the rows are, in phases of marching-correctors:

  grid construction         input (checks, transfer to the device), search grid
  seed cell selection       seeds
  surface extraction        extraction, correction, trimming, output of a run with --preview; such a run's
                            correction phase evaluates the weights that trimming needs
  s.e. with correction      the same phases of a run without --preview; normals are the gradients
  totals                    seed cell selection and surface extraction, without the grid
"""
import dataclasses

from measure import SETS, mebibytes, need_surface, ratio, seconds_of

H_SCALES = (1.0, 0.75, 0.5)
CUBE_FACTORS = (0.5, 1.0)


@dataclasses.dataclass(frozen=True)
class Data:
    """A data set of the paper, and what the paper says of it. A tuple of six has an entry for each column of the paper's
    tables: h scale 1, 0.75 and 0.5, each with cubes of 0.5 h and h. None: not in the paper."""
    table: str
    title: str
    kind: str
    count: int
    scalar: str
    iso: float
    coarse_iso: float  # The iso value for sets of a few thousand particles, which do not resolve the surface of `iso`.
    grid: tuple
    seeds: tuple
    preview: tuple
    corrected: tuple = (None,) * 6
    total: tuple = ()
    total_corrected: tuple = (None,) * 6
    # Tables IV and V: the members below have one entry for cubes of 0.5 h, and one for cubes of h. Smoothing lengths are not
    # scaled.
    cube: tuple = ()
    cells: tuple = ()
    lengths: tuple = ()


# The totals are as the paper prints them; some are not the sum of the paper's other rows.
PAPER = {
    "rings": Data(
        "I", "vortex rings", "vortex-rings", 10000000, "VorticityMagnitude", 50, 20,
        grid=(1.13, 1.13, 1.4, 1.4, 2.15, 2.15),
        seeds=(0.72, 0.72, 0.55, 0.55, 0.35, 0.35),
        preview=(3.48, 0.73, 2.90, 0.59, 1.94, 0.39),
        total=(4.20, 1.45, 3.45, 1.14, 2.29, 0.74)),
    "tsunami": Data(
        "II", "tsunami: a tank with 200 neighbours", "dense-tank", 1200000, "Pressure", 5500,
        2500,
        grid=(0.08, 0.08, 0.1, 0.1, 0.16, 0.16),
        seeds=(0.7, 0.7, 0.36, 0.36, 0.17, 0.17),
        preview=(2.65, 0.5, 1.72, 0.34, 0.94, 0.19),
        corrected=(3.45, 0.7, 3.02, 0.65, 1.84, 0.43),
        total=(3.35, 1.20, 2.08, 0.7, 1.11, 0.36),
        total_corrected=(4.15, 1.40, 3.38, 1.01, 2.11, 0.60),
        cube=(0.028, 0.056),
        cells=((2401980, 303408), (73602, 14917), (47007, 8012), (29388, 7183), (56543, 14535)),
        lengths=((0.000218, 0.000807), (0.009890, 0.018360), (0.000402, 0.001253))),
    "dam": Data(
        "III", "dam break: variable smoothing length", "dam-break", 670000, "Lambda2", -140,
        -100,
        grid=(0.07, 0.07, 0.1, 0.1, 0.17, 0.17),
        seeds=(0.08, 0.08, 0.05, 0.05, 0.04, 0.04),
        preview=(0.73, 0.17, 0.54, 0.13, 0.38, 0.09),
        corrected=(2.13, 0.48, 1.63, 0.37, 0.98, 0.23),
        total=(0.81, 0.25, 0.59, 0.18, 0.42, 0.13),
        total_corrected=(2.21, 0.56, 1.68, 0.42, 1.02, 0.27),
        cube=(0.006, 0.012),
        cells=((6802912, 855456), (98811, 41327), (38286, 11151), (156810, 36319), (307278, 73739)),
        lengths=((0.000130, 0.000453), (0.001997, 0.005511), (0.000182, 0.000550)))}

CELL_ROWS = (("Virtual cells", "virtual_cells"), ("Seed cells", "seed_cells"),
             ("Non-intersected cells", "seed_cells_not_intersected"),
             ("Total cells used", "cells_used"), ("Isosurface triangles", "triangles"))
LENGTH_ROWS = (("Mean vector norm", "correction_mean"), ("Max vector norm", "correction_max"),
               ("St.dev. vector norm", "correction_standard_deviation"))


def beside(ours, paper, text):
    """Returns our figure as text; in brackets the paper's figure, and ours divided by the paper's."""
    if paper is None:
        return f"{text(ours)} (-)"
    return f"{text(ours)} ({text(paper)}; {ratio(ours / paper)})"


def percent(value):
    return f"{100 * value:.0f} %"


def time_row(name, ours, paper, text=seconds_of):
    return [name, *(beside(a, b, text) for a, b in zip(ours, paper))]


def cost(corrected, total):
    """Returns, for each column, the time of the correction divided by the total without correction."""
    return [None if a is None else (a - b) / b for a, b in zip(corrected, total)]


def run_columns(benchmark, data, count, iso):
    path = benchmark.sets.get(data.kind, count)

    def run(column, field, *more):
        return benchmark.program.run(path, (
            "--scalar", data.scalar, "--iso", iso, *SETS[data.kind][2], "--no-attributes", "--field", field, "--seeds",
            "pairs", "--cubes", "uniform", "--h-scale", column["h_scale"], "--cube-factor", column["cube_factor"], *more))

    columns = [{"h_scale": scale, "cube_factor": factor} for scale in H_SCALES for factor in CUBE_FACTORS]
    for column in columns:
        column["corrected"] = run(column, "sum")
        column["preview"] = run(column, "sum", "--preview")
        if column["h_scale"] == 1:  # A kernel shorter than the particles' distance may leave no surface.
            need_surface(column["corrected"], data.title)
            column["shepard"] = run(column, "shepard")
    return columns


def sum_of(result, *names):
    return sum(result["phases"][name] for name in names)


def extraction(result):
    return sum_of(result, "extraction", "correction", "trimming", "output")


def print_times(out, data, columns):
    """Prints Table I, II or III."""
    first = columns[0]["corrected"]["statistics"]
    iso = columns[0]["corrected"]["parameters"]["iso_values"][0]
    h = first["smoothing_length_range"]
    out.heading(f"Table {data.table}: {data.title}",
                f"{first['fluid_particles']:,} particles, {data.scalar} = {iso:g}, h {h[0]:.4g} .. {h[1]:.4g}. Seconds; in "
                "brackets the paper's and ours / the paper's.", mark="###")
    preview, corrected = ([column[kind] for column in columns] for kind in ("preview", "corrected"))
    seeds = [sum_of(r, "seeds") for r in preview]
    total = [sum_of(r, "seeds") + extraction(r) for r in preview]
    total_corrected = [sum_of(r, "seeds") + extraction(r) for r in corrected]
    rows = [
        time_row("Grid construction", [sum_of(r, "input", "search_grid") for r in preview],
                 data.grid),
        time_row("Seed cell selection", seeds, data.seeds),
        time_row("Surface extraction", [extraction(r) for r in preview], data.preview),
        time_row("S.e. with correction", [extraction(r) for r in corrected], data.corrected),
        time_row("Total w/o corr.", total, data.total),
        time_row("Total with corr.", total_corrected, data.total_corrected),
        time_row("Cost of correction / total w/o", cost(total_corrected, total),
                 cost(data.total_corrected, data.total), percent),
        ["Triangles", *(f"{r['triangles']:,}" for r in corrected)],
        ["Vertices", *(f"{r['statistics']['points']:,}" for r in corrected)],
        ["Peak memory", *(mebibytes(r["bytes"]) for r in corrected)]]
    out.table(["h scaling factor; grid size",
               *(f"{c['h_scale']:g}; {c['cube_factor']:g}h" for c in columns)], rows)


def print_last(out, results):
    """Prints Tables IV and V for the data sets that have them."""
    shown = [(PAPER[name], columns[i], i) for name, columns in results.items() if PAPER[name].cube for i in range(2)]
    if not shown:
        return
    header = ["", *(f"{data.title.split(':')[0]}, {CUBE_FACTORS[i]:g}h" for data, _, i in shown)]
    out.heading("Table IV: cells", "h scaling factor 1; in brackets the paper's and ours / the paper's.", mark="###")
    out.table(header, [
        ["Grid size", *(beside(column["corrected"]["parameters"]["cube_size"], data.cube[i], "{:.4g}".format)
                        for data, column, i in shown)],
        *([name, *(beside(column["corrected"]["statistics"][key], data.cells[row][i], "{:,.0f}".format)
                   for data, column, i in shown)] for row, (name, key) in enumerate(CELL_ROWS))])
    out.heading("Table V: correction",
                "Per grid size, h scaling factor 1; in brackets the paper's and ours / the paper's. The last rows are "
                "those of the Shepard field instead of the sum.", mark="###")
    out.table(header, [
        [name + note, *(beside(column[field]["statistics"][key] / column[field]["parameters"]["cube_size"],
                               data.lengths[row][i] / data.cube[i], "{:.4f}".format) for data, column, i in shown)]
        for field, note in (("corrected", ""), ("shepard", ", Shepard")) for row, (name, key) in enumerate(LENGTH_ROWS)])


def paper_tables(benchmark):
    out = benchmark.report
    out.heading("c. The paper's tables")
    results = {}
    for name, data in PAPER.items():
        count = benchmark.paper_counts.get(name, data.count)
        if count:
            iso = data.coarse_iso if benchmark.quick else data.iso
            results[name] = run_columns(benchmark, data, count, iso)
            print_times(out, data, results[name])
    print_last(out, results)
    return results

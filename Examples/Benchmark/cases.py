# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""The cases of the benchmark that are not tables; see README.md."""
import pathlib
import statistics
import time

import numpy as np
import vtk
from measure import (DATA, array_of, compete, exclude_others, interpolator, make_particles, names_of, peak_bytes,
                     points_of, read, text_of)
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def medians(rows):
    return [statistics.median(column) for column in zip(*rows)]


def adaptive(benchmark):
    """Measures adaptive cubes. With given particles, prints for uniform and for adaptive cubes: the triangles, the
    seconds of a process's second surface, and the processor seconds of two surfaces minus those of one surface. Without
    given particles, times whole processes with adaptive cubes, for smoothing lengths that vary by 1:10, 1:100 and 1:1000."""
    out, program = benchmark.report, benchmark.program
    if not benchmark.files:
        options = ["--cubes", "adaptive", *(benchmark.more or ["--free-surface"])]
        for kind in ("graded-10", "graded-100", "graded-1000"):
            path = benchmark.sets.get(kind, benchmark.sizes[-1])
            runs = [program.start(path, options) for _ in range(benchmark.runs + 1)]  # The first update builds OpenCL programs.
            (wall, processors), found = medians(run[1:] for run in runs[1:]), runs[-1][0]["statistics"]
            out.text(f"{kind:12}{found['fluid_particles']:>8} particles {found['triangles']:>9} triangles {wall:8.3f} s, "
                     f"processors {processors:.3f} s")
        return
    took, triangles = {"uniform": [], "adaptive": []}, {}
    for _ in range(benchmark.runs + 1):
        for mode, times in took.items():
            options = ["--cubes", mode, *benchmark.more]
            once = program.start(benchmark.files[0], options)
            twice = program.start(benchmark.files[0], options, 2)
            triangles[mode] = twice[0]["statistics"]["triangles"]
            times.append((twice[0]["runs"][1]["wall_seconds"], twice[2] - once[2]))
    for mode, times in took.items():
        wall, processors = medians(times[1:])
        out.text(f"{mode:9}{triangles[mode]:>10} triangles {wall:8.3f} s, processors {processors:.3f} s")
    ratio = medians([u[i] / a[i] for i in (0, 1)] for u, a in zip(took["uniform"][1:], took["adaptive"][1:]))
    out.text(f"triangles {triangles['uniform'] / triangles['adaptive']:.1f} times fewer, {ratio[0]:.1f} times faster, "
             f"processors {ratio[1]:.1f}")


SUPPORT = 2  # This is the cubic spline's reach in smoothing lengths.
MASK = (1 << 21) - 1


def split_bricks(positions, lengths, cube):
    """Returns a list with one entry for each level of bricks (4 x 4 x 4 cubes): the keys, one number each, of the level's bricks that are
    replaced by smaller bricks. Level 0 has the smallest bricks, so its entry is empty."""
    sides = np.stack(np.meshgrid(*[(-1, 0, 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    level = np.floor(np.log2(lengths / lengths.min() * (1 + 1e-12))).astype(int)
    split = [np.empty(0, np.int64)]
    for finer in range(level.max()):
        size = 4 * cube * 2 ** (finer + 1)
        parents = np.stack([split[-1] >> 42, split[-1] >> 21 & MASK, split[-1] & MASK], axis=1) - (1 << 20)
        touched = ((parents[:, None] + sides) >> 1).reshape(-1, 3)
        x, support = positions[level == finer], SUPPORT * lengths[level == finer]
        near = np.floor(x / size).astype(np.int64)[:, None] + sides
        away = np.maximum(np.maximum(near * size - x[:, None], x[:, None] - (near + 1) * size), 0)
        reached = near[(away ** 2).sum(axis=2) <= support[:, None] ** 2]
        split.append(np.unique(keys_of(np.concatenate([touched, reached]))))
    return split


def keys_of(bricks):
    shifted = bricks.astype("int64") + (1 << 20)
    return shifted[:, 0] << 42 | shifted[:, 1] << 21 | shifted[:, 2]


def distance(benchmark):
    """Measures how far surfaces on adaptive and on uniform cubes are apart. "there" is the distance from each vertex on
    adaptive cubes to the nearest vertex on uniform cubes, in edges of the smallest cube; usually both vertices are the
    same crossing of a line of the lattice. "back" is the distance from each vertex on uniform cubes to the surface on
    adaptive cubes, in edges of the adaptive cube around the vertex. The levels of cubes are computed here from
    SmoothingLength, as for the cubic spline, an h scale of 1, and only fluid particles."""
    out, surface = benchmark.report, {}
    path = benchmark.files[0] if benchmark.files else benchmark.sets.get("graded-10", benchmark.sizes[-1])
    for mode in ("uniform", "adaptive"):
        report, *_ = benchmark.program.start(path, ["--cubes", mode, *(benchmark.more or ["--free-surface"])])
        surface[mode] = read(benchmark.program.surface)
        out.text(f"{mode:9}{surface[mode].GetNumberOfCells():>10} triangles")
    cube, particles = report["parameters"]["cube_size"], read(path)
    split = split_bricks(points_of(particles), array_of(particles, "SmoothingLength"), cube)
    locator, uniform = vtk.vtkStaticPointLocator(), points_of(surface["uniform"])
    locator.SetDataSet(surface["uniform"])
    locator.BuildLocator()
    off = np.array([np.linalg.norm(uniform[locator.FindClosestPoint(x)] - x) for x in points_of(surface["adaptive"])]) / cube
    out.text(f"there: {np.mean(off <= 0.05):.4%} within 0.05 of the smallest cube; 99.9 % within {np.quantile(off, 0.999):.3g}")
    bare, implicit, result = vtk.vtkPolyData(), vtk.vtkImplicitPolyDataDistance(), vtk.vtkDoubleArray()
    bare.SetPoints(surface["adaptive"].GetPoints())
    bare.SetPolys(surface["adaptive"].GetPolys())
    implicit.SetInput(bare)
    implicit.FunctionValue(numpy_to_vtk(np.ascontiguousarray(uniform), deep=True), result)
    level = np.full(len(uniform), len(split) - 1)
    for at in range(len(split) - 1, 0, -1):
        brick = np.floor(uniform / (4 * cube * 2 ** at)).astype(np.int64)
        level[(level == at) & np.isin(keys_of(brick), split[at])] = at - 1
    off = np.abs(vtk_to_numpy(result)) / (cube * 2.0 ** level)
    out.text(f"back: {np.mean(off <= 0.15):.4%} within 0.15, {np.mean(off <= 0.35):.4%} within 0.35 of the local cube; 99 % "
             f"within {np.quantile(off, 0.99):.3g}, 99.9 % within {np.quantile(off, 0.999):.3g}")


PLANE_LENGTH, PLANE_ISO = 1.3, 0.2  # The spacing is 1.


def plane(benchmark):
    """Times an isoline of particles in a plane: by this program, and by vtkSPHInterpolator with a kernel of two dimensions
    on the same lattice and vtkFlyingEdges2D. Prints processor seconds of all threads, and in brackets seconds by the clock.
    This program's seconds are a fifth of the difference between a process with six surfaces and one with one surface;
    reading is not timed."""
    program, more, own = benchmark.program, 5, []
    path = benchmark.sets.get("plane", benchmark.sizes[-1])
    options = ["--scalar", "Swirl", "--iso", PLANE_ISO, "--smoothing-length", PLANE_LENGTH, "--no-attributes"]
    for _ in range(benchmark.runs):
        once, many = program.start(path, options), program.start(path, options, 1 + more)
        own.append([(many[i] - once[i]) / more for i in (2, 1)])
    theirs = compete("vtk", path, benchmark.sizes[-1], benchmark.runs, benchmark.limit, None, (PLANE_ISO, 2, PLANE_LENGTH))
    lines = many[0]["statistics"]["triangles_before_trimming"]
    if not lines or not theirs.get("triangles"):
        raise SystemExit(f"benchmark.py: no line was found {theirs.get('left_out', '')}")
    processors, clock = medians(own)
    benchmark.report.text(
        f"{'marching-correctors':38} {processors:8.2f} s ({clock:.2f} s), {lines} lines",
        f"{'vtkSPHInterpolator + vtkFlyingEdges2D':38} {theirs['processors']:8.2f} s ({theirs['seconds']:.2f} s), "
        f"{theirs['triangles']} lines", f"ratio {theirs['processors'] / processors:.1f}")


def make_image(bounds, *dimensions):
    """Returns an image over the particles' bounds. A single point along an axis lies in the middle of the bounds."""
    image = vtk.vtkImageData()
    image.SetDimensions(*dimensions)
    pairs = list(zip(bounds[::2], bounds[1::2], dimensions))
    image.SetOrigin(*((low + high) / 2 if n == 1 else low for low, high, n in pairs))
    image.SetSpacing(*((high - low) / max(n - 1, 1) for low, high, n in pairs))
    return image


def make_probe(particles, image, *arrays, keep=True):
    """Returns a vtkSPHProbe that has not run yet. It probes the arrays `arrays`; without names, all arrays of the particles."""
    from marchingcorrectors import vtkSPHProbe
    probe = vtkSPHProbe()
    probe.SetInputData(image)
    probe.SetSourceData(particles)
    probe.SetKeepDeviceData(keep)
    exclude_others(probe, particles, *(arrays or names_of(particles.GetPointData())))
    return probe


def seconds_of_update(filter_):
    """Runs the filter. Returns the seconds that have passed, and the seconds of processors' time."""
    filter_.Modified()
    begin = time.perf_counter(), time.process_time()
    filter_.Update()
    return time.perf_counter() - begin[0], time.process_time() - begin[1]


def tank_or_file(benchmark):
    return read(benchmark.files[0] if benchmark.files else benchmark.sets.get("tank", benchmark.sizes[-1]))


def probe(benchmark):
    """Probes a slice and a volume. On the slice, vtkSPHProbe and vtkSPHInterpolator evaluate Swirl (Shepard mean, cubic
    spline, one smoothing length) at the same points, in one process, in turn; reading the particles is not timed. Only
    vtkSPHProbe evaluates the volume. Memory is the largest resident set."""
    out, particles, runs, array = benchmark.report, tank_or_file(benchmark), benchmark.runs, "Swirl"
    size, side = (64, 32) if benchmark.quick else (512, 256)
    image = make_image(particles.GetBounds(), size, size, 1)
    ours = make_probe(particles, image, array)
    theirs = interpolator(particles, image, particles.GetPointData().GetArray("SmoothingLength").GetRange()[1], 3, array)
    cases = {"vtkSPHProbe, search grid kept": ours, "vtkSPHInterpolator, locator kept": theirs,
             "vtkSPHProbe, search grid made": make_probe(particles, image, array, keep=False),
             "vtkSPHInterpolator, locator made": theirs}
    times = {name: [] for name in cases}
    for run in range(runs + 1):
        for name, filter_ in cases.items():
            if name == "vtkSPHInterpolator, locator made":
                theirs.GetLocator().FreeSearchStructure()
            used = seconds_of_update(filter_)
            if run > 0:  # The first run builds programs and search structures.
                times[name].append(used)
    out.text(f"{particles.GetNumberOfPoints()} particles, array {array}",
             f"slice of {size}^2 points, medians of {runs}: seconds (spread), processor seconds; times as fast as VTK")
    for name, used in times.items():
        clock = [seconds for seconds, _ in used]
        own, beside = medians(used), medians(times["vtkSPHInterpolator, locator " + name.split()[-1]])
        out.text(f"  {name:34}{own[0]:8.3f} ({min(clock):.3f} .. {max(clock):.3f}){own[1]:9.3f};"
                 f"{beside[0] / own[0]:7.1f}{beside[1] / own[1]:7.1f}")
    inside = array_of(ours.GetOutput(), "WeightSum") > 0.9
    a, b = (array_of(f.GetOutputDataObject(0), array)[inside] for f in (ours, theirs))
    out.text(f"  largest difference at the {inside.sum()} points inside: {np.abs(a - b).max() / np.ptp(a):.2e} of the range")
    before, volume = peak_bytes(), make_probe(particles, make_image(particles.GetBounds(), side, side, side), array)
    used, processors = seconds_of_update(volume)
    data = volume.GetOutput().GetPointData()
    size = 1024 * sum(data.GetArray(i).GetActualMemorySize() for i in range(data.GetNumberOfArrays()))
    out.text(f"volume of {side}^3 points: {used:.2f} s, {processors:.2f} processor seconds; resident {before / 2**20:.0f} MiB "
             f"before, at most {peak_bytes() / 2**20:.0f} MiB, of which {size / 2**20:.0f} MiB output")


class Watch:
    """Records the times of a filter's progress reports."""

    def __init__(self, filter_):
        self.filter, self.reports, self.stop_at = filter_, [], None
        filter_.AddObserver("ProgressEvent", self.on_progress)

    def on_progress(self, *_):
        self.reports.append((time.perf_counter(), time.process_time(), self.filter.GetProgressText()))
        if len(self.reports) == self.stop_at:
            self.filter.AbortExecuteOn()

    def run(self, stop_at=None):
        """Returns three values: the seconds of the whole run; the longest gap between reports by the clock, and the longest gap in processor
        seconds, each as (seconds, the phase in which the gap begins); and the seconds from report number stop_at, which cancels the run, to
        the end of the run (0: not cancelled)."""
        self.reports, self.stop_at = [], stop_at
        self.filter.AbortExecuteOff()
        self.filter.Modified()
        begin = time.perf_counter(), time.process_time(), "start"
        self.filter.Update()
        end = time.perf_counter(), time.process_time(), "end"
        times = [begin] + self.reports + [end]
        gap = [max((b[i] - a[i], a[2]) for a, b in zip(times, times[1:])) for i in range(2)]
        after = end[0] - self.reports[stop_at - 1][0] if stop_at and len(self.reports) >= stop_at else 0
        return end[0] - begin[0], gap, after


def cancel(benchmark):
    """Measures how long a run goes on after it is cancelled. A run stops at its next report of progress. All kernels are
    compiled beforehand. Makes several runs of each kind, and measures the longest time without a report in each. Prints the shortest of
    these times, by the clock and in processor seconds of all threads, and the phase in which it began. Then cancels 8 runs, each at another
    report, and prints the longest time for which one of them went on."""
    from marchingcorrectors import vtkMarchingCorrectors
    out, particles, stops = benchmark.report, tank_or_file(benchmark), 8
    size, side = (64, 32) if benchmark.quick else (512, 256)
    scalar, free = vtkMarchingCorrectors(), vtkMarchingCorrectors()
    for filter_ in (scalar, free):
        filter_.SetInputData(particles)
        filter_.KeepDeviceDataOff()
    scalar.SetInputArrayToProcess(0, 0, 0, 0, "Swirl")
    scalar.SetValue(0, 1.2)
    free.FreeSurfaceOn()
    bounds = particles.GetBounds()
    kinds = {"Swirl 1.2": scalar, "free surface": free,
             f"slice of {size}^2": make_probe(particles, make_image(bounds, size, size, 1), keep=False),
             f"volume of {side}^3": make_probe(particles, make_image(bounds, side, side, side), "Swirl", keep=False)}
    out.text(f"{particles.GetNumberOfPoints()} particles")
    for name, filter_ in kinds.items():
        watch = Watch(filter_)
        watch.run()
        timed = [watch.run() for _ in range(benchmark.runs)]
        reports = len(watch.reports)
        clock, processors = (min(run[1][i] for run in timed) for i in range(2))
        after = max(watch.run(1 + k * reports // stops)[2] for k in range(stops))
        out.text(f"{name:28} {min(run[0] for run in timed):6.2f} s, {reports:4} reports; longest without one "
                 f"{clock[0]:.3f} s ({clock[1]}), {processors[0]:.3f} processor s ({processors[1]}); from cancel to return "
                 f"{after:.3f} s")


def project(benchmark):
    """Compares column densities of Evrard's sphere (density 1 / r, h of 1.2 spacings, in a box with edges of 2.6)
    by project() of Python and by sarracen's code for the processor. sarracen's exact mode gives means over pixels, as project() does;
    otherwise sarracen evaluates kernels at the centres of pixels, or of 4 x 4 finer pixels, which are averaged. An error is the
    largest difference from project(), divided by project()'s greatest value; the exact mode's error tells how closely both programs agree.
    Seconds are by the clock and of processors."""
    import marchingcorrectors
    from sarracen.interpolate.cpu_backend import CPUBackend
    from sarracen.kernels import CubicSplineKernel
    column, side, out = CubicSplineKernel().get_column_kernel_func(10000), 1.3, benchmark.report

    def timed(call):
        taken, image = [], call()  # This call compiles.
        for _ in range(benchmark.runs):
            begin = time.perf_counter(), time.process_time()
            image = call()
            taken.append((time.perf_counter() - begin[0], time.process_time() - begin[1]))
        return image, *medians(taken)

    for count, pixels in zip(benchmark.sizes, (128, 512)):
        random = np.random.default_rng(1)
        radius = np.sqrt(random.random(count))
        places = random.normal(size=(count, 3))
        places *= (radius / np.linalg.norm(places, axis=1))[:, None]
        h, mass = 1.2 * (2 * np.pi * radius / count) ** (1 / 3), np.full(count, 1 / count)
        x, y = places[:, 0].copy(), places[:, 1].copy()

        def theirs(fine, exact):
            image = CPUBackend.interpolate_3d_projection(x, y, mass, h, column, 2.0, pixels * fine, pixels * fine, -side, side,
                                                         -side, side, exact)
            return image.reshape(pixels, fine, pixels, fine).mean((1, 3))

        ours, *seconds = timed(lambda: marchingcorrectors.project(
            places, mass=mass, smoothing_length=h, resolution=pixels, box=(-side, side) * 3).values)
        rows = [["marchingcorrectors", "", *(f"{s:.3f}" for s in seconds), ""]]
        for name, fine, exact in (("centres", 1, False), ("centres, 4 x 4", 4, False), ("exact", 1, True)):
            if exact and count > benchmark.sizes[0]:
                continue
            image, *other = timed(lambda: theirs(fine, exact))
            rows.append([f"sarracen, {name}", f"{np.abs(image - ours).max() / ours.max():.1e}", *(f"{s:.3f}" for s in other),
                         f"{other[1] / seconds[1]:.1f}"])
        out.heading(f"{count:,} particles, {pixels} x {pixels} pixels, median h {np.median(h) * pixels / 2 / side:.1f} pixels")
        out.table(["", "error", "seconds", "processors", "times ours"], rows)


class Walls:
    """Finds the tank and the obstacle in it; y is up. The tank is the bounding box of all solids. The obstacle is the bounding box of the
    solids farther than h from the tank's sides, and stands on the tank's floor; there may be none."""

    def __init__(self, solid, h):
        self.low, self.high = solid.min(axis=0), solid.max(axis=0)
        inside = self.tank(solid) > h
        self.box = (solid[inside].min(axis=0), solid[inside].max(axis=0)) if inside.any() else None

    def tank(self, points):
        return np.min([*(points - self.low).T, *(self.high - points).T], axis=0)

    def distance(self, points):
        """Returns each point's distance from the nearest wall of the tank or of the obstacle; below 0 for a point behind the wall."""
        tank = self.tank(points)
        if self.box is None:
            return tank
        low, high = self.box
        low = np.where(np.arange(3) == 1, self.low, low)
        outside = np.maximum(low - points, points - high)
        beside, around = outside.max(axis=1), np.linalg.norm(np.maximum(0, outside), axis=1)
        return np.minimum(tank, np.where(beside > 0, around, beside))


def add_walls(data, path):
    """Writes the particles with a layer of solids around their bounding box. The distance of the layer from the box is
    the least smoothing length; neighbouring solids are at most this length apart. A solid's volume is this length cubed."""
    fluid, h = points_of(data), array_of(data, "SmoothingLength")
    spacing = h.min()
    low, high = fluid.min(axis=0) - spacing, fluid.max(axis=0) + spacing
    counts = np.ceil((high - low) / spacing).astype(int)
    grid = np.meshgrid(*(np.linspace(low[a], high[a], counts[a] + 1) for a in range(3)), indexing="ij")
    solid = np.stack(grid, axis=-1).reshape(-1, 3)
    solid = solid[(solid == low).any(axis=1) | (solid == high).any(axis=1)]
    arrays = {"SmoothingLength": (h, spacing), "Volume": (array_of(data, "Mass") / 1000, spacing ** 3),
              "Speed": (array_of(data, "Speed"), 0), "ParticleType": (np.zeros(len(fluid)), 1)}
    make_particles.write(path, make_particles.poly_data(np.concatenate([fluid, solid]), {
        name: np.concatenate([values, np.full(len(solid), of_solids)]) for name, (values, of_solids) in arrays.items()}))


WALL_CHOICES = {
    "weight": ["--solids", "weight"], "ignore": ["--solids", "ignore"],
    "wall, share 0.5": ["--solids", "wall", "--wall-share", "0.5"],
    "wall, share 0.85": ["--solids", "wall", "--wall-share", "0.85"], "wall, measured": ["--solids", "wall"],
}


def walls(benchmark):
    """Measures where surfaces end at walls, for each choice of --solids: the distance of the surface's border from the
    first layer of wall particles, in smoothing lengths (below 0: behind the layer), and the share of points behind the layer.
    A file without the array ParticleType gets a layer of solids, see add_walls()."""
    out, near = benchmark.report, 1.5  # Border points nearer to a wall than this, in smoothing lengths, count.
    edges = vtk.vtkFeatureEdges()  # These edges have only one triangle.
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.ManifoldEdgesOff()
    for path in benchmark.files or [DATA / "double_dam_break_small.vtp"]:
        data, given = read(path), path
        if not data.GetPointData().HasArray("ParticleType"):
            path = benchmark.folder / pathlib.Path(path).name
            add_walls(data, path)
            data = read(path)
        out.text(f"{given}{', with walls' if path != given else ''}")
        solid = array_of(data, "ParticleType") != 0
        h = np.median(array_of(data, "SmoothingLength")[~solid])
        at = Walls(points_of(data)[solid], h)
        pressure = data.GetPointData().HasArray("Pressure")
        for what in (["--scalar", "Pressure", "--iso", "1000"] if pressure else ["--scalar", "Speed", "--iso", "1.5"],
                     ["--free-surface"]):
            out.text("  " + " ".join(what))
            for name, choice in WALL_CHOICES.items():
                if "measured" in name and "--free-surface" in what:
                    continue  # The free surface has the share 0.5.
                benchmark.program.start(path, [*what, "--fluid", "ParticleType=0", *choice], 0)
                surface = read(benchmark.program.surface)
                edges.SetInputData(surface)
                edges.Update()
                border = edges.GetOutput()
                ends = at.distance(points_of(border)) / h if border.GetNumberOfPoints() else np.zeros(0)
                ends = ends[ends < near]
                behind = 100 * (at.distance(points_of(surface)) < -0.01 * h).mean()
                words = "%+.2f (%+.2f to %+.2f)" % tuple(np.percentile(ends, [50, 5, 95])) if len(ends) else \
                    "no border there"
                out.text(f"    {name:18} border at {words:28} {behind:5.1f} % of the points behind")


MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
       "OMPI_MCA_mpi_yield_when_idle": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}


class Model:
    """Divides a box of particles, always halving the longest side, until each rank has its own box. The unit of length is the distance
    between particles. A rank gets copies of other ranks' particles, which lie in shells around its box, on the sides that the box
    shares with other boxes."""

    def __init__(self, count, shape, ranks):
        scale = (count / (shape[0] * shape[1] * shape[2])) ** (1 / 3)
        self.whole = [scale * side for side in shape]
        self.sides, self.parts, self.ranks, self.each = list(self.whole), [1, 1, 1], ranks, count / ranks
        while self.parts[0] * self.parts[1] * self.parts[2] < ranks:
            longest = max(range(3), key=lambda a: self.sides[a])
            self.sides[longest] /= 2
            self.parts[longest] *= 2

    def copies(self, depth, most=False):
        """Returns how many copies of other ranks' particles a rank gets: the mean or, with `most`, the largest number. depth: the shells'
        thickness. If the box is cut into p parts along an axis, a part has a neighbour on either side with probability 1 - 1/p."""
        grown = 1
        for side, parts in zip(self.sides, self.parts):
            grown *= side + depth * (min(parts - 1, 2) if most else 2 * (1 - 1 / parts))
        return grown - self.each

    def surface(self):
        """Returns a rank's part of the whole box's surface area."""
        x, y, z = self.whole
        return 2 * (x * y + y * z + z * x) / self.ranks


def ranks(benchmark):
    """Prints what sharing a surface among processes costs: the particles that a rank owns, copies of other ranks' particles,
    bytes sent, nodes evaluated. Fits a model to these figures, and prints what the model says of larger data. Bytes are sent
    for the copies, and for the particles that go to their owners: 1 - 1 / ranks of all particles."""
    out, runs, options = benchmark.report, [], benchmark.more or ["--free-surface"]
    for count in benchmark.sizes:
        path = benchmark.sets.get("tank", count)
        bounds = read(path).GetBounds()
        shape = [bounds[2 * a + 1] - bounds[2 * a] for a in range(3)]
        for number in (2,) if benchmark.quick else (2, 4, 8):
            found = benchmark.program.start(
                path, options, 1, MPI, benchmark.folder / "o.pvtp", ["mpirun", "-n", str(number)])[0]["statistics"]
            runs.append((Model(sum(found["rank_particles"]), shape, number), found))
    low, depth = 0.0, 100.0
    measured = sum(sum(found["rank_copies"]) for _, found in runs)
    for _ in range(60):  # With this depth, the copies of all runs are as many as were measured.
        middle = (low + depth) / 2
        fewer = sum(model.copies(middle) * model.ranks for model, _ in runs) < measured
        low, depth = (middle, depth) if fewer else (low, middle)

    def excess(values):
        return f"{max(values) * len(values) / max(sum(values), 1):.2f}"

    rows = []
    for model, found in runs:
        copies = found["rank_copies"]
        rows.append([sum(found["rank_particles"]), model.ranks, f"{sum(copies) / model.ranks:.0f}", max(copies),
                     f"{model.copies(depth):.0f}", f"{sum(found['rank_bytes_sent']) / 1e6:.1f}",
                     excess(found["rank_nodes_evaluated"])])
    out.table(["particles", "ranks", "copies per rank", "most", "model", "MB sent, all", "nodes, busiest / mean"], rows)
    # The first rank reads the file. It sends all particles that other ranks own; all copies are sent, too.
    sent = sum(sum(found["rank_bytes_sent"]) for _, found in runs) / sum(
        sum(found["rank_particles"]) * (1 - 1 / model.ranks) + sum(found["rank_copies"]) for model, found in runs)
    nodes = (sum(sum(found["rank_nodes_evaluated"]) for _, found in runs) /
             sum(model.surface() * model.ranks for model, _ in runs))
    out.text(f"shells {depth:.2f} distances deep, {sent:.0f} bytes for each particle that travels, {nodes:.1f} nodes on each "
             "square distance of surface", "")
    rows = []
    for total in (10**7, 10**9):
        for number in (1, 8, 64, 512, 1024):
            model = Model(total, shape, number)
            copies, most = ((model.copies(depth, of_most) if number > 1 else 0) for of_most in (False, True))
            moved = model.each * (1 - 1 / number) + copies  # Particles begin on any rank.
            rows.append([text_of(total), number, f"{model.each:.3g}", f"{copies:.3g}", f"{most:.3g}",
                         f"{copies / model.each:.2f}", f"{moved * sent / 1e6:.3g}",
                         f"{model.surface() * nodes:.3g}"])
    out.table(["particles", "ranks", "per rank", "copies per rank", "most", "copies / particles", "MB sent per rank",
               "nodes per rank"], rows)

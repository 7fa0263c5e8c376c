# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Holds what all cases of the benchmark share: particle sets, runs of the program and of its competitors, tables."""
import functools
import hashlib
import importlib.util
import json
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import time

import vtk
from vtk.util.numpy_support import vtk_to_numpy

DATA = pathlib.Path(__file__).resolve().parent.parent / "Data"
sys.path.insert(0, str(DATA))
import make_particles  # noqa: E402
PHASES = ("input", "search_grid", "seeds", "extraction", "correction", "trimming", "output")
CUBE_FACTOR = 0.5
THRESHOLD = 0.5  # The free surface is where the weight sum has this value.
ENOUGH_SECONDS = 120.0  # After this many seconds a competitor is not run again.

# {set: (its name in make_particles.py, make_particles.py's other arguments, options that tell the program about the particles)}
SETS = {
    # Particles have 70 neighbours and constant h, for comparisons with other software.
    "tank": ("tank", (), ()),
    # This set stands for the paper's tsunami: particles have 200 neighbours and constant h.
    "dense-tank": ("tank", ("--ratio", "1.814"), ("--kernel", "quadratic")),
    # This set stands for the paper's dam break: particles have 70 neighbours and variable h.
    "dam-break": ("dam_break", (), ()),
    # A full lattice stands for the paper's vortex rings. It has no free surface. Nothing is trimmed, because a shortened kernel gives low
    # weights between the particles of a lattice.
    "vortex-rings": ("vortex_rings", ("--keep-all",),
                     ("--kernel", "mprime4", "--node-threshold", 0, "--vertex-threshold", 0)),
    "plane": ("plane", (), ()),
    # Smoothing lengths vary by 1:10, 1:100 or 1:1000.
    **{f"graded-{ratio}": ("graded", ("--ratio", str(ratio)), ()) for ratio in (10, 100, 1000)},
}


def count_of(text):
    """Turns the text 670k into 670000, and 3M into 3000000."""
    factor = {"k": 1000, "m": 1000000}.get(text[-1:].lower(), 1)
    return round(float(text[:-1] if factor > 1 else text) * factor)


def text_of(count):
    """Turns 670000 into the text 670k, and 3000000 into 3M."""
    for unit, letter in ((1000000, "M"), (1000, "k")):
        if count >= unit:
            return f"{count / unit:g}{letter}"
    return str(count)


class Sets:
    """Keeps particle sets in a folder. A set that was made in the same way before is not made again."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.path.mkdir(parents=True, exist_ok=True)

    def get(self, kind, count):
        name, arguments, _ = SETS[kind]
        script = DATA / "make_particles.py"
        version = hashlib.sha1(script.read_bytes() + repr((name, count, *arguments)).encode()).hexdigest()[:8]
        path = self.path / f"{kind}-{text_of(count)}-{version}.vtp"
        if not path.exists():
            print(f"making {path.name}", file=sys.stderr)
            part = path.with_suffix(".part.vtp")
            subprocess.run([sys.executable, script, name, str(count), part, *arguments], check=True, stdout=subprocess.DEVNULL)
            part.rename(path)
        return path

    def get_with_one_array(self, kind, count, array):
        """Writes a set's particles with the array `array` alone. Returns the file's path, and options that give the smoothing length,
        the mass and the density in place of arrays. Raises ValueError if one of these three differs from particle to particle."""
        whole = self.get(kind, count)
        path = whole.with_name(f"{whole.stem}-{array}.vtp")
        particles = read(whole)
        data = particles.GetPointData()
        options = []
        for name, option in (("SmoothingLength", "--smoothing-length"), ("Mass", "--mass"), ("Density", "--density")):
            low, high = data.GetArray(name).GetRange()
            if low != high:
                raise ValueError(f"{kind}: {name} differs from particle to particle")
            options += [option, repr(high)]
        if not path.exists():
            for name in names_of(data):
                if name != array:
                    data.RemoveArray(name)
            make_particles.write(path, particles)
        return path, options


def read(path):
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def names_of(data):
    return [data.GetArrayName(i) for i in range(data.GetNumberOfArrays())]


def points_of(data):
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def array_of(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name)).astype(float)


def processor_seconds():
    """Returns the processor seconds of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def peak_bytes():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


class Program:
    """Runs marching-correctors. Results are kept, so that tables may share a run."""

    def __init__(self, path, device, runs, folder):
        self.path, self.device, self.runs = pathlib.Path(path).resolve(), device, runs
        self.folder, self.surface = folder, folder / "surface.vtp"  # The last run's.
        self.run = functools.lru_cache(None)(self.measure)

    def measure(self, path, options):
        """Returns medians of the timed runs. One process extracts the surface `runs` + 1 times, each time from scratch except for the
        OpenCL program. The first extraction loads the OpenCL program; its time is given as "first". An earlier process compiles
        this program, so that the compiler's memory is not counted."""
        print(f"marching-correctors {path.name} {' '.join(map(str, options))}", file=sys.stderr)
        self.start(path, options)
        found = self.start(path, options, self.runs + 1)[0]
        first, *rest = found["runs"]
        seconds = [run["wall_seconds"] for run in rest]
        return {
            "name": found["program"], "vtk": found["vtk"], "device": found["device"], "platform": found["platform"],
            "parameters": found["parameters"], "seconds": statistics.median(seconds), "all": seconds,
            "first": first["wall_seconds"],
            "phases": {name: statistics.median(run["seconds"][name] for run in rest)
                       for name in (*PHASES, "program_build")},
            "statistics": found["statistics"], "triangles": found["statistics"]["triangles"],
            "bytes": found["peak_resident_bytes"]}

    def start(self, path, options, repeat=1, environment=None, output=None, before=()):
        """Runs one process, and ends the benchmark if the process fails. Returns the process's report (None if repeat is 0), its seconds by
        the clock, and its processor seconds. before: words in front of the command."""
        report = self.folder / "statistics.json"
        report.unlink(missing_ok=True)
        statistics_of = ["--repeat", str(repeat), "--stats", report] if repeat else []
        command = [*before, self.path, path, output or self.surface, *map(str, options),
                   *(["--device", self.device] if self.device else []), "--quiet", *statistics_of]
        begin, processors = time.perf_counter(), processor_seconds()
        process = subprocess.run(command, stderr=subprocess.PIPE, text=True,
                                 env={**os.environ, **(environment or {})}, check=False)
        seconds = time.perf_counter() - begin, processor_seconds() - processors
        if process.returncode != 0:
            sys.exit(f"benchmark.py: {path.name} {' '.join(map(str, options))}: {process.stderr}")
        return (json.loads(report.read_text()) if repeat else None, *seconds)


def need_surface(result, what):
    """Returns the result, and ends the benchmark if there is no surface."""
    if result["triangles"] == 0:
        sys.exit(f"benchmark.py: {what}: no surface")
    return result


def lattice(particles, cube, dimension):
    """Returns an image around the particles. The coordinates of its points are multiples of the cube size; in two dimensions, z is 0."""
    low = [int(b // cube) - 2 for b in particles.GetBounds()[:2 * dimension:2]]
    high = [int(b // cube) + 3 for b in particles.GetBounds()[1:2 * dimension:2]]
    image = vtk.vtkImageData()
    image.SetOrigin(*[cube * i for i in low] + [0] * (3 - dimension))
    image.SetSpacing(cube, cube, cube)
    image.SetDimensions(*[b - a + 1 for a, b in zip(low, high)] + [1] * (3 - dimension))
    return image


def exclude_others(filter_, particles, *kept):
    for name in names_of(particles.GetPointData()):
        if name not in kept:
            filter_.AddExcludedArray(name)


def interpolator(particles, image, h, dimension, *kept):
    """Returns a vtkSPHInterpolator that has not run yet. It interpolates the arrays `kept`."""
    kernel = vtk.vtkSPHCubicKernel()
    kernel.SetSpatialStep(h)
    kernel.SetDimension(dimension)
    made = vtk.vtkSPHInterpolator()
    made.SetInputData(image)
    made.SetSourceData(particles)
    made.SetLocator(vtk.vtkStaticPointLocator())
    made.SetKernel(kernel)
    made.SetMassArrayName("Mass")
    made.SetDensityArrayName("Density")
    made.SetShepardNormalization(True)
    exclude_others(made, particles, *kept)
    return made


def run_vtk(path, iso="0", dimension="3", length=None):
    """Contours Swirl by VTK: vtkSPHInterpolator on an image around the particles, then vtkFlyingEdges. length: h; None: the largest h."""
    particles, dimension = read(path), int(dimension)
    h = float(length) if length else particles.GetPointData().GetArray("SmoothingLength").GetRange()[1]
    image = lattice(particles, CUBE_FACTOR * h, dimension)
    begin, processors = time.perf_counter(), time.process_time()
    field = interpolator(particles, image, h, dimension, "Swirl", "Mass", "Density")
    contour = vtk.vtkFlyingEdges3D() if dimension == 3 else vtk.vtkFlyingEdges2D()
    contour.SetInputConnection(field.GetOutputPort())
    contour.SetInputArrayToProcess(0, 0, 0, 0, "Swirl")
    contour.SetValue(0, float(iso))
    contour.Update()
    return {"seconds": time.perf_counter() - begin, "processors": time.process_time() - processors,
            "triangles": contour.GetOutput().GetNumberOfCells(), "bytes": peak_bytes(),
            "name": "VTK " + vtk.vtkVersion.GetVTKVersion()}


def run_splashsurf(path):
    """Makes the free surface by splashsurf, with normals and the attribute Swirl."""
    from importlib.metadata import version

    import pysplashsurf
    particles = read(path)
    points, swirl = points_of(particles).astype("float32"), array_of(particles, "Swirl").astype("float32")
    h, mass, density = (particles.GetPointData().GetArray(name).GetRange()[1]
                        for name in ("SmoothingLength", "Mass", "Density"))
    radius = (mass / density) ** (1 / 3) / 2
    begin = time.perf_counter()
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        points, attributes_to_interpolate={"Swirl": swirl}, particle_radius=radius,
        smoothing_length=h / radius, cube_size=CUBE_FACTOR * h / radius,
        iso_surface_threshold=THRESHOLD, compute_normals=True, sph_normals=True)
    return {"seconds": time.perf_counter() - begin, "triangles": len(mesh.mesh.triangles), "bytes": peak_bytes(),
            "name": "splashsurf " + version("pysplashsurf")}


def has_splashsurf():
    return importlib.util.find_spec("pysplashsurf") is not None


def smoothed_by_splashsurf(points, spacing, cube=0.5):
    """Returns splashsurf's mesh, with normals, by its recommended settings. cube: the cubes' edge in particle radii."""
    import pysplashsurf
    return pysplashsurf.reconstruction_pipeline(
        points.astype("float32"), particle_radius=spacing / 2, smoothing_length=2.0, cube_size=cube, iso_surface_threshold=0.6,
        mesh_smoothing_weights=True, mesh_smoothing_weights_normalization=13.0, mesh_smoothing_iters=25,
        normals_smoothing_iters=10, mesh_cleanup=True, compute_normals=True)[0]


def run_smooth_splashsurf(path):
    particles = read(path)
    spacing = statistics.median(array_of(particles, "Mass") / array_of(particles, "Density")) ** (1 / 3)
    begin = time.perf_counter()
    made = smoothed_by_splashsurf(points_of(particles), spacing)
    return {"name": "splashsurf", "seconds": time.perf_counter() - begin, "triangles": len(made.mesh.triangles),
            "bytes": peak_bytes()}


COMPETITORS = {"vtk": run_vtk, "splashsurf": run_splashsurf, "splashsurf, smooth": run_smooth_splashsurf}


def available_bytes():
    """Returns the memory that Linux could give without swapping: free memory, and caches of files."""
    for line in pathlib.Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    raise OSError("/proc/meminfo does not say MemAvailable")


def compete(name, path, count, runs, limit, smaller=None, arguments=()):
    """Returns medians of a competitor's runs, each in its own process; if there are none, "left_out" says why. Reading particles is not timed.
    smaller: the competitor's result for fewer particles, or None; from it, time and memory are estimated. No run is made if it would take
    longer than `limit` seconds, or more memory than there is."""
    if smaller:
        factor = count / smaller["particles"]
        seconds, size = factor * smaller["seconds"], factor * smaller["bytes"]
        why = f"longer than {limit:.0f} s" if seconds > limit else \
            "more memory than there is" if size > 0.9 * available_bytes() else ""
        if why:
            return {"left_out": f"would take {why} (estimated from the size before)", "estimated_seconds": seconds,
                    "estimated_bytes": size}
    results = []
    while len(results) < runs and sum(r["seconds"] for r in results) < ENOUGH_SECONDS:
        print(f"{name} {path.name}", file=sys.stderr)
        try:
            process = subprocess.run([sys.executable, __file__, name, path, *map(str, arguments)], capture_output=True,
                                     text=True, timeout=limit, check=False)
        except subprocess.TimeoutExpired:
            return {"left_out": f"took longer than {limit:.0f} s"}
        if process.returncode != 0:
            reason = (process.stderr.strip().splitlines() or [f"exit {process.returncode}"])[-1]
            return {"left_out": f"failed: {reason}"}
        results.append(json.loads(process.stdout.splitlines()[-1]))
    seconds = [r["seconds"] for r in results]
    return {"name": results[0]["name"], "seconds": statistics.median(seconds), "all": seconds,
            "processors": statistics.median(r.get("processors", 0.0) for r in results),
            "triangles": results[0]["triangles"], "bytes": max(r["bytes"] for r in results), "particles": count}


class Report:
    """Collects text, and prints each line at once, because a whole benchmark takes long. Tables are Markdown."""

    def __init__(self):
        self.lines = []

    def text(self, *lines):
        for line in lines or ("",):
            self.lines.append(line)
            print(line, flush=True)

    def heading(self, line, *words, mark="##"):
        self.text(*([""] if self.lines[-1:] != [""] else []), f"{mark} {line}", "", *words, *([""] if words else []))

    def table(self, header, rows):
        """Adds a table. Its first column is aligned to the left, all others to the right."""
        for cells in (header, ["---", *["---:"] * (len(header) - 1)], *rows):
            self.text("| " + " | ".join(map(str, cells)) + " |")
        self.text()


def mebibytes(size):
    return f"{size / 2 ** 20:,.0f} MiB"


def seconds_of(value):
    """Returns seconds as text, with at least three significant digits from 0.1 s on."""
    return f"{value:.1f}" if value >= 100 else f"{value:.2f}" if value >= 10 else f"{value:.3f}"


def ratio(value):
    size = abs(value)
    return f"{value:.0f}" if size >= 100 else f"{value:.1f}" if size >= 10 else \
        f"{value:.2f}" if size >= 0.1 else f"{value:.2g}"


def machine():
    """Returns processor, cores, memory and system, as Linux names them."""
    models = [line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines()
              if line.startswith("model name")]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2 ** 30
    return (f"{models[0] if models else platform.processor()}, {len(os.sched_getaffinity(0))} cores, {memory:.0f} GiB, "
            f"{platform.freedesktop_os_release()['PRETTY_NAME']}")


if __name__ == "__main__":
    print(json.dumps(COMPETITORS[sys.argv[1]](*sys.argv[2:])))

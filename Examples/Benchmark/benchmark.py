#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Times marching-correctors against what one would use otherwise, on one set of particles.

  benchmark.py PROGRAM [--particles 670000] [--runs 5] [--json FILE]

PROGRAM is marching-correctors. The Python that runs this script needs numpy and vtk (Debian:
python3-numpy python3-vtk9); splashsurf is measured too where pysplashsurf can be imported.

The particles are the wavy tank of Data/make_tank.py: 70 neighbours each, constant smoothing length,
a smooth scalar. All use the cubic spline, the same smoothing length and the same cube size, half the
smoothing length.

  isosurface     Swirl = 0. marching-correctors: complete seeds, corrected vertices, normals, all other
                 arrays interpolated, trimmed. VTK: vtkSPHInterpolator (this scalar alone) to an image
                 of the particles' bounds, then vtkFlyingEdges3D: uncorrected vertices.
  free surface   weight sum 0.5. marching-correctors as above. splashsurf: threshold 0.5, one
                 interpolated attribute, SPH normals, uncorrected vertices.

Every measurement is a process of its own. Reading the particles and writing the surface are not timed.
marching-correctors is started once for all its runs, each from scratch; the time of its first run,
which also loads (or, at the first start ever, compiles) the OpenCL program, is given apart. Memory is
the largest resident set of the process, with the particles.
"""
import argparse
import json
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
CUBE_FACTOR = 0.5
THRESHOLD = 0.5  # of the weight sum, at the free surface


def read_particles(path):
    import vtk
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def peak_bytes():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def leg_vtk(path):
    """vtkSPHInterpolator + vtkFlyingEdges3D, as one process."""
    import vtk
    particles = read_particles(path)
    h = particles.GetPointData().GetArray("SmoothingLength").GetRange()[1]
    cube = CUBE_FACTOR * h
    low = [int(b // cube) - 2 for b in particles.GetBounds()[::2]]
    high = [int(b // cube) + 3 for b in particles.GetBounds()[1::2]]
    image = vtk.vtkImageData()
    image.SetOrigin(*(cube * i for i in low))
    image.SetSpacing(cube, cube, cube)
    image.SetDimensions(*(b - a + 1 for a, b in zip(low, high)))

    begin = time.perf_counter()
    kernel = vtk.vtkSPHCubicKernel()
    kernel.SetSpatialStep(h)
    kernel.SetDimension(3)
    interpolator = vtk.vtkSPHInterpolator()
    interpolator.SetInputData(image)
    interpolator.SetSourceData(particles)
    interpolator.SetLocator(vtk.vtkStaticPointLocator())
    interpolator.SetKernel(kernel)
    interpolator.SetMassArrayName("Mass")
    interpolator.SetDensityArrayName("Density")
    interpolator.SetShepardNormalization(True)
    for i in range(particles.GetPointData().GetNumberOfArrays()):
        name = particles.GetPointData().GetArrayName(i)
        if name not in ("Swirl", "Mass", "Density"):
            interpolator.AddExcludedArray(name)
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputConnection(interpolator.GetOutputPort())
    contour.SetInputArrayToProcess(0, 0, 0, 0, "Swirl")
    contour.SetValue(0, 0.0)
    contour.Update()
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "triangles": contour.GetOutput().GetNumberOfCells(),
            "bytes": peak_bytes(), "version": vtk.vtkVersion.GetVTKVersion()}


def leg_splashsurf(path):
    """splashsurf's free surface, as one process."""
    from importlib.metadata import version

    import numpy
    import pysplashsurf
    from vtk.util.numpy_support import vtk_to_numpy
    particles = read_particles(path)
    points = numpy.array(vtk_to_numpy(particles.GetPoints().GetData()), dtype=numpy.float32)
    data = particles.GetPointData()
    swirl = numpy.array(vtk_to_numpy(data.GetArray("Swirl")), dtype=numpy.float32)
    h = data.GetArray("SmoothingLength").GetRange()[1]
    volume = data.GetArray("Mass").GetRange()[1] / data.GetArray("Density").GetRange()[1]
    radius = volume ** (1 / 3) / 2

    begin = time.perf_counter()
    mesh, _ = pysplashsurf.reconstruction_pipeline(
        points, attributes_to_interpolate={"Swirl": swirl}, particle_radius=radius,
        smoothing_length=h / radius, cube_size=CUBE_FACTOR * h / radius,
        iso_surface_threshold=THRESHOLD, compute_normals=True, sph_normals=True)
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "triangles": len(mesh.mesh.triangles), "bytes": peak_bytes(),
            "version": version("pysplashsurf")}


LEGS = {"vtk": leg_vtk, "splashsurf": leg_splashsurf}


def run_leg(name, path, runs):
    """Runs a leg several times, each in a process of its own. None if it cannot run here."""
    results = []
    for _ in range(runs):
        process = subprocess.run([sys.executable, __file__, "--leg", name, path],
                                 capture_output=True, text=True)
        if process.returncode != 0:
            reason = (process.stderr.strip().splitlines() or ["no reason given"])[-1]
            print(f"{name}: not measured: {reason}", file=sys.stderr)
            return None
        results.append(json.loads(process.stdout.splitlines()[-1]))
    seconds = [r["seconds"] for r in results]
    return {"name": name + " " + results[0]["version"], "seconds": statistics.median(seconds),
            "all": seconds, "triangles": results[0]["triangles"],
            "bytes": max(r["bytes"] for r in results)}


def run_program(program, path, options, runs, folder):
    """Our program, all runs in one process, as --repeat does it."""
    report = folder / "statistics.json"
    subprocess.run([program, path, folder / "surface.vtp", *options, "--quiet", "--repeat",
                    str(runs + 1), "--stats", report], check=True)
    found = json.loads(report.read_text())
    first, *rest = (run["wall_seconds"] for run in found["runs"])
    phases = {name: statistics.median(run["seconds"][name] for run in found["runs"][1:])
              for name in found["seconds"]}
    return {"name": found["program"], "seconds": statistics.median(rest), "all": rest,
            "first": first, "triangles": found["statistics"]["triangles"],
            "bytes": found["peak_resident_bytes"], "phases": phases, "device": found["device"],
            "platform": found["platform"], "vtk": found["vtk"],
            "particles": found["statistics"]["fluid_particles"],
            "cube_size": found["parameters"]["cube_size"]}


def machine():
    """Processor, cores and memory, as Linux tells them."""
    model = platform.processor()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2 ** 30
    system = platform.freedesktop_os_release()["PRETTY_NAME"]
    return f"{model}, {len(os.sched_getaffinity(0))} cores, {memory:.0f} GiB, {system}"


def print_table(title, ours, theirs):
    print(f"\n{title}\n")
    print("| | seconds (median) | fastest .. slowest | triangles | peak memory | ratio of times |")
    print("|---|---|---|---|---|---|")
    for row in filter(None, (ours, theirs)):
        print(f"| {row['name']} | {row['seconds']:.3f} | {min(row['all']):.3f} .. "
              f"{max(row['all']):.3f} | {row['triangles']:,} | {row['bytes'] / 2 ** 20:.0f} MiB | "
              f"{row['seconds'] / ours['seconds']:.1f} |")
    phases = ", ".join(f"{name.replace('_', ' ')} {seconds:.3f}"
                       for name, seconds in ours["phases"].items())
    print(f"\nFirst run of the process: {ours['first']:.3f} s. Phases (s): {phases}.")


def measure(arguments, folder):
    tank = folder / "tank.vtp"
    subprocess.run([sys.executable, HERE.parent / "Data" / "make_tank.py",
                    str(arguments.particles), tank], check=True, stdout=subprocess.DEVNULL)
    device = ["--device", arguments.device] if arguments.device else []
    scalar = run_program(arguments.program, tank, ["--scalar", "Swirl", "--iso", "0", *device],
                         arguments.runs, folder)
    vtk = run_leg("vtk", tank, arguments.runs)
    free = run_program(arguments.program, tank,
                       ["--free-surface", "--iso", str(THRESHOLD), *device], arguments.runs, folder)
    splashsurf = run_leg("splashsurf", tank, arguments.runs)
    return {"machine": machine(), "scalar": scalar, "vtk": vtk, "free": free,
            "splashsurf": splashsurf}


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="the program marching-correctors")
    parser.add_argument("--particles", type=int, default=670000)
    parser.add_argument("--runs", type=int, default=5, help="timed runs of each")
    parser.add_argument("--device", help="OpenCL device, see marching-correctors --list-devices")
    parser.add_argument("--json", type=pathlib.Path, help="write all results to this file")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="mcor-benchmark-") as folder:
        results = measure(arguments, pathlib.Path(folder))
    ours = results["scalar"]
    print(f"Machine: {results['machine']}")
    print(f"Device: {ours['device']} ({ours['platform']}); marching-correctors on VTK {ours['vtk']}; "
          f"Python {platform.python_version()}")
    print(f"Particles: {ours['particles']:,}; cube size {ours['cube_size']:.6g}; "
          f"{arguments.runs} runs each")
    print_table("Isosurface of a scalar", ours, results["vtk"])
    print_table("Free surface", results["free"], results["splashsurf"])
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--leg"]:
        print(json.dumps(LEGS[sys.argv[2]](sys.argv[3])))
    else:
        main()

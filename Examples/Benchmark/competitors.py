# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""What one would use otherwise. Each run is a process of its own: competitors.py NAME FILE.vtp.

  vtk          vtkSPHInterpolator of one scalar to an image of the particles' bounds, then
               vtkFlyingEdges3D
  splashsurf   free surface with one attribute and normals

Reading the particles is not timed. Memory is the largest resident set, with the particles and
Python.
"""
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import time

import sets

CUBE_FACTOR = 0.5
THRESHOLD = 0.5  # of the weight sum, at the free surface
HOW = "(estimated from the size before)"
ENOUGH_SECONDS = 120.0  # no further repetition once a competitor has had this much


def peak_bytes():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def lattice(particles, cube, dimension):
    """An image of nodes at whole multiples of the cube size, around the particles; in two dimensions in the plane z = 0."""
    import vtk
    low = [int(b // cube) - 2 for b in particles.GetBounds()[:2 * dimension:2]]
    high = [int(b // cube) + 3 for b in particles.GetBounds()[1:2 * dimension:2]]
    image = vtk.vtkImageData()
    image.SetOrigin(*[cube * i for i in low] + [0] * (3 - dimension))
    image.SetSpacing(cube, cube, cube)
    image.SetDimensions(*[b - a + 1 for a, b in zip(low, high)] + [1] * (3 - dimension))
    return image


def interpolator(particles, image, h, dimension):
    """Not run yet."""
    import vtk
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
    return made


def run_vtk(path):
    import vtk
    particles = sets.read(path)
    h = particles.GetPointData().GetArray("SmoothingLength").GetRange()[1]
    image = lattice(particles, CUBE_FACTOR * h, 3)

    begin = time.perf_counter()
    field = interpolator(particles, image, h, 3)
    for i in range(particles.GetPointData().GetNumberOfArrays()):
        name = particles.GetPointData().GetArrayName(i)
        if name not in ("Swirl", "Mass", "Density"):
            field.AddExcludedArray(name)
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputConnection(field.GetOutputPort())
    contour.SetInputArrayToProcess(0, 0, 0, 0, "Swirl")
    contour.SetValue(0, 0.0)
    contour.Update()
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "triangles": contour.GetOutput().GetNumberOfCells(),
            "bytes": peak_bytes(),
            "name": "VTK " + vtk.vtkVersion.GetVTKVersion()}


def run_splashsurf(path):
    from importlib.metadata import version

    import numpy
    import pysplashsurf
    from vtk.util.numpy_support import vtk_to_numpy
    particles = sets.read(path)
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
            "name": "splashsurf " + version("pysplashsurf")}


RUNS = {"vtk": run_vtk, "splashsurf": run_splashsurf}


def available_bytes():
    """Memory that Linux could give without swapping: free, or used by caches of files alone."""
    for line in pathlib.Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    raise OSError("/proc/meminfo does not say MemAvailable")


def expect(count, smaller):
    """Time and memory at `count` particles, both as in proportion to a smaller set's."""
    factor = count / smaller["particles"]
    return factor * smaller["seconds"], factor * smaller["bytes"]


def measure(name, path, count, runs, limit, smaller):
    """Medians of a competitor's runs, or why there are none. `smaller` is what it took for fewer
    particles, None if unknown; a set that would take longer than `limit` seconds, or more memory
    than there is, is left out."""
    if smaller:
        seconds, size = expect(count, smaller)
        estimate = {"estimated_seconds": seconds, "estimated_bytes": size}
        if seconds > limit:
            return {"left_out": f"would take longer than {limit:.0f} s {HOW}", **estimate}
        if size > 0.9 * available_bytes():
            return {"left_out": f"would take more memory than there is {HOW}", **estimate}
    results = []
    while len(results) < runs and sum(r["seconds"] for r in results) < ENOUGH_SECONDS:
        print(f"{name} {path.name}", file=sys.stderr)
        try:
            process = subprocess.run([sys.executable, __file__, name, path], capture_output=True,
                                     text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"left_out": f"took longer than {limit:.0f} s"}
        if process.returncode != 0:
            reason = (process.stderr.strip().splitlines() or [f"exit {process.returncode}"])[-1]
            return {"left_out": f"failed: {reason}"}
        results.append(json.loads(process.stdout.splitlines()[-1]))
    seconds = [r["seconds"] for r in results]
    return {"name": results[0]["name"], "seconds": statistics.median(seconds), "all": seconds,
            "triangles": results[0]["triangles"], "bytes": max(r["bytes"] for r in results),
            "particles": count}


if __name__ == "__main__":
    print(json.dumps(RUNS[sys.argv[1]](sys.argv[2])))

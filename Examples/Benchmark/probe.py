#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A slice and a volume of SPH particles: vtkSPHProbe beside vtkSPHInterpolator.

  probe.py PARTICLES.vtp [--array NAME] [--slice N] [--volume N] [--runs N]

Both evaluate the same array (Shepard mean, cubic spline, one smoothing length) at the same points, in
one process, in turn; seconds of Update() and processor seconds of all threads, medians. Reading the particles is not timed. The volume is
vtkSPHProbe's alone; memory is the largest resident set. The particles need Mass, Density and one
SmoothingLength: Examples/Data/make_tank.py makes them.
"""
import argparse
import resource
import statistics
import time

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkStaticPointLocator
from vtkmodules.vtkFiltersPoints import vtkSPHCubicKernel, vtkSPHInterpolator
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from marchingcorrectors import vtkSPHProbe


def peak_bytes():
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def make_image(bounds, dimensions):
    """An image over the particles' bounds; its last axis in the middle where it is one point thick."""
    image = vtkImageData()
    image.SetDimensions(*dimensions)
    low, high = numpy.array(bounds[::2]), numpy.array(bounds[1::2])
    steps = numpy.maximum(numpy.array(dimensions) - 1, 1)
    flat = numpy.array(dimensions) == 1
    image.SetOrigin(*numpy.where(flat, (low + high) / 2, low))
    image.SetSpacing(*((high - low) / steps))
    return image


def exclude_others(filter_, particles, array):
    data = particles.GetPointData()
    for i in range(data.GetNumberOfArrays()):
        if data.GetArrayName(i) != array:
            filter_.AddExcludedArray(data.GetArrayName(i))


def read_particles(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def make_probe(particles, image, array=None):
    """Of this array alone, or of all."""
    probe = vtkSPHProbe()
    probe.SetInputData(image)
    probe.SetSourceData(particles)
    if array:
        exclude_others(probe, particles, array)
    return probe


def make_interpolator(particles, image, array):
    kernel = vtkSPHCubicKernel()
    kernel.SetSpatialStep(particles.GetPointData().GetArray("SmoothingLength").GetRange()[1])
    kernel.SetDimension(3)
    interpolator = vtkSPHInterpolator()
    interpolator.SetInputData(image)
    interpolator.SetSourceData(particles)
    interpolator.SetLocator(vtkStaticPointLocator())
    interpolator.SetKernel(kernel)
    interpolator.SetMassArrayName("Mass")
    interpolator.SetDensityArrayName("Density")
    interpolator.ShepardNormalizationOn()
    exclude_others(interpolator, particles, array)
    return interpolator


def seconds_of(filter_):
    """Of the clock, and of the processors."""
    filter_.Modified()
    begin = time.perf_counter(), time.process_time()
    filter_.Update()
    return time.perf_counter() - begin[0], time.process_time() - begin[1]


def compare_slices(particles, array, size, runs):
    image = make_image(particles.GetBounds(), (size, size, 1))
    probe, anew = (make_probe(particles, image, array) for _ in range(2))
    anew.KeepDeviceDataOff()
    interpolator = make_interpolator(particles, image, array)
    cases = {"vtkSPHProbe, search grid kept": probe, "vtkSPHInterpolator, locator kept": interpolator,
             "vtkSPHProbe, search grid made": anew, "vtkSPHInterpolator, locator made": interpolator}
    times = {name: [] for name in cases}
    for run in range(runs + 1):
        for name, filter_ in cases.items():
            if name == "vtkSPHInterpolator, locator made":
                interpolator.GetLocator().FreeSearchStructure()
            used = seconds_of(filter_)
            if run > 0:  # the first one builds programs and search structures
                times[name].append(used)
    median = {name: [statistics.median(column) for column in zip(*used)]
              for name, used in times.items()}
    print(f"slice of {size}^2 points, medians of {runs}: seconds (spread), processor seconds; times as fast as VTK")
    for name, used in times.items():
        clock = [seconds for seconds, _ in used]
        beside = median["vtkSPHInterpolator, locator " + name.split()[-1]]
        print(f"  {name:34}{median[name][0]:8.3f} ({min(clock):.3f} .. {max(clock):.3f})"
              f"{median[name][1]:9.3f};{beside[0] / median[name][0]:7.1f}"
              f"{beside[1] / median[name][1]:7.1f}")
    ours = probe.GetOutput().GetPointData()
    theirs = interpolator.GetOutputDataObject(0).GetPointData()
    inside = vtk_to_numpy(ours.GetArray("WeightSum")) > 0.9
    a, b = (vtk_to_numpy(data.GetArray(array))[inside] for data in (ours, theirs))
    print(f"  largest difference at the {inside.sum()} points inside: "
          f"{numpy.abs(a - b).max() / numpy.ptp(a):.2e} of the range")


def measure_volume(particles, array, size):
    image = make_image(particles.GetBounds(), (size, size, size))
    before = peak_bytes()
    probe = make_probe(particles, image, array)
    used, processor = seconds_of(probe)
    out = probe.GetOutput().GetPointData()
    output = 1024 * sum(out.GetArray(i).GetActualMemorySize() for i in range(out.GetNumberOfArrays()))
    print(f"volume of {size}^3 points: {used:.2f} s, {processor:.2f} processor seconds; resident {before / 2**20:.0f} MiB before, at most "
          f"{peak_bytes() / 2**20:.0f} MiB, of which {output / 2**20:.0f} MiB output")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("particles")
    parser.add_argument("--array", default="Swirl")
    parser.add_argument("--slice", type=int, default=512)
    parser.add_argument("--volume", type=int, default=256)
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    particles = read_particles(options.particles)
    print(f"{particles.GetNumberOfPoints()} particles, array {options.array}")
    compare_slices(particles, options.array, options.slice, options.runs)
    if options.volume > 0:
        measure_volume(particles, options.array, options.volume)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""How long a run goes on after it is cancelled: surfaces and probes of particles.

  cancel.py PARTICLES.vtp [--array NAME] [--iso VALUE] [--runs N] [--stops N]

A run asks whether it is cancelled when it reports progress, so one waits for the next report at most, and
then for the end. For each kind of run, all kernels being compiled: the longest time without a report, the least
over N runs, by the clock and in processor seconds of all threads, with what ran then; and the longest time from a report that cancels to the return, over N
places in a run. The particles are those of Examples/Data/make_tank.py.
"""
import argparse
import time

from marchingcorrectors import vtkMarchingCorrectors
from probe import make_image, make_probe, read_particles


class Watch:
    """Times a filter's reports of progress."""

    def __init__(self, filter_):
        self.filter, self.reports, self.stop_at = filter_, [], None
        filter_.AddObserver("ProgressEvent", self.on_progress)

    def on_progress(self, *_):
        self.reports.append((time.perf_counter(), time.process_time(), self.filter.GetProgressText()))
        if len(self.reports) == self.stop_at:
            self.filter.AbortExecuteOn()

    def run(self, stop_at=None):
        """Seconds of the whole run; the longest gaps by clock and processors, each with what it begins with;
        seconds after the stop."""
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


def make_surface(particles, array, iso):
    filter_ = vtkMarchingCorrectors()
    filter_.SetInputData(particles)
    if array:
        filter_.SetInputArrayToProcess(0, 0, 0, 0, array)
        filter_.SetValue(0, iso)
    else:
        filter_.FreeSurfaceOn()
    filter_.KeepDeviceDataOff()
    return filter_


def make_fresh_probe(particles, points, array=None):
    filter_ = make_probe(particles, points, array)
    filter_.KeepDeviceDataOff()
    return filter_


def report(name, filter_, runs, stops):
    watch = Watch(filter_)
    watch.run()
    timed = [watch.run() for _ in range(runs)]
    reports = len(watch.reports)
    clock, processor = (min(run[1][i] for run in timed) for i in range(2))
    after = max(watch.run(1 + k * reports // stops)[2] for k in range(stops))
    print(f"{name:28} {min(run[0] for run in timed):6.2f} s, {reports:4} reports; longest without one "
          f"{clock[0]:.3f} s ({clock[1]}), {processor[0]:.3f} processor s ({processor[1]}); from cancel to return {after:.3f} s", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("particles")
    parser.add_argument("--array", default="Swirl")
    parser.add_argument("--iso", type=float, default=1.2)
    parser.add_argument("--volume", type=int, default=256)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--stops", type=int, default=8)
    options = parser.parse_args()
    particles = read_particles(options.particles)
    n = options.volume
    volume = make_image(particles.GetBounds(), (n, n, n))
    kinds = {
        f"{options.array} {options.iso:g}": make_surface(particles, options.array, options.iso),
        "free surface": make_surface(particles, None, 0),
        "slice of 512^2": make_fresh_probe(particles, make_image(particles.GetBounds(), (512, 512, 1))),
        f"volume of {n}^3": make_fresh_probe(particles, volume, options.array),
    }
    print(f"{particles.GetNumberOfPoints()} particles")
    for name, filter_ in kinds.items():
        report(name, filter_, options.runs, options.stops)


if __name__ == "__main__":
    main()

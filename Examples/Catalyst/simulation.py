#!/usr/bin/env python3
# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Stands in for a running solver, which gives its particles to ParaView at every step (in situ).

    [mpirun -n RANKS] /usr/bin/python3 simulation.py SCRIPT [STEPS]

SCRIPT is a Catalyst 2 script such as extract_surfaces.py, which gets the particles of every step on the
channel "particles". Each process moves every RANKS-th particle, so none has a region of its own.
"""
import sys

import numpy as np
from paraview.catalyst import bridge  # This import must come before all others of ParaView.
from vtkmodules.vtkCommonDataModel import vtkPointSet
from vtkmodules.vtkParallelCore import vtkMultiProcessController
from vortex import advanced, ball, fill

TIME_STEP = 0.05


def main(script, steps):
    bridge.initialize()
    bridge.add_pipeline(script, 2)
    controller = vtkMultiProcessController.GetGlobalController()
    points = ball()
    own = np.arange(controller.GetLocalProcessId(), len(points), controller.GetNumberOfProcesses())
    points = points[own]
    for step in range(steps):
        # Catalyst gets the particles as a Conduit mesh of points: points and arrays, no cells.
        bridge.coprocess(step * TIME_STEP, step, fill(vtkPointSet(), points, own), name="particles")
        points = advanced(points, TIME_STEP)
    bridge.finalize()


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10)

# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Isosurfaces of SPH particles: from marchingcorrectors import vtkMarchingCorrectors"""
# The superclasses' modules must be loaded before our own.
import vtkmodules.vtkCommonExecutionModel  # noqa: F401

from .vtkMarchingCorrectors import (vtkMarchingCorrectors, vtkSPHAlgorithm, vtkSPHComponents,
                                    vtkSPHDerivatives, vtkSPHFlux, vtkSPHGauge, vtkSPHMeter, vtkSPHProbe,
                                    vtkSPHProjection, vtkSPHResample, vtkSPHTemporalInterpolator)

__all__ = ["vtkMarchingCorrectors", "vtkSPHAlgorithm", "vtkSPHComponents", "vtkSPHDerivatives", "vtkSPHFlux",
           "vtkSPHGauge", "vtkSPHMeter", "vtkSPHProbe", "vtkSPHProjection", "vtkSPHResample", "vtkSPHTemporalInterpolator"]

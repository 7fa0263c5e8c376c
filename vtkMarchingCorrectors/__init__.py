# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Isosurfaces of SPH particles: from marchingcorrectors import vtkMarchingCorrectors"""
# Classes of superclasses must be known before our own module is loaded.
import vtkmodules.vtkCommonExecutionModel  # noqa: F401

from .vtkMarchingCorrectors import (vtkMarchingCorrectors, vtkSPHAlgorithm, vtkSPHComponents,
                                    vtkSPHDerivatives, vtkSPHFlux, vtkSPHGauge, vtkSPHMeter, vtkSPHProbe,
                                    vtkSPHProjection, vtkSPHResample, vtkSPHTemporalInterpolator)

__all__ = ["vtkMarchingCorrectors", "vtkSPHAlgorithm", "vtkSPHComponents", "vtkSPHDerivatives", "vtkSPHFlux",
           "vtkSPHGauge", "vtkSPHMeter", "vtkSPHProbe", "vtkSPHProjection", "vtkSPHResample", "vtkSPHTemporalInterpolator"]

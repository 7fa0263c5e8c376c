# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""A Catalyst 2 script, which writes the free surface of a running solver's particles at every second step.

The solver's channel is called "particles". The environment names the plugin, MCOR_PLUGIN, and the folder
for what is written, MCOR_EXTRACTS. All processes run this script, and share each surface.
"""
import os

from paraview import catalyst
from paraview.simple import CreateExtractor, LoadPlugin, TrivialProducer

LoadPlugin(os.environ["MCOR_PLUGIN"], ns=globals())
options = catalyst.Options()
options.ExtractsOutputDirectory = os.environ.get("MCOR_EXTRACTS", ".")

particles = TrivialProducer(registrationName="particles")
surface = MarchingCorrectors(registrationName="surface", Input=particles, FreeSurface=1)  # noqa: F821, the plugin's
extractor = CreateExtractor("VTP", surface, registrationName="surface")
extractor.Trigger = "TimeStep"
extractor.Trigger.Frequency = 2
extractor.Writer.FileName = "surface_{timestep:04d}.pvtp"
extractor.Writer.DataMode = "Binary"  # Small appended data cannot be read with a recent expat.


def catalyst_execute(info):
    """ParaView calls this once a step, before it writes the extracts."""
    surface.UpdatePipeline(info.time)
    print(f"step {info.timestep}, time {info.time:g}: {surface.GetDataInformation().GetNumberOfCells()} triangles",
          flush=True)

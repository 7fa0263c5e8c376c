# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads solvers' own files and tables for ParaView's File > Open; several files, or the steps of one file, are time
steps. This module is part of the plugin in MarchingCorrectorsFilter.py.

HDF5 needs h5py in ParaView's Python."""
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smdomain, smhint, smproperty, smproxy
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from . import io
from .io.convert import to_vtk

# ParaView reads VTK's own files itself. It also has readers of tables and molecules, which make no particles; for such files
# ParaView asks which reader to use.
ENDINGS = [ending[1:] for ending in io.ENDINGS if ending not in (".vtp", ".vtu", ".vtk", *io.LISTS)] + ["gadget"]


@smproxy.reader(name="SPHParticleReader", label="SPH Particle Reader", extensions=ENDINGS,
                file_description="SPH particles (GADGET, SWIFT, Phantom, PySPH, DualSPHysics, bgeo, tables, XYZ, LAMMPS)")
class SPHParticleReader(VTKPythonAlgorithmBase):
    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkPolyData")
        self._names, self._types, self._steps, self._kept = [], "gas", None, (None, None)

    @smproperty.stringvector(name="FileNames", command="AddFileName", clean_command="ClearFileNames",
                             repeat_command="1", number_of_elements="1", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions=ENDINGS, file_description="SPH particles")
    def AddFileName(self, name):
        if name and name != "None":
            self._names.append(name)
            self._steps = None
            self.Modified()

    def ClearFileNames(self):
        self._names, self._steps = [], None
        self.Modified()

    @smproperty.stringvector(name="Types", default_values="gas")
    def SetTypes(self, types):
        """Sets which types of particles are read from files of GADGET's layout: names or numbers, with commas between them."""
        if types != self._types:
            self._types, self._kept = types, (None, None)
            self.Modified()

    @smproperty.doublevector(name="TimestepValues", information_only="1", si_class="vtkSITimeStepsProperty")
    def GetTimestepValues(self):
        try:
            return [time for time, _, _ in self._list_steps()] or None
        except io.FileError:  # RequestInformation says the sentence.
            return None

    def _open(self, name, step=0):
        types = [int(word) if word.isdigit() else word for word in (self._types or "gas").replace(",", " ").split()]
        try:
            return io.read(name, types=types, step=step)
        except io.FileError as error:
            if "no types to choose" not in str(error):
                raise
            return io.read(name, step=step)

    def _list_steps(self):
        """Returns (time, file, number of the step in the file) of each step. If a file tells no time, or the times do not
        ascend, times are 0, 1, ..."""
        if self._steps is None:
            found = []
            for name in self._names:
                particles = self._open(name)
                found += [(time, name, i) for i, time in enumerate(particles.times or [particles.time])]
            times = [time for time, _, _ in found]
            if None in times or any(a >= b for a, b in zip(times, times[1:])):
                found = [(float(i), name, step) for i, (_, name, step) in enumerate(found)]
            self._steps = found
        return self._steps

    def RequestInformation(self, request, inputs, outputs):
        try:
            times = [time for time, _, _ in self._list_steps()]
        except io.FileError as error:
            self._fail(error)
            return 0
        information = outputs.GetInformationObject(0)
        information.Set(Pipeline.TIME_STEPS(), times, len(times))
        information.Set(Pipeline.TIME_RANGE(), [times[0], times[-1]], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        information = outputs.GetInformationObject(0)
        try:
            steps, i = self._list_steps(), 0
            if information.Has(Pipeline.UPDATE_TIME_STEP()):
                wanted = information.Get(Pipeline.UPDATE_TIME_STEP())
                i = max((i for i, (time, _, _) in enumerate(steps) if time <= wanted), default=0)
            time, name, step = steps[i]
            if self._kept[0] != (name, step):
                self._kept = (name, step), self._open(name, step)
            data = to_vtk(self._kept[1])
        except io.FileError as error:
            self._fail(error)
            return 0
        output = vtkPolyData.GetData(outputs, 0)
        output.ShallowCopy(data)
        output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
        return 1

    def _fail(self, error):
        vtkOutputWindow.GetInstance().DisplayErrorText(f"SPH Particle Reader: {error}\n")

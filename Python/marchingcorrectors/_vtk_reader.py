# SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
# SPDX-License-Identifier: BSD-3-Clause
"""Solvers' own files by ParaView's File > Open, a series as time steps: part of the plugin in MarchingCorrectorsFilter.py.

HDF5 wants h5py in ParaView's Python."""
from paraview.util.vtkAlgorithm import VTKPythonAlgorithmBase, smdomain, smhint, smproperty, smproxy
from vtkmodules.vtkCommonCore import vtkOutputWindow
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from . import io
from .io.convert import to_vtk

# Those of VTK have their readers.
ENDINGS = ["hdf5", "h5", "bi4", "bgeo"]


@smproxy.reader(name="SPHParticleReader", label="SPH Particle Reader", extensions=ENDINGS,
                file_description="SPH particles (GADGET, SWIFT, Phantom, PySPH, DualSPHysics, bgeo)")
class SPHParticleReader(VTKPythonAlgorithmBase):
    def __init__(self):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkPolyData")
        self._names, self._types, self._times, self._kept = [], "gas", None, (None, None)

    @smproperty.stringvector(name="FileNames", command="AddFileName", clean_command="ClearFileNames",
                             repeat_command="1", number_of_elements="1", panel_visibility="never")
    @smdomain.filelist()
    @smhint.filechooser(extensions=ENDINGS, file_description="SPH particles")
    def AddFileName(self, name):
        if name and name != "None":
            self._names.append(name)
            self._times = None
            self.Modified()

    def ClearFileNames(self):
        self._names, self._times = [], None
        self.Modified()

    @smproperty.stringvector(name="Types", default_values="gas")
    def SetTypes(self, types):
        """Of GADGET's layout: names or numbers, with commas between them."""
        if types != self._types:
            self._types, self._kept = types, (None, None)
            self.Modified()

    @smproperty.doublevector(name="TimestepValues", information_only="1", si_class="vtkSITimeStepsProperty")
    def GetTimestepValues(self):
        try:
            return self._times_of() if self._names else None
        except io.FileError:  # RequestInformation says it
            return None

    def _read(self, i):
        if self._kept[0] != i:
            self._kept = (i, self._open(self._names[i]))
        return self._kept[1]

    def _open(self, name):
        types = [int(word) if word.isdigit() else word for word in (self._types or "gas").replace(",", " ").split()]
        try:
            return io.read(name, types=types)
        except io.FileError as error:
            if "no types to choose" not in str(error):
                raise
            return io.read(name)

    def _times_of(self):
        """What the files say where that rises from one to the next; else their numbers."""
        if self._times is None:
            times = [self._open(name).time for name in self._names]
            rising = None not in times and all(a < b for a, b in zip(times, times[1:]))
            self._times = times if rising else [float(i) for i in range(len(times))]
        return self._times

    def RequestInformation(self, request, inputs, outputs):
        try:
            times = self._times_of()
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
            times, step = self._times_of(), 0
            if information.Has(Pipeline.UPDATE_TIME_STEP()):
                wanted = information.Get(Pipeline.UPDATE_TIME_STEP())
                step = max((i for i, time in enumerate(times) if time <= wanted), default=0)
            data = to_vtk(self._read(step))
        except io.FileError as error:
            self._fail(error)
            return 0
        output = vtkPolyData.GetData(outputs, 0)
        output.ShallowCopy(data)
        output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), times[step])
        return 1

    def _fail(self, error):
        vtkOutputWindow.GetInstance().DisplayErrorText(f"SPH Particle Reader: {error}\n")

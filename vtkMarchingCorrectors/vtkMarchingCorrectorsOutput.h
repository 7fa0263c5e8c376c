// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: makes a vtkPolyData, statistics included, of the core's surface.
 */
#ifndef vtkMarchingCorrectorsOutput_h
#define vtkMarchingCorrectorsOutput_h

#include "mcor.h"

class vtkFieldData;
class vtkMarchingCorrectors;
class vtkMarchingCorrectorsInput;
class vtkPolyData;

class vtkMarchingCorrectorsOutput
{
public:
  /**
   * The surface's arrays are taken over where types agree, and are NULL in the surface then.
   */
  vtkMarchingCorrectorsOutput(vtkMarchingCorrectors* filter,
    const vtkMarchingCorrectorsInput& input, const mcor_options& options, mcor_surface& surface);

  void BuildMesh(vtkPolyData* output);
  /** Statistics and parameters: a function of the input and the options alone. */
  void BuildFieldData(vtkFieldData* fieldData) const;
  /** What the run cost: another one for the same surface may take longer. */
  void BuildRunStatistics(vtkFieldData* run) const;

private:
  void BuildTriangles(vtkPolyData* output);
  void BuildComputedArrays(vtkPolyData* output);
  void BuildInterpolatedArrays(vtkPolyData* output);
  void BuildIsoValue(vtkPolyData* output);
  void AddStatistics(vtkFieldData* fieldData) const;
  void AddParameters(vtkFieldData* fieldData) const;

  vtkMarchingCorrectors* Filter;
  const vtkMarchingCorrectorsInput& Input;
  const mcor_options& Options;
  mcor_surface& Surface;
};

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: makes a vtkPolyData, statistics included, of the core's surface.
 */
#ifndef vtkMarchingCorrectorsOutput_h
#define vtkMarchingCorrectorsOutput_h

#include "mcor.h"

#include <string>
#include <vector>

class vtkFieldData;
class vtkMarchingCorrectorsInput;
class vtkPolyData;

class vtkMarchingCorrectorsOutput
{
public:
  /**
   * The surface's arrays are taken over where types agree, and are NULL in the surface then.
   */
  vtkMarchingCorrectorsOutput(
    const vtkMarchingCorrectorsInput& input, const mcor_options& options, mcor_surface& surface);

  /** Names of the arrays that the core is asked to compute; their places in the output are theirs.
   */
  static std::vector<std::string> ComputedArrays(const mcor_options& options);

  /** precision: of the points, as vtkAlgorithm has it. */
  void BuildMesh(vtkPolyData* output, int precision);
  /** Statistics and parameters: a function of the input and the options alone. */
  void BuildFieldData(vtkFieldData* fieldData) const;

private:
  void BuildTriangles(vtkPolyData* output);
  void BuildComputedArrays(vtkPolyData* output);
  void BuildInterpolatedArrays(vtkPolyData* output);
  void BuildIsoValue(vtkPolyData* output);
  void AddStatistics(vtkFieldData* fieldData) const;
  void AddParameters(vtkFieldData* fieldData) const;

  const vtkMarchingCorrectorsInput& Input;
  const mcor_options& Options;
  mcor_surface& Surface;
};

#endif

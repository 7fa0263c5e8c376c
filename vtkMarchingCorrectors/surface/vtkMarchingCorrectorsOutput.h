// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: makes a vtkPolyData of the core's surface, and the statistics of the run. */
#ifndef vtkMarchingCorrectorsOutput_h
#define vtkMarchingCorrectorsOutput_h

#include "mcor.h"
#include "vtkSPHArrays.h"

#include <functional>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkFieldData;
class vtkPolyData;
class vtkSPHParticles;

/**
 * Lists the arrays that the core computes at points, in the output's order. Each array has a bit
 * of mcor_output, a member of mcor_surface, components, a name, and a flag of the filter.
 */
#define vtkMarchingCorrectorsArrays(ARRAY)                                                         \
  ARRAY(MCOR_OUT_NORMALS, normals, 3, "Normals", ComputeNormals)                                   \
  ARRAY(MCOR_OUT_GRADIENTS, gradients, 3, "Gradients", ComputeGradients)                           \
  ARRAY(MCOR_OUT_WEIGHT_SUM, weight_sum, 1, "WeightSum", ComputeWeightSum)                         \
  ARRAY(MCOR_OUT_BOUNDARY_EIGENVALUE, boundary_eigenvalue, 1, "BoundaryEigenvalue",                \
    ComputeBoundaryEigenvalue)                                                                     \
  ARRAY(MCOR_OUT_MEAN_CURVATURE, mean_curvature, 1, "MeanCurvature", ComputeCurvature)             \
  ARRAY(MCOR_OUT_GAUSS_CURVATURE, gauss_curvature, 1, "GaussCurvature", ComputeCurvature)          \
  ARRAY(                                                                                           \
    MCOR_OUT_CORRECTION_LENGTH, correction_length, 1, "CorrectionLength", ComputeCorrectionLength) \
  ARRAY(MCOR_OUT_RESIDUAL, residual, 1, "Residual", ComputeResidual)                               \
  ARRAY(MCOR_OUT_BOUNDARY_FLAG, boundary_flag, 1, "BoundaryFlag", ComputeBoundaryFlag)

class vtkMarchingCorrectorsOutput
{
public:
  /** BuildMesh() takes over arrays of the surface, and sets their pointers in `surface` to NULL. */
  vtkMarchingCorrectorsOutput(
    const vtkSPHParticles& input, const mcor_options& options, mcor_surface& surface);

  /** Lists the names of the arrays that the core must compute. */
  static std::vector<std::string> ComputedArrays(const mcor_options& options);

  /**
   * Writes the mesh, its arrays and the iso values to `output`. precision: the points' precision, as
   * in vtkAlgorithm. merge: merges ranges over all processes, see vtkRun::MergeRanges(); so all
   * processes that share a run must call BuildMesh().
   */
  using Merge = std::function<void(double* ranges, int count)>;
  void BuildMesh(vtkPolyData* output, int precision, const Merge& merge);
  /** Returns the largest magnitude of the mesh's coordinates if they are floats; else 0. Call it
   * before BuildMesh(). */
  double FindLargestFloat(int precision) const;
  /** Adds statistics and parameters. Except the device, its platform and the costs of the run, they
   * depend on input and options alone. */
  void AddRun(vtkFieldData* run) const;

private:
  bool StoresFloats(int precision) const;
  void BuildCells(vtkPolyData* output);
  void BuildInterpolatedArrays(vtkPolyData* output);
  void ChooseActive(vtkPolyData* output, const Merge& merge) const;
  void AddIsoValues(vtkFieldData* fieldData) const;
  void AddParameters(vtkFieldData* fieldData) const;

  const vtkSPHParticles& Input;
  const mcor_options& Options;
  mcor_surface& Surface;
};
VTK_ABI_NAMESPACE_END

#endif

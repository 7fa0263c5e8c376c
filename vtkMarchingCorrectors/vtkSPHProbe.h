// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHProbe
 * @brief   the field of SPH particles at the points of any data set
 *
 * vtkSPHProbe evaluates the SPH field of particles at the points of any data set. Its ports are
 * those of vtkProbeFilter: the points come in at port 0, the particles at port 1, the "source".
 *
 *     Shepard (default)   sum_j V_j A_j W(x - x_j, s h_j) / sum_j V_j W(x - x_j, s h_j)
 *     sum                 sum_j V_j A_j W(x - x_j, s h_j)       (ShepardNormalizationOff)
 *
 * The output is the data set of port 0, its own arrays included, with
 *
 *     one array for each float or double point array of the particles, with the same name and type
 *     WeightSum             sum_j V_j W(x - x_j, s h_j): about 1 in the fluid, 0 far from it
 *     vtkValidPointMask     1 where the weight is not below WeightThreshold, else 0
 *     NAME_Gradient         of each of these arrays and of WeightSum, if ComputeGradients is on: 3
 *                           values per component: d/dx, d/dy, d/dz of the first, then the next
 *
 * Existing arrays of these names are replaced. The active scalars become the velocities, else the
 * first vector or scalar of the particles that varies. Arrays of other types, such as identifiers,
 * are left out; a float or double array with NaN or infinity at a fluid particle is left out with a
 * warning. Only fluid particles count. Points that vtkGhostType marks as duplicates have values,
 * too. The value at a point depends on neither other points nor the order of points or particles.
 *
 * Composite data at port 0 give composite data. Particles in several blocks are taken together.
 *
 * @sa
 * vtkSPHAlgorithm vtkMarchingCorrectors vtkSPHDerivatives vtkSPHInterpolator vtkProbeFilter
 */

#ifndef vtkSPHProbe_h
#define vtkSPHProbe_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"

VTK_ABI_NAMESPACE_BEGIN
class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHProbe : public vtkSPHAlgorithm
{
public:
  static vtkSPHProbe* New();
  vtkTypeMacro(vtkSPHProbe, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** Returns the data set of port 0 with the new arrays, in data of the same class. */
  vtkDataObject* GetOutput() { return this->GetOutputDataObject(0); }

  ///@{
  /** The particles, port 1: a point set, or blocks of them. */
  void SetSourceConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
  void SetSourceData(vtkDataObject* source) { this->SetInputDataObject(1, source); }
  vtkDataObject* GetSource() { return this->GetParticles(); }
  ///@}

  /** Also leave solid particles out when volumes are computed from positions. Off by default. */
  vtkSPHChoiceFlagMacro(IgnoreSolids);

  /** Divide the SPH sums by the sum of the weights (Shepard). On by default. */
  vtkSPHFlagMacro(ShepardNormalization, 1);

  /** Points with a lower weight are not valid. No unit, 0.1 by default. */
  vtkSPHClampMacro(WeightThreshold, double, 0.1, 0.0, VTK_DOUBLE_MAX);

  /** Add the particles' arrays; off: only WeightSum and the mask. On by default. */
  vtkSPHFlagMacro(InterpolateAttributes, 1);

  /** Add the gradients, unit of the array / L. Off by default. */
  vtkSPHFlagMacro(ComputeGradients, 0);

  ///@{
  /**
   * The value of arrays, except WeightSum and the mask, at invalid points: NaN if NaNOutside is on
   * (off by default), else NullValue (0 by default).
   */
  vtkSPHFlagMacro(NaNOutside, 0);
  vtkSPHValueMacro(NullValue, double, 0.0);
  ///@}

  /** The name of the mask of valid points, "vtkValidPointMask" by default. */
  vtkSPHTextMacro(ValidPointMaskArrayName, "vtkValidPointMask");

protected:
  vtkSPHProbe();
  ~vtkSPHProbe() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  void Process(vtkDataObject* input, vtkDataObject* output) override;
  // Blocks of points stay apart, because the value at a point does not depend on other points.
  bool TakesTogether() const override { return false; }

  /** Returns 1, or 0 in a subclass whose only input are the particles. */
  int GetParticlesPort() override { return this->GetNumberOfInputPorts() - 1; }

private:
  vtkSPHProbe(const vtkSPHProbe&) = delete;
  void operator=(const vtkSPHProbe&) = delete;

  static void FinishOutput(vtkRun& run, vtkPointData* found, vtkDataSet* output);
};
VTK_ABI_NAMESPACE_END

#endif

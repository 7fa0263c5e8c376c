// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHDerivatives
 * @brief   gradients of SPH particle arrays, vorticity, Q-criterion, lambda2
 *
 * vtkSPHDerivatives adds the SPH gradient of a point array to the particles and, for a vector with
 * three components (in two dimensions also with two), the quantities below. The array is chosen as
 * for vtkMarchingCorrectors.
 *
 *     standard            G_i = sum_j V_j (A_j - A_i) grad W(x_i - x_j, s h_j)
 *     corrected (default) M_i^-1 G_i,  M_i = sum_j V_j grad W(x_i - x_j, s h_j) (x_j - x_i)^T
 *
 * The corrected form is exact for a linear A, also at the end of the fluid, wherever M_i can be inverted;
 * where it cannot, as in spray, the standard form is used.
 *
 * The output is the input with these point arrays (J = S + O: the gradient of a vector, S symmetric, O
 * antisymmetric):
 *
 *     Gradients            3 values per component: d/dx, d/dy, d/dz of the first, then the next
 *     GradientsCorrected   1 where the corrected form was used, else 0
 *     Divergence           tr J
 *     Vorticity            curl
 *     Q-criterion          (tr(J)^2 - tr(J J)) / 2, as in vtkGradientFilter
 *     Lambda2              the middle eigenvalue of S S + O O; below 0 in the core of a vortex; not in two dimensions
 *     StrainRate           S, nine values
 *
 * All but GradientsCorrected are float if the input array is, else double. Sums are over fluid
 * particles. Solid particles get zeros; if processes share the run, so do particles that
 * vtkGhostType marks as duplicates.
 *
 * @warning
 * If a block is processed by itself (see SetBlocks()), or a piece is not shared by processes,
 * gradients at the cut are as at the end of the fluid.
 *
 * @sa
 * vtkSPHAlgorithm vtkMarchingCorrectors vtkSPHProbe vtkGradientFilter
 */

#ifndef vtkSPHDerivatives_h
#define vtkSPHDerivatives_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"

VTK_ABI_NAMESPACE_BEGIN
class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHDerivatives : public vtkSPHAlgorithm
{
public:
  static vtkSPHDerivatives* New();
  vtkTypeMacro(vtkSPHDerivatives, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** Returns the particles with the new arrays, in data of the same class as the input. */
  vtkDataObject* GetOutput() { return this->GetOutputDataObject(0); }

  /** Also leave solid particles out when volumes are computed from positions. Off by default. */
  vtkSPHChoiceFlagMacro(IgnoreSolids);

  /** Use the corrected form of the gradient. On by default. */
  vtkSPHFlagMacro(CorrectGradients, 1);

  /** Add the gradient of the array, unit of the array / L. On by default. */
  vtkSPHFlagMacro(ComputeGradient, 1);

  /** The name of the array of gradients, "Gradients" by default. GradientsCorrected gets this name with "Corrected" behind it. */
  vtkSPHTextMacro(ResultArrayName, "Gradients");

  /** Replace existing arrays of the same names. Off by default: the new ones are called NAME_SPH. */
  vtkSPHFlagMacro(ReplaceArrays, 0);

  ///@{
  /**
   * Add these quantities, which follow from the gradient of a vector; without effect for other
   * arrays. On by default, except the strain rate. The unit is the array's unit / L; for Q-criterion
   * and Lambda2, it is the square of this unit.
   */
  vtkSPHFlagMacro(ComputeDivergence, 1);
  vtkSPHFlagMacro(ComputeVorticity, 1);
  vtkSPHFlagMacro(ComputeQCriterion, 1);
  vtkSPHFlagMacro(ComputeLambda2, 1);
  vtkSPHFlagMacro(ComputeStrainRate, 0);
  ///@}

protected:
  vtkSPHDerivatives();
  ~vtkSPHDerivatives() override = default;

  void Process(vtkDataObject* input, vtkDataObject* output) override;
  bool KeepsBlocks() const override { return true; }

private:
  vtkSPHDerivatives(const vtkSPHDerivatives&) = delete;
  void operator=(const vtkSPHDerivatives&) = delete;

  struct vtkWanted;
  vtkWanted ListWanted(vtkPointSet* particles) const;
};
VTK_ABI_NAMESPACE_END

#endif

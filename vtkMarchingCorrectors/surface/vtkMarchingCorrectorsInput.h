// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the particles of a run of vtkMarchingCorrectors, and the scalar that it
 * contours.
 */
#ifndef vtkMarchingCorrectorsInput_h
#define vtkMarchingCorrectorsInput_h

#include "vtkSPHParticles.h"

VTK_ABI_NAMESPACE_BEGIN
struct vtkMarchingCorrectorsChoice : vtkSPHParticlesChoice
{
  vtkSPHRequest Scalar;
  vtkSPHRequest ScalarDot;
  int ScalarComponent = MCOR_MAGNITUDE;
  bool FreeSurface = false;
  bool InterpolateAttributes = true;
  std::vector<std::string> ComputedArrays; // names that the output already uses
  bool ComputeScalars = true;
  bool Filled = false;
};

class vtkMarchingCorrectorsInput : public vtkSPHParticles
{
public:
  vtkMarchingCorrectorsInput(const vtkMarchingCorrectorsChoice& choice, vtkPointSet* points)
    : vtkSPHParticles(choice, points)
    , Choice(choice)
  {
  }

  /**
   * Finds what `wants` names, bits of mcor_want. Returns false if something is missing or not usable;
   * Error then says why.
   */
  bool Collect(unsigned wants);
  /** Finds all that a surface needs. */
  bool Collect()
  {
    return this->Collect(MCOR_WANT_SIZES | MCOR_WANT_SCALAR |
      (this->Choice.InterpolateAttributes ? MCOR_WANT_ATTRIBUTES : 0));
  }

  /**
   * Takes the arrays that vtkMarchingCorrectors::FindWidening() has found. The factors become the
   * core's last attribute, without being one of Interpolated.
   */
  void TakeWidening(vtkDataArray* factors, vtkDataArray* volumes);

  const vtkMarchingCorrectorsChoice Choice;
  vtkSmartPointer<vtkDataArray> Scalar;
  vtkSmartPointer<vtkDataArray> ScalarDot;
  std::string IsoValueName; // see vtkMarchingCorrectors::SetComputeScalars

private:
  std::vector<mcor_array> Attributes; // with the factors of the widening
};

VTK_ABI_NAMESPACE_END

#endif

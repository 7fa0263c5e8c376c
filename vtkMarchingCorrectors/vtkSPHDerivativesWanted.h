// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what a run of vtkSPHDerivatives adds to the particles, as it was asked for
 * when the run began.
 */
#ifndef vtkSPHDerivativesWanted_h
#define vtkSPHDerivativesWanted_h

#include "mcor.h"
#include "vtkSPHDerivatives.h"

#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkPointData;
struct vtkSPHAttribute;

struct vtkSPHDerivatives::vtkWanted
{
  /** One of the arrays made of the gradient of a vector. */
  struct Quantity
  {
    std::string Name;
    int Components;
    double* mcor_flow::*Values;
    bool IsWanted;

    /** False if memory ran out. */
    bool AddTo(vtkPointData* data, const mcor_derivatives& derivatives, const double* gradients,
      bool asFloat) const;
  };

  /** Takes memory out of `derivatives`, which are of the array `from`. False if memory ran out. */
  bool AddTo(vtkPointData* data, mcor_derivatives& derivatives, const vtkSPHAttribute& from) const;

  static std::string DescribeNoMemory(vtkIdType particles);

  std::vector<Quantity> Quantities;
  bool Gradient;
  std::string GradientName;
};
VTK_ABI_NAMESPACE_END

#endif

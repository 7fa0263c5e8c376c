// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the arrays that a run of vtkSPHDerivatives adds to the particles, as
 * they were wanted when the run began.
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

    /** Returns false if memory ran out. */
    bool AddTo(vtkPointData* data, const mcor_derivatives& derivatives, const double* gradients,
      bool asFloat) const;
  };

  /**
   * Takes over memory of `derivatives`, which were made from the array `from`. Returns false if
   * memory ran out.
   */
  bool AddTo(vtkPointData* data, mcor_derivatives& derivatives, const vtkSPHAttribute& from) const;

  static std::string DescribeNoMemory(vtkIdType particles);

  std::vector<Quantity> Quantities;
  bool Gradient;
  std::string GradientName;
};
VTK_ABI_NAMESPACE_END

#endif

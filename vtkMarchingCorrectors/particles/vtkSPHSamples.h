// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the arrays that vtkSPHProbe makes, filled for a chunk of points at a
 * time.
 */
#ifndef vtkSPHSamples_h
#define vtkSPHSamples_h

#include "mcor.h"
#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHParticles;

class vtkSPHSamples
{
public:
  /**
   * Begins with `null` at `count` points for the particles' interpolated arrays, and zeros for
   * their weight.
   */
  vtkSPHSamples(const vtkSPHParticles& particles, const mcor_options& options,
    const std::string& maskName, vtkIdType count, double null);

  /** Takes over what the core has found at the points from `first` on. */
  void Put(vtkIdType first, const mcor_samples& samples);

  /** Adds the arrays to the output, without those that the core has left out. */
  void AddTo(vtkFieldData* data) const;

  std::vector<std::int64_t> NotFinite; // of the interpolated arrays, as in mcor_samples
  mcor_statistics Statistics = {};     // of the last points

private:
  /** An array of the output, and that of its gradient, if wanted. */
  struct Pair
  {
    vtkSmartPointer<vtkDataArray> Values, Gradient;
  };

  Pair Make(const std::string& name, int components, bool asFloat, bool gradient) const;

  const vtkIdType Count;
  const double Null;        // the value at points that are not valid
  std::vector<Pair> Arrays; // in the order of the core's attributes
  Pair Weight;
  vtkNew<vtkCharArray> Mask; // as in vtkProbeFilter
};
VTK_ABI_NAMESPACE_END

#endif

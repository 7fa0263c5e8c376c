// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** How particles are described: the members behind settings of vtkSPHAlgorithm. */
#ifndef vtkSPHParticlesChoice_h
#define vtkSPHParticlesChoice_h
#ifndef __VTK_WRAP__
#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

struct mcor_input;
struct mcor_options;

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;

/** A range in which the values of a point array must be, see vtkSPHAlgorithm::AddOnly(). */
struct vtkSPHOnly
{
  std::string Name;
  double Low, High;
};

/**
 * Computes sums over neighbours if processes share the particles. Writes a value for each particle
 * of this process, as vtkSPHSumNeighbors() does. Returns why the sums failed, else an empty text.
 * The function itself is empty if there is one process.
 */
using vtkSPHSumShared = std::function<std::string(vtkPointSet* points, const mcor_input& mine,
  const mcor_options& options, const double* ratio, double* values)>;

/**
 * Arrays that were computed from neighbours: for each name, the signature of the data that an array
 * was computed from, and the array.
 */
using vtkSPHMade =
  std::map<std::string, std::pair<std::vector<std::uint64_t>, vtkSmartPointer<vtkDataArray>>>;

/**
 * The description of particles, see the setters of vtkSPHAlgorithm. A run has a copy, because an
 * observer may change the filter meanwhile.
 */
struct vtkSPHParticlesChoice
{
  std::string SmoothingLengthArrayName;
  double SmoothingLength = 0.0;
  vtkTypeBool EstimateSmoothingLength = 0;
  int SmoothingLengthEstimate = 0;
  double NeighborRatio = 1.3;
  vtkTypeBool SmoothingLengthIsSupportRadius = 0;
  std::string VolumeArrayName;
  std::string MassArrayName;
  std::string DensityArrayName;
  double Mass = 0.0;
  double Density = 0.0;
  double ParticleVolume = 0.0;
  vtkTypeBool ComputeVolumes = 0;
  vtkTypeBool DetectArrays = 1;
  std::string FluidArrayName;
  double FluidValue = 0.0;
  vtkTypeBool DetectFluid = 0;
  std::string UnusedType; ///< a sentence: no fluid was chosen, although an array seems to tell it
  /** Whether solid particles are left out everywhere, also of weights and computed volumes. Most filters
   * have a setter for this member; vtkMarchingCorrectors sets it by SetSolids(). */
  vtkTypeBool IgnoreSolids = 0;
  int Kernel = 0;
  int Dimension = 0;
  double PeriodicBounds[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  vtkTypeBool DetectPeriod = 0;
  vtkSPHSumShared SumShared;
  std::shared_ptr<vtkSPHMade> Made = std::make_shared<vtkSPHMade>();
  std::vector<std::string> ExcludedArrays;
  double Within[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  std::vector<vtkSPHOnly> Only;

  /** Whether the fluid array is a block of composite data, "Block: NAME". */
  bool IsBlock() const { return this->FluidArrayName.compare(0, 7, "Block: ") == 0; }
};
VTK_ABI_NAMESPACE_END
#endif
#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: finds the point arrays that describe the particles, and the point arrays
 * to be interpolated. The core's input points to these arrays, and vtkSPHParticles keeps them
 * alive.
 */
#ifndef vtkSPHParticles_h
#define vtkSPHParticles_h

#include "mcor_find.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticlesChoice.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/** What SetInputArrayToProcess requested: the array, or null; and the name, which may be empty. */
struct vtkSPHRequest
{
  vtkSmartPointer<vtkAbstractArray> Array;
  std::string Name;
  bool OnPoints = true;
};

/** A point array to be interpolated, as it was when the run began. */
struct vtkSPHAttribute
{
  vtkSmartPointer<vtkAbstractArray> Array;
  std::string Name;
  int Components;
};

/** What a run needs of the particles, besides the arrays and values that a vtkSPHParticlesChoice names. */
struct vtkSPHWanted
{
  unsigned Wants = MCOR_WANT_SIZES; ///< bits of mcor_want
  vtkSPHRequest Scalar, ScalarDot;
  int ScalarComponent = MCOR_MAGNITUDE;
  std::string Velocity, Weight;   ///< names; if empty, a velocity is found, a weight is not used
  std::vector<std::string> Taken; ///< names of computed arrays
  bool FreeSurface = false, HasIsoValues = false, Filled = false;
};

/** Returns, for each particle, whether the choice's Within and Only keep it. An empty list: all are kept, or an array of Only is missing. */
std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points);

/**
 * Unless the choice names an array as the fluid's, finds the array and the value that mark fluid,
 * and writes them into the choice. If an array seems to mark fluid but is not used, choice.UnusedType
 * says so. If `first` is not null and has no name, it becomes the array to contour. Collective.
 */
void vtkSPHChoose(vtkSPHParticlesChoice& choice, vtkPointSet* points, vtkSPHRequest* first,
  const mcor_ranks* ranks);

/**
 * Lets the core compute, from neighbours, smoothing lengths or densities of the first `count`
 * particles. ratio: the NeighborRatio of smoothing lengths; null: densities. Returns why the core
 * failed; an empty text if it did not fail, or was cancelled.
 */
std::string vtkSPHSumNeighbors(const mcor_input& input, const mcor_options& options,
  const double* ratio, std::int64_t count, double* values);

class vtkSPHParticles
{
public:
  vtkSPHParticles(const vtkSPHParticlesChoice& choice, vtkPointSet* points,
    const vtkSPHWanted& wanted = vtkSPHWanted())
    : Description(choice)
    , Wanted(wanted)
    , Points(points)
  {
  }
  ~vtkSPHParticles() { mcor_free_found(&this->Found); }
  vtkSPHParticles(const vtkSPHParticles&) = delete;
  void operator=(const vtkSPHParticles&) = delete;

  /** Finds the wanted arrays. Returns false if one is missing or not usable; Error says which. */
  bool Collect(const mcor_ranks* ranks = nullptr);

  /**
   * Takes what vtkMarchingCorrectors::FindWidening() has found: factors of the smoothing lengths, and
   * volumes or null. The factors become the core's last attribute, which is not in Interpolated.
   */
  void TakeWidening(vtkDataArray* factors, vtkDataArray* volumes);

  ///@{
  /** Returns the name under which an array of sums over neighbours, or of factors of widening, is
   * sent to other processes. */
  static std::string NameMade(const std::string& name);
  /** Whether NameMade() returned this name. */
  static bool IsMade(const char* name);
  ///@}

  /** Returns a sentence for each array that the core left out of the result. place: the result's name in the sentence. */
  std::vector<std::string> ListLeftOut(
    const std::int64_t* notFinite, const std::string& place) const;

  /** Calls mcor_has_free_surface() for these particles. Call Collect() first. */
  bool HasFreeSurface(const mcor_ranks* ranks) const;

  /** Returns the condition for fluid, such as "ParticleType = 0"; empty if all particles are fluid. */
  std::string DescribeFluid() const;

  /** Returns the array that has this role; null: none has. */
  vtkSmartPointer<vtkAbstractArray> ArrayFor(mcor_role role) const;
  std::string NameFor(mcor_role role) const;

  const vtkSPHParticlesChoice Description;
  const vtkSPHWanted Wanted;
  const vtkSmartPointer<vtkPointSet> Points;
  mcor_found Found = {};
  mcor_input& Core = Found.input;
  std::string Error;
  std::string Unused; ///< a sentence, if a setting has no effect

  std::vector<vtkSPHAttribute> Interpolated;      // in the order of Core.attributes
  std::vector<vtkSPHAttribute> FromNearest;       // arrays of identifiers, integers, strings
  std::vector<std::uint64_t> ParticlesSignature;  // equal signatures: same particles
  std::vector<std::uint64_t> ScalarSignature;     // the same for the core's scalar
  std::vector<std::uint64_t> AttributesSignature; // the same for the interpolated arrays

private:
  /** Returns the options on which sums over neighbours depend. */
  mcor_options OwnOptions() const;
  /** Returns an array of this name, filled by vtkSPHSumNeighbors(). An array that was filled before
   * for the same particles is used again. If the sums fail, returns null and sets Error. */
  vtkSmartPointer<vtkDataArray> SumNeighbors(const char* name, const double* ratio);
  vtkSmartPointer<vtkAbstractArray> ArrayOf(int index) const;
  std::vector<std::uint64_t> Sign() const;

  std::unique_ptr<vtkSPHNamed> Positions, Named; // the point arrays, held while the core reads them
  vtkSmartPointer<vtkDataArray> Made[2];         // arrays copied from Found.made
  vtkSmartPointer<vtkDataArray> Lengths, Densities; // arrays summed over neighbours
  std::vector<mcor_array> Attributes;               // Core.attributes, factors of widening too
};
VTK_ABI_NAMESPACE_END

#endif

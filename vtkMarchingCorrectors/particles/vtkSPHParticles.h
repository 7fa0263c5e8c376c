// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: finds the point arrays that describe the particles, and those to be
 * interpolated, and views them as the core's input. Holds all that it points to.
 */
#ifndef vtkSPHParticles_h
#define vtkSPHParticles_h

#include "mcor.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/**
 * A point array asked for by SetInputArrayToProcess: the array if there is one, and the name asked
 * for, empty if none was.
 */
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

/** Marks the particles that the choice leaves; empty: all. An array that is not there leaves all. */
std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points);

class vtkSPHParticles
{
public:
  vtkSPHParticles(const vtkSPHParticlesChoice& choice, vtkPointSet* points);

  /**
   * Fills what describes the particles. False if something is missing or not usable; Error then
   * says what.
   */
  bool CollectParticles();

  ///@{
  /** The name under which what was made of neighbours goes to other processes with the particles, so
   * that no array of theirs has it; whether this is one. */
  static std::string NameMade(const std::string& name);
  static bool IsMade(const char* name);
  ///@}

  /** The part of it that is about smoothing lengths. */
  bool CollectSmoothingLength();

  /** As mcor_find_dimension(), of all particles if nothing marks the fluid. */
  int FindDimension(const mcor_ranks* ranks, int dimension);

  /**
   * Lists the arrays to interpolate: all but those excluded and those whose names are taken by what
   * is computed.
   */
  void CollectAttributes(const std::vector<std::string>& taken);

  /**
   * Makes the array asked for the only one of the core's attributes, whatever its type. False if it
   * is not usable; Error then says why, and what it was for.
   */
  bool CollectArray(const vtkSPHRequest& request, const std::string& role = "derivatives");

  /**
   * CollectParticles(), and what a projection sees: the scalar, or mass or density where none is
   * asked for, and the weight of a mean, whose name may be empty. False if something is not usable;
   * Error then says what.
   */
  bool CollectProjection(
    const vtkSPHRequest& scalar, int component, const std::string& weight, mcor_array& weightView);

  /**
   * Makes velocity and, where it is known, density the core's attributes, after CollectParticles().
   * The velocity is the array of this name; empty: found by its usual names. The density is an
   * array, one value, or mass / volume, if both are given. False if there is no velocity; Error
   * then says so.
   */
  bool CollectFlow(const std::string& velocity);

  /**
   * One sentence for each array that the core left out: notFinite[i] is the particle at which
   * number i of the interpolated ones is not finite, or negative. `place`: what it was left out of.
   */
  std::vector<std::string> ListLeftOut(
    const std::int64_t* notFinite, const std::string& place) const;

  /**
   * The point arrays vx, vy and vz as one vector, "Velocity"; nothing where they are not there, or
   * such an array is.
   */
  vtkSmartPointer<vtkDataArray> JoinVelocity() const;

  /**
   * Where the choice names no fluid array: the array and the value that clearly tell of fluid, if
   * there are such. Those of a block that it names, too.
   */
  static void FindFluid(
    vtkSPHParticlesChoice& choice, vtkPointSet* points, const vtkSPHMergeRanges& merge = nullptr);

  /** "ParticleType = 0"; empty where all particles are fluid. */
  std::string DescribeFluid() const;

  /** Why no particle is fluid: "No particle has ParticleType = 0", "No particle is within ...". */
  std::string DescribeNoFluid() const;

  /**
   * A sentence where no fluid was chosen and yet an array tells kinds of particles apart; else
   * empty. `gather` returns the lists of all processes, this one's among them.
   */
  std::string DescribeUnusedType(const vtkSPHGather& gather);

  const vtkSPHParticlesChoice Description;
  const vtkSmartPointer<vtkPointSet> Points;
  mcor_input Core = {};
  std::string Error;

  vtkSmartPointer<vtkDataArray> SmoothingLength;
  vtkSmartPointer<vtkDataArray> Volume;
  vtkSmartPointer<vtkDataArray> Mass;
  vtkSmartPointer<vtkDataArray> Density;
  vtkSmartPointer<vtkDataArray> Fluid;
  vtkIdType FluidCount = 0;
  bool AllAbsent = false; // see vtkSPHAlgorithm::SetWithin() and AddOnly()

  std::vector<vtkSPHAttribute> Interpolated;      // in the order of Core.attributes
  std::vector<vtkSPHAttribute> FromNearest;       // identifiers, integers, strings
  std::vector<std::uint64_t> ParticlesSignature;  // equal signatures: same particles
  std::vector<std::uint64_t> ScalarSignature;     // the same for the core's scalar, empty if none
  std::vector<std::uint64_t> AttributesSignature; // the same for the interpolated arrays

protected:
  static std::string Quote(const std::string& name);
  static bool Contains(const std::vector<std::string>& names, const std::string& name);

  mcor_array View(vtkDataArray* array);
  /**
   * The array asked for, or one that is made of others in its place: "Velocity" of vx, vy and vz,
   * and, if sums are wanted, "Density". Null, and Error, if there is none.
   */
  vtkSmartPointer<vtkDataArray> Take(
    const std::string& role, const std::string& name, vtkAbstractArray* array, bool sums);
  vtkDataArray* Check(const std::string& role, const std::string& name, vtkAbstractArray* array);

  bool CollectSolids();
  bool CollectVolume();
  void Interpolate(vtkDataArray* array);

private:
  /** Options on which sums over neighbours depend. */
  mcor_options OwnOptions() const;
  /** Fills an array of this name by the core's function, unless there is one of the same particles;
   * null, and Error, where it fails. */
  vtkSmartPointer<vtkDataArray> Compute(const char* name,
    const std::function<int(const mcor_input&, const mcor_options&, double*, mcor_message*)>& call);
  vtkSmartPointer<vtkDataArray> Summed; // density
  std::string AdviseOnLength() const;
  bool IsCarried(vtkAbstractArray* array, const std::vector<std::string>& taken) const;
  std::vector<std::uint64_t> Sign() const;

  /** The point array of that name and one component; null if there is none. Error then says why. */
  vtkDataArray* Find(const std::string& role, const std::string& name);
  bool CollectMass();
  bool CollectDensity(double constant, mcor_array& core);
  bool CollectQuantity(const std::string& role, const std::string& setName, double constant,
    mcor_quantity quantity, vtkSmartPointer<vtkDataArray>& array, mcor_array& core);

  std::vector<vtkSmartPointer<vtkDataArray>> Viewed; // held while the core reads them
  std::deque<std::string> Names;                     // of these, for the core's messages
  std::vector<std::uint8_t> Solid;
  std::vector<mcor_array> Attributes;
};
VTK_ABI_NAMESPACE_END

#endif

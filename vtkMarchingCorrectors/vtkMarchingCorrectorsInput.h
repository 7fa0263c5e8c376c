// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: finds the point arrays that a run needs and views them as the core's
 * input.
 */
#ifndef vtkMarchingCorrectorsInput_h
#define vtkMarchingCorrectorsInput_h

#include "mcor.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkAbstractArray;
class vtkDataArray;
class vtkMarchingCorrectors;
class vtkPointSet;

/**
 * A point array asked for by SetInputArrayToProcess: the array if there is one, and the name asked
 * for, empty if none was.
 */
struct vtkMarchingCorrectorsRequest
{
  vtkAbstractArray* Array = nullptr;
  std::string Name;
  bool OnPoints = true;
};

class vtkMarchingCorrectorsInput
{
public:
  vtkMarchingCorrectorsInput(vtkMarchingCorrectors* filter, vtkPointSet* points);

  /**
   * Fills all members below. False if something is missing or not usable; Error then says what.
   */
  bool Collect(const vtkMarchingCorrectorsRequest& scalar, const vtkMarchingCorrectorsRequest& dot);

  /**
   * An iso value for users who gave none: the middle of the fluid's scalar range. The 2 % lowest
   * and highest values are left out, because single particles of a spray have extreme ones.
   */
  double MiddleOfScalarRange() const;

  mcor_input Core = {};
  std::string Error;

  vtkDataArray* Scalar = nullptr;
  vtkDataArray* ScalarDot = nullptr;
  std::string ScalarName; // as in the output, see vtkMarchingCorrectors::SetComputeScalars
  vtkDataArray* SmoothingLength = nullptr;
  vtkDataArray* Volume = nullptr;
  vtkDataArray* Mass = nullptr;
  vtkDataArray* Density = nullptr;
  vtkDataArray* Fluid = nullptr;
  vtkIdType FluidCount = 0;

  std::vector<vtkDataArray*> Interpolated;       // in the order of Core.attributes
  std::vector<vtkAbstractArray*> FromNearest;    // identifiers, integers, strings
  std::vector<std::uint64_t> ParticlesSignature; // equal signatures: same particles
  std::vector<std::uint64_t> ScalarSignature;    // equal signatures: same scalar

private:
  bool CollectScalar(
    const vtkMarchingCorrectorsRequest& scalar, const vtkMarchingCorrectorsRequest& dot);
  bool CollectSmoothingLength();
  bool CollectVolume();
  bool CollectSolids();
  void CollectAttributes();
  double ScalarOf(vtkIdType particle) const;
  void NameScalar();
  void Sign();

  mcor_array View(vtkDataArray* array);
  vtkDataArray* Check(const std::string& role, const std::string& name, vtkAbstractArray* array);
  vtkDataArray* Find(const std::string& role, const std::string& name);
  vtkDataArray* Detect(const std::vector<std::string>& usualNames);
  bool CollectQuantity(const std::string& role, const std::string& setName, double constant,
    const std::vector<std::string>& usualNames, vtkDataArray*& array, mcor_array& core, int& given);
  bool HasOneComponent(const std::string& role, vtkDataArray* array);
  std::string ListPointArrays() const;

  vtkMarchingCorrectors* Filter;
  vtkPointSet* Points;
  std::vector<vtkSmartPointer<vtkDataArray>> Converted;
  std::vector<std::uint8_t> Solid;
  std::vector<mcor_array> Attributes;
};

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: finds the point arrays that a run needs and views them as the core's
 * input. Holds all that it points to.
 */
#ifndef vtkMarchingCorrectorsInput_h
#define vtkMarchingCorrectorsInput_h

#include "mcor.h"
#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkPointSet.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

/**
 * A point array asked for by SetInputArrayToProcess: the array if there is one, and the name asked
 * for, empty if none was.
 */
struct vtkMarchingCorrectorsRequest
{
  vtkSmartPointer<vtkAbstractArray> Array;
  std::string Name;
  bool OnPoints = true;
};

/**
 * What the user chose about the particles, copied: an observer may change the filter while it runs.
 */
struct vtkMarchingCorrectorsChoice
{
  vtkMarchingCorrectorsRequest Scalar;
  vtkMarchingCorrectorsRequest ScalarDot;
  int ScalarComponent = MCOR_MAGNITUDE;
  bool FreeSurface = false;
  std::string SmoothingLengthArrayName;
  double SmoothingLength = 0.0;
  bool EstimateSmoothingLength = false;
  bool SmoothingLengthIsSupportRadius = false;
  std::string VolumeArrayName;
  std::string MassArrayName;
  std::string DensityArrayName;
  double Mass = 0.0;
  double Density = 0.0;
  bool DetectArrays = true;
  std::string FluidArrayName;
  double FluidValue = 0.0;
  bool IgnoreSolids = false;
  int Kernel = MCOR_CUBIC_SPLINE;
  bool InterpolateAttributes = true;
  std::vector<std::string> ExcludedArrays;
  std::vector<std::string> ComputedArrays; // names that are taken in the output
  bool ComputeScalars = true;
};

/**
 * A point array to be carried to the surface, as it was when the run began.
 */
struct vtkMarchingCorrectorsAttribute
{
  vtkSmartPointer<vtkAbstractArray> Array;
  std::string Name;
  int Components;
};

class vtkMarchingCorrectorsInput
{
public:
  vtkMarchingCorrectorsInput(const vtkMarchingCorrectorsChoice& choice, vtkPointSet* points);

  /**
   * Fills all members below. False if something is missing or not usable; Error then says what.
   */
  bool Collect();

  const vtkMarchingCorrectorsChoice Choice;
  mcor_input Core = {};
  std::string Error;

  vtkSmartPointer<vtkDataArray> Scalar;
  vtkSmartPointer<vtkDataArray> ScalarDot;
  std::string ScalarName;   // with the component, or of the dot product
  std::string IsoValueName; // see vtkMarchingCorrectors::SetComputeScalars
  vtkSmartPointer<vtkDataArray> SmoothingLength;
  vtkSmartPointer<vtkDataArray> Volume;
  vtkSmartPointer<vtkDataArray> Mass;
  vtkSmartPointer<vtkDataArray> Density;
  vtkSmartPointer<vtkDataArray> Fluid;
  vtkIdType FluidCount = 0;

  std::vector<vtkMarchingCorrectorsAttribute> Interpolated; // in the order of Core.attributes
  std::vector<vtkMarchingCorrectorsAttribute> FromNearest;  // identifiers, integers, strings
  std::vector<std::uint64_t> ParticlesSignature;            // equal signatures: same particles
  std::vector<std::uint64_t> ScalarSignature;               // equal signatures: same scalar

private:
  bool CollectScalar();
  bool CollectSmoothingLength();
  bool CollectVolume();
  bool CollectSolids();
  void CollectAttributes();
  bool IsCarried(vtkAbstractArray* array) const;
  void NameScalar();
  void Sign();

  mcor_array View(vtkDataArray* array);
  vtkDataArray* Check(const std::string& role, const std::string& name, vtkAbstractArray* array);
  vtkDataArray* Find(const std::string& role, const std::string& name);
  vtkDataArray* Detect(const std::vector<std::string>& usualNames);
  bool CollectQuantity(const std::string& role, const std::string& setName, double constant,
    const std::vector<std::string>& usualNames, vtkSmartPointer<vtkDataArray>& array,
    mcor_array& core, int& given);
  bool HasOneComponent(const std::string& role, vtkDataArray* array);
  std::string ListPointArrays() const;

  vtkSmartPointer<vtkPointSet> Points;
  std::vector<vtkSmartPointer<vtkDataArray>> Viewed; // held while the core reads them
  std::deque<std::string> Names;                     // of these, for the core's messages
  std::vector<std::uint8_t> Solid;
  std::vector<mcor_array> Attributes;
};

#endif

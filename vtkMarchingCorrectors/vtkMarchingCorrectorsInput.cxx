// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsInput.h"

#include "vtkAOSDataArrayTemplate.h"
#include "vtkDataSetAttributes.h"
#include "vtkMarchingCorrectorsValues.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace
{
const std::vector<std::string> SmoothingLengthNames = { "smoothinglength", "smoothinglengths",
  "hsml", "h" };
const std::vector<std::string> VolumeNames = { "volume", "volumes", "particlevolume", "vol" };
const std::vector<std::string> MassNames = { "mass", "masses", "particlemass", "m" };
const std::vector<std::string> DensityNames = { "density", "densities", "particledensity", "rho" };

/** "Smoothing_Length" and "smoothing length" are the same name to us. */
std::string Normalize(const char* name)
{
  std::string result;
  for (; name && *name; ++name)
  {
    if (*name != '_' && *name != '-' && *name != ' ')
    {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(*name)));
    }
  }
  return result;
}

std::string Quote(const std::string& name)
{
  return "'" + name + "'";
}

/** What lists of arrays show in place of an array, as in ParaView's panel, is no name. */
std::string RealName(const std::string& name)
{
  return name == "(automatic)" || name == "(none)" ? std::string() : name;
}

std::string NameOf(vtkAbstractArray* array)
{
  return array->GetName() ? array->GetName() : "";
}

bool IsReal(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

std::uint64_t BitsOf(double value)
{
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof(bits));
  return bits;
}

bool Contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

/** VTK's modification times are unique in a process, so that object and time identify a state. */
void SignObject(std::vector<std::uint64_t>& signature, vtkObject* object)
{
  signature.push_back(static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(object)));
  signature.push_back(object ? object->GetMTime() : 0);
}
}

//------------------------------------------------------------------------------
vtkMarchingCorrectorsInput::vtkMarchingCorrectorsInput(
  const vtkMarchingCorrectorsChoice& choice, vtkPointSet* points)
  : Choice(choice)
  , Points(points)
{
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectorsInput::Collect()
{
  this->Core.count = this->Points->GetNumberOfPoints();
  this->Core.positions = this->View(this->Points->GetPoints()->GetData());
  this->Core.positions.name = nullptr; // VTK's "Points" says no more than "position"
  if ((!this->Choice.FreeSurface && !this->CollectScalar()) || !this->CollectSmoothingLength() ||
    !this->CollectVolume() || !this->CollectSolids())
  {
    return false;
  }
  this->NameScalar();
  this->CollectAttributes();
  this->Sign();
  return true;
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectorsInput::CollectScalar()
{
  const vtkMarchingCorrectorsRequest &scalar = this->Choice.Scalar, &dot = this->Choice.ScalarDot;
  if (scalar.Name.empty() && !scalar.Array)
  {
    this->Error = "No scalar to contour was chosen: choose a point array, or turn the free surface "
                  "on. " +
      this->ListPointArrays();
    return false;
  }
  if (!scalar.OnPoints || !dot.OnPoints)
  {
    this->Error = "The scalar " + Quote(scalar.OnPoints ? dot.Name : scalar.Name) +
      " is not a point array; SPH particles are points. " + this->ListPointArrays();
    return false;
  }
  this->Scalar = this->Check("scalar", scalar.Name, scalar.Array);
  if (!this->Scalar)
  {
    return false;
  }
  const int components = this->Scalar->GetNumberOfComponents();
  const int component = this->Choice.ScalarComponent;
  if (!RealName(dot.Name).empty())
  {
    this->ScalarDot = this->Check("second vector of the dot product", dot.Name, dot.Array);
    if (this->ScalarDot && this->ScalarDot->GetNumberOfComponents() != components)
    {
      this->Error = "The dot product needs two arrays with the same number of components; " +
        Quote(NameOf(this->Scalar)) + " has " + std::to_string(components) + ", " +
        Quote(NameOf(this->ScalarDot)) + " has " +
        std::to_string(this->ScalarDot->GetNumberOfComponents()) + ".";
      return false;
    }
    if (!this->ScalarDot)
    {
      return false;
    }
    this->Core.scalar_dot = this->View(this->ScalarDot);
  }
  else if (components > 1 && component != MCOR_MAGNITUDE &&
    (component < 0 || component >= components))
  {
    this->Error = "The scalar " + Quote(NameOf(this->Scalar)) + " has no component " +
      std::to_string(component) + "; choose 0 to " + std::to_string(components - 1) +
      ", or -1 for the magnitude.";
    return false;
  }
  this->Core.scalar = this->View(this->Scalar);
  this->Core.scalar_component = components > 1 ? component : 0;
  return true;
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectorsInput::CollectSmoothingLength()
{
  this->Core.smoothing_length_is_support_radius =
    this->Choice.SmoothingLengthIsSupportRadius ? 1 : 0;
  this->Core.estimate_smoothing_length = this->Choice.EstimateSmoothingLength ? 1 : 0;
  if (this->Core.estimate_smoothing_length)
  {
    return true;
  }
  int given = 0;
  if (!this->CollectQuantity("smoothing length", this->Choice.SmoothingLengthArrayName,
        this->Choice.SmoothingLength, SmoothingLengthNames, this->SmoothingLength,
        this->Core.smoothing_length, given))
  {
    return false;
  }
  if (!given)
  {
    this->Error = "The particles have no smoothing length: no point array has one of its usual "
                  "names (SmoothingLength, hsml, h, ...). Name the array, give a constant, or ask "
                  "for an estimate. " +
      this->ListPointArrays();
  }
  return given != 0;
}

//------------------------------------------------------------------------------
// An array or constant that was set goes before detection: with a mass set, a volume array that
// happens to be there is not used.
bool vtkMarchingCorrectorsInput::CollectVolume()
{
  const vtkMarchingCorrectorsChoice& f = this->Choice;
  const std::vector<std::string> none;
  const bool massOrDensitySet = !RealName(f.MassArrayName).empty() ||
    !RealName(f.DensityArrayName).empty() || f.Mass != 0.0 || f.Density != 0.0;
  if (!this->CollectQuantity("volume", f.VolumeArrayName, 0.0,
        massOrDensitySet ? none : VolumeNames, this->Volume, this->Core.volume,
        this->Core.has_volume))
  {
    return false;
  }
  if (this->Core.has_volume)
  {
    return true;
  }
  if (!this->CollectQuantity("mass", f.MassArrayName, f.Mass, MassNames, this->Mass,
        this->Core.mass, this->Core.has_mass) ||
    !this->CollectQuantity("density", f.DensityArrayName, f.Density, DensityNames, this->Density,
      this->Core.density, this->Core.has_density))
  {
    return false;
  }
  if (!this->Core.has_mass)
  {
    // A density alone says nothing of volumes, and is not to be reported as used.
    this->Density = nullptr;
    this->Core.density = {};
    this->Core.has_density = 0;
  }
  return true;
}

//------------------------------------------------------------------------------
// A constant goes before a name, a name before the usual names. `given` stays 0 if there is
// nothing.
bool vtkMarchingCorrectorsInput::CollectQuantity(const std::string& role,
  const std::string& setName, double constant, const std::vector<std::string>& usualNames,
  vtkSmartPointer<vtkDataArray>& array, mcor_array& core, int& given)
{
  const std::string name = RealName(setName);
  if (constant != 0.0)
  {
    core.constant = constant;
    given = 1;
    return true;
  }
  if (!name.empty())
  {
    array = this->Find(role, name);
    if (!array)
    {
      return false;
    }
    if (!this->HasOneComponent(role, array))
    {
      return false;
    }
  }
  else if (this->Choice.DetectArrays)
  {
    array = this->Detect(usualNames);
  }
  if (array)
  {
    core = this->View(array);
    given = 1;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectorsInput::CollectSolids()
{
  this->FluidCount = static_cast<vtkIdType>(this->Core.count);
  this->Core.ignore_solids = this->Choice.IgnoreSolids ? 1 : 0;
  const std::string name = RealName(this->Choice.FluidArrayName);
  if (name.empty())
  {
    return true;
  }
  this->Fluid = this->Find("fluid", name);
  if (!this->Fluid || !this->HasOneComponent("fluid", this->Fluid))
  {
    return false;
  }
  this->Solid.resize(static_cast<size_t>(this->Core.count));
  this->FluidCount =
    vtkMarchingCorrectorsMarkSolids(this->Fluid, this->Choice.FluidValue, this->Solid.data());
  this->Core.solid = this->Solid.data();
  return true;
}

//------------------------------------------------------------------------------
// The iso value leaves their names to computed arrays, which users look for by name.
void vtkMarchingCorrectorsInput::NameScalar()
{
  this->IsoValueName = "IsoValue";
  if (this->Choice.FreeSurface)
  {
    return;
  }
  const int component = this->Core.scalar_component;
  this->ScalarName = NameOf(this->Scalar);
  if (this->ScalarDot)
  {
    this->ScalarName += "_Dot_" + NameOf(this->ScalarDot);
  }
  else if (this->Scalar->GetNumberOfComponents() > 1)
  {
    const char* label = component >= 0 ? this->Scalar->GetComponentName(component) : "Magnitude";
    this->ScalarName += "_" + (label ? std::string(label) : std::to_string(component));
  }
  if (!this->ScalarName.empty() && !Contains(this->Choice.ComputedArrays, this->ScalarName))
  {
    this->IsoValueName = this->ScalarName;
  }
}

//------------------------------------------------------------------------------
// Computed arrays and the iso value go before arrays of the same name. Ghost marks would hide
// triangles.
bool vtkMarchingCorrectorsInput::IsCarried(vtkAbstractArray* array) const
{
  const std::string name = NameOf(array);
  const bool replaced = Contains(this->Choice.ComputedArrays, name) ||
    (this->Choice.ComputeScalars && name == this->IsoValueName);
  return !name.empty() && !replaced && name != vtkDataSetAttributes::GhostArrayName() &&
    !Contains(this->Choice.ExcludedArrays, name) && array->GetNumberOfTuples() == this->Core.count;
}

//------------------------------------------------------------------------------
void vtkMarchingCorrectorsInput::CollectAttributes()
{
  vtkPointData* pointData = this->Points->GetPointData();
  const int count = this->Choice.InterpolateAttributes ? pointData->GetNumberOfArrays() : 0;
  for (int i = 0; i < count; ++i)
  {
    vtkAbstractArray* array = pointData->GetAbstractArray(i);
    if (!this->IsCarried(array))
    {
      continue;
    }
    const vtkMarchingCorrectorsAttribute attribute = { array, NameOf(array),
      array->GetNumberOfComponents() };
    vtkDataArray* numbers = vtkArrayDownCast<vtkDataArray>(array);
    if (numbers && IsReal(numbers))
    {
      this->Interpolated.push_back(attribute);
      this->Attributes.push_back(this->View(numbers));
    }
    else
    {
      this->FromNearest.push_back(attribute);
    }
  }
  this->Core.attributes = this->Attributes.data();
  this->Core.attribute_count = static_cast<int>(this->Attributes.size());
}

//------------------------------------------------------------------------------
// The data set's own time is part of both: users change arrays in place and tell the data set.
void vtkMarchingCorrectorsInput::Sign()
{
  std::vector<std::uint64_t>& particles = this->ParticlesSignature;
  SignObject(particles, this->Points);
  SignObject(particles, this->Points->GetPoints()->GetData());
  SignObject(particles, this->SmoothingLength);
  SignObject(particles, this->Volume);
  SignObject(particles, this->Mass);
  SignObject(particles, this->Density);
  SignObject(particles, this->Fluid);
  particles.push_back(BitsOf(this->Choice.FluidValue));
  particles.push_back(BitsOf(this->Core.smoothing_length.constant));
  particles.push_back(BitsOf(this->Core.mass.constant));
  particles.push_back(BitsOf(this->Core.density.constant));
  for (const int flag : { this->Core.smoothing_length_is_support_radius,
         this->Core.estimate_smoothing_length, this->Core.ignore_solids, this->Core.has_volume,
         this->Core.has_mass, this->Core.has_density, this->Choice.Kernel })
  {
    particles.push_back(static_cast<std::uint64_t>(flag));
  }
  SignObject(this->ScalarSignature, this->Scalar);
  SignObject(this->ScalarSignature, this->ScalarDot);
  this->ScalarSignature.push_back(static_cast<std::uint64_t>(this->Core.scalar_component));
}

//------------------------------------------------------------------------------
// float and double arrays are used where they lie, all others as a copy in double.
mcor_array vtkMarchingCorrectorsInput::View(vtkDataArray* array)
{
  mcor_array view = {};
  this->Names.push_back(NameOf(array));
  view.name = array->GetName() ? this->Names.back().c_str() : nullptr;
  view.components = array->GetNumberOfComponents();
  if (auto* floats = vtkAOSDataArrayTemplate<float>::FastDownCast(array))
  {
    view.type = MCOR_FLOAT32;
    view.data = floats->GetPointer(0);
    this->Viewed.push_back(array);
    return view;
  }
  vtkSmartPointer<vtkDataArray> doubles = array;
  if (!vtkAOSDataArrayTemplate<double>::FastDownCast(array))
  {
    doubles = vtkMarchingCorrectorsCopyAsDouble(array);
  }
  view.type = MCOR_FLOAT64;
  view.data = doubles->GetVoidPointer(0);
  this->Viewed.push_back(doubles);
  return view;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkMarchingCorrectorsInput::Find(const std::string& role, const std::string& name)
{
  return this->Check(role, name, this->Points->GetPointData()->GetAbstractArray(name.c_str()));
}

//------------------------------------------------------------------------------
vtkDataArray* vtkMarchingCorrectorsInput::Check(
  const std::string& role, const std::string& name, vtkAbstractArray* array)
{
  if (!array)
  {
    this->Error = "There is no point array " + Quote(name) + " for the " + role + ". " +
      this->ListPointArrays();
    return nullptr;
  }
  vtkDataArray* numbers = vtkArrayDownCast<vtkDataArray>(array);
  if (!numbers)
  {
    this->Error = "The " + role + " array " + Quote(NameOf(array)) + " does not hold numbers.";
    return nullptr;
  }
  if (numbers->GetNumberOfTuples() != this->Core.count || numbers->GetNumberOfComponents() < 1)
  {
    this->Error = "The " + role + " array " + Quote(NameOf(array)) + " has " +
      std::to_string(numbers->GetNumberOfTuples()) + " values for " +
      std::to_string(this->Core.count) + " points.";
    return nullptr;
  }
  return numbers;
}

//------------------------------------------------------------------------------
bool vtkMarchingCorrectorsInput::HasOneComponent(const std::string& role, vtkDataArray* array)
{
  const int components = array->GetNumberOfComponents();
  if (components != 1)
  {
    this->Error = "The " + role + " array " + Quote(NameOf(array)) + " has " +
      std::to_string(components) + " components; it must have one.";
  }
  return components == 1;
}

//------------------------------------------------------------------------------
vtkDataArray* vtkMarchingCorrectorsInput::Detect(const std::vector<std::string>& usualNames)
{
  vtkPointData* pointData = this->Points->GetPointData();
  for (const std::string& usual : usualNames)
  {
    for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
    {
      vtkDataArray* array = pointData->GetArray(i);
      if (array && array->GetNumberOfComponents() == 1 &&
        array->GetNumberOfTuples() == this->Core.count && Normalize(array->GetName()) == usual)
      {
        return array;
      }
    }
  }
  return nullptr;
}

//------------------------------------------------------------------------------
std::string vtkMarchingCorrectorsInput::ListPointArrays() const
{
  vtkPointData* pointData = this->Points->GetPointData();
  std::string list;
  for (int i = 0; i < pointData->GetNumberOfArrays(); ++i)
  {
    list += (i ? ", " : "") + NameOf(pointData->GetAbstractArray(i));
  }
  return list.empty() ? "The input has no point arrays." : "Point arrays: " + list + ".";
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHParticles.h"

#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSPHArrays.h"
#include "vtkSPHFound.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <iterator>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** An array without values has no pointer, which to the core would be a constant. */
const void* OrEmpty(const void* values)
{
  static const double none = 0.0;
  return values ? values : &none;
}

const char* const MadeName = "vtkSPHMade:";
}

std::string vtkSPHParticles::Quote(const std::string& name)
{
  return "'" + name + "'";
}

bool vtkSPHParticles::Contains(const std::vector<std::string>& names, const std::string& name)
{
  return std::find(names.begin(), names.end(), name) != names.end();
}

vtkSPHParticles::vtkSPHParticles(const vtkSPHParticlesChoice& choice, vtkPointSet* points)
  : Description(choice)
  , Points(points)
{
  this->Core.count = this->Points->GetNumberOfPoints();
}

bool vtkSPHParticles::CollectParticles()
{
  this->Core.positions = this->View(this->Points->GetPoints()->GetData());
  this->Core.positions.name = nullptr; // VTK's "Points" says no more than "position"
  if (!this->CollectSmoothingLength() || !this->CollectVolume() || !this->CollectSolids())
  {
    return false;
  }
  this->ParticlesSignature = this->Sign();
  return true;
}

int vtkSPHParticles::FindDimension(const mcor_ranks* ranks, int dimension)
{
  this->Core.positions = this->View(this->Points->GetPoints()->GetData());
  this->CollectSolids();
  return mcor_find_dimension(&this->Core, ranks, dimension);
}

bool vtkSPHParticles::CollectSmoothingLength()
{
  const vtkSPHParticlesChoice& f = this->Description;
  this->Core.smoothing_length_is_support_radius = f.SmoothingLengthIsSupportRadius ? 1 : 0;
  this->Core.estimate_smoothing_length = f.EstimateSmoothingLength ? 1 : 0;
  if (f.EstimateSmoothingLength && f.SmoothingLengthEstimate == vtkSPHAlgorithm::ESTIMATE_NEIGHBORS)
  {
    if (!this->SmoothingLength) // not from Take()
    {
      this->SmoothingLength = this->Compute("SmoothingLength",
        [this, &f](const mcor_input& all, const mcor_options& options, double* values, mcor_message* why)
        {
          return mcor_find_smoothing_lengths(
            &all, &options, f.NeighborRatio, this->Core.count, values, why);
        });
    }
    this->Core.estimate_smoothing_length = this->Core.smoothing_length_is_support_radius = 0;
    this->Core.smoothing_length =
      this->SmoothingLength ? this->View(this->SmoothingLength) : mcor_array();
    return this->Error.empty();
  }
  if (f.EstimateSmoothingLength)
  {
    return true;
  }
  if (!this->CollectQuantity("smoothing length", f.SmoothingLengthArrayName, f.SmoothingLength,
        MCOR_SMOOTHING_LENGTH, this->SmoothingLength, this->Core.smoothing_length))
  {
    return false;
  }
  if (!mcor_is_given(&this->Core.smoothing_length))
  {
    this->Error =
      "The particles have no smoothing length. Turn Estimate Smoothing Length on, or choose "
      "Smoothing Length Array; no point array has one of its usual names "
      "(SmoothingLength, hsml, h, ...). " +
      this->AdviseOnLength() + vtkSPHListNames(this->Points);
  }
  return this->Error.empty();
}

// Tells of the solver whose names the arrays have, and of one array with the distance of all.
std::string vtkSPHParticles::AdviseOnLength() const
{
  std::ostringstream text;
  std::string names;
  for (int i = 0; i < this->Points->GetPointData()->GetNumberOfArrays(); ++i)
  {
    names += vtkSPHNameOf(this->Points->GetPointData()->GetAbstractArray(i)) + "\n";
  }
  if (std::strcmp(mcor_find_layout(names.c_str()), "DualSPHysics") == 0)
  {
    text << "DualSPHysics does not store it: it is coefh x sqrt(3) x dp. ";
  }
  vtkDataArray* spacing = vtkSPHDetect(this->Points, MCOR_SPACING, 1);
  double range[2] = { 0.0, -1.0 };
  if (spacing && this->Core.count > 0)
  {
    spacing->GetRange(range, 0);
  }
  if (range[0] == range[1] && range[0] > 0.0)
  {
    text << "By " << Quote(vtkSPHNameOf(spacing)) << ", particles are " << range[0]
         << " apart: " << 1.3 * range[0] << " is usual. ";
  }
  return text.str();
}

mcor_options vtkSPHParticles::OwnOptions() const
{
  const vtkSPHParticlesChoice& f = this->Description;
  mcor_options options;
  mcor_set_default_options(&options);
  options.sph_kernel = static_cast<mcor_sph_kernel>(f.Kernel);
  options.dimension = f.Dimension;
  std::copy(f.PeriodicBounds, f.PeriodicBounds + 6, options.periodic);
  const vtkSPHPeriod found =
    f.DetectPeriod ? vtkSPHFindPeriod(this->Points->GetFieldData()) : vtkSPHPeriod();
  if (!found.Period.empty())
  {
    const std::vector<double> bounds =
      vtkSPHBoundsOfPeriod(found.Period, this->Points->GetBounds());
    std::copy(bounds.begin(), bounds.end(), options.periodic);
  }
  return options;
}

std::string vtkSPHParticles::NameMade(const std::string& name)
{
  return MadeName + name;
}

bool vtkSPHParticles::IsMade(const char* name)
{
  return name && std::strncmp(name, MadeName, std::strlen(MadeName)) == 0;
}

// Neighbours may be other processes' particles: all get all. Particles that were sent have theirs.
vtkSmartPointer<vtkDataArray> vtkSPHParticles::Compute(const char* name,
  const std::function<int(const mcor_input&, const mcor_options&, double*, mcor_message*)>& call)
{
  vtkPointData* arrays = this->Points->GetPointData();
  vtkNew<vtkDoubleArray> array;
  if (vtkDataArray* sent = arrays->GetArray(NameMade(name).c_str()))
  {
    array->ShallowCopy(sent);
    array->SetName(name);
    return array.GetPointer();
  }
  if (!this->CollectSolids())
  {
    return nullptr;
  }
  if (!this->Core.positions.data)
  {
    this->Core.positions = this->View(this->Points->GetPoints()->GetData());
    this->Core.positions.name = nullptr;
  }
  mcor_options options = this->OwnOptions();
  mcor_input all = this->Core;
  std::vector<double> positions, masses;
  std::vector<std::uint8_t> solid;
  if (this->Description.Gather)
  {
    const double* p = options.periodic;
    std::vector<double> mine = { p[1] - p[0], p[3] - p[2], p[5] - p[4] };
    for (vtkIdType i = 0; i < this->Core.count; ++i)
    {
      double x[3];
      this->Points->GetPoint(i, x);
      mine.insert(mine.end(), x, x + 3);
      mine.push_back(this->Mass ? this->Mass->GetComponent(i, 0) : 0.0);
      mine.push_back(this->Core.solid ? this->Core.solid[i] : 0);
    }
    std::vector<std::vector<double>> ranks = this->Description.Gather(mine);
    ranks.insert(ranks.begin(), std::move(mine)); // one's own first
    for (const std::vector<double>& rank : ranks)
    {
      for (size_t a = 0; a < 3; ++a) // one rank may have the field data that tell of it
      {
        options.periodic[2 * a + 1] =
          std::max(options.periodic[2 * a + 1], options.periodic[2 * a] + rank[a]);
      }
      for (size_t i = 3; i + 4 < rank.size(); i += 5)
      {
        positions.insert(positions.end(), &rank[i], &rank[i] + 3);
        masses.push_back(rank[i + 3]);
        solid.push_back(static_cast<std::uint8_t>(rank[i + 4]));
      }
    }
    all.count = static_cast<int64_t>(masses.size());
    all.positions = { OrEmpty(positions.data()), MCOR_FLOAT64, 3, 0.0, nullptr };
    all.mass =
      this->Mass ? mcor_array{ OrEmpty(masses.data()), MCOR_FLOAT64, 1, 0.0, nullptr } : all.mass;
    all.solid = solid.empty() ? nullptr : solid.data();
  }
  std::vector<std::uint64_t> signature = this->Sign();
  for (const double number : { this->Description.NeighborRatio, 1.0 * options.dimension,
         options.periodic[0], options.periodic[1], options.periodic[2], options.periodic[3],
         options.periodic[4], options.periodic[5] })
  {
    vtkSPHSign(signature, number);
  }
  auto& made = (*this->Description.Made)[name];
  if (made.first == signature && !this->Description.Gather)
  {
    return made.second;
  }
  array->SetName(name);
  array->SetNumberOfValues(this->Points->GetNumberOfPoints());
  mcor_message why;
  if (call(all, options, array->GetPointer(0), &why) != MCOR_OK)
  {
    this->Error = vtkSPHTakeText(why);
    return nullptr;
  }
  made = { signature, array.GetPointer() };
  if (this->Description.Gather)
  {
    vtkNew<vtkDoubleArray> sent;
    sent->ShallowCopy(array);
    sent->SetName(NameMade(name).c_str());
    arrays->AddArray(sent);
  }
  return made.second;
}

// An array or constant that was set goes before detection: with a mass set, a volume array that
// happens to be there is not used.
bool vtkSPHParticles::CollectVolume()
{
  const vtkSPHParticlesChoice& f = this->Description;
  const bool massOrDensitySet = !vtkSPHRealName(f.MassArrayName).empty() ||
    !vtkSPHRealName(f.DensityArrayName).empty() || f.Mass != 0.0 || f.Density != 0.0;
  if (!this->CollectQuantity("volume", f.VolumeArrayName, 0.0,
        massOrDensitySet ? MCOR_QUANTITY_COUNT : MCOR_VOLUME, this->Volume, this->Core.volume))
  {
    return false;
  }
  if (mcor_is_given(&this->Core.volume))
  {
    return true;
  }
  if (!this->CollectMass() || !this->CollectDensity(f.Density, this->Core.density))
  {
    return false;
  }
  if (this->Summed && !mcor_is_given(&this->Core.density))
  {
    this->Density = this->Summed;
    this->Core.density = this->View(this->Summed);
  }
  if (!mcor_is_given(&this->Core.mass))
  {
    // A density alone says nothing of volumes, and is not to be reported as used.
    this->Density = nullptr;
    this->Core.density = {};
  }
  if (f.ParticleVolume > 0.0 &&
    !(mcor_is_given(&this->Core.mass) && mcor_is_given(&this->Core.density)))
  {
    this->Core.volume.constant = f.ParticleVolume;
    this->Mass = this->Density = nullptr;
    this->Core.mass = this->Core.density = {};
  }
  return true;
}

bool vtkSPHParticles::CollectMass()
{
  return this->CollectQuantity("mass", this->Description.MassArrayName, this->Description.Mass,
    MCOR_MASS, this->Mass, this->Core.mass);
}

bool vtkSPHParticles::CollectDensity(double constant, mcor_array& core)
{
  return this->CollectQuantity(
    "density", this->Description.DensityArrayName, constant, MCOR_DENSITY, this->Density, core);
}

// A constant goes before a name, a name before the usual names.
// `core` stays empty if there is nothing.
bool vtkSPHParticles::CollectQuantity(const std::string& role, const std::string& setName,
  double constant, mcor_quantity quantity, vtkSmartPointer<vtkDataArray>& array, mcor_array& core)
{
  const std::string name = vtkSPHRealName(setName);
  if (constant != 0.0)
  {
    core.constant = constant;
    return true;
  }
  if (!name.empty() || this->Description.DetectArrays)
  {
    array = name.empty() ? vtkSPHDetect(this->Points, quantity, 1) : this->Find(role, name);
  }
  core = array ? this->View(array) : core;
  return name.empty() || array;
}

// Ghost marks would hide triangles.
bool vtkSPHParticles::IsCarried(
  vtkAbstractArray* array, const std::vector<std::string>& taken) const
{
  const std::string name = vtkSPHNameOf(array);
  return !name.empty() && !Contains(taken, name) &&
    name != vtkDataSetAttributes::GhostArrayName() && name != MCOR_WALL_BLOCK &&
    !IsMade(name.c_str()) && !Contains(this->Description.ExcludedArrays, name) &&
    array->GetNumberOfTuples() == this->Core.count;
}

void vtkSPHParticles::CollectAttributes(const std::vector<std::string>& taken)
{
  vtkPointData* pointData = this->Points->GetPointData();
  const int count = pointData->GetNumberOfArrays();
  for (int i = 0; i < count; ++i)
  {
    vtkAbstractArray* array = pointData->GetAbstractArray(i);
    if (!this->IsCarried(array, taken))
    {
      continue;
    }
    vtkDataArray* numbers = vtkArrayDownCast<vtkDataArray>(array);
    if (numbers && vtkSPHIsReal(numbers))
    {
      this->Interpolate(numbers);
    }
    else
    {
      this->FromNearest.push_back({ array, vtkSPHNameOf(array), array->GetNumberOfComponents() });
    }
  }
  const vtkSmartPointer<vtkDataArray> velocity = this->JoinVelocity();
  if (velocity && this->IsCarried(velocity, taken))
  {
    this->Interpolate(velocity);
  }
}

void vtkSPHParticles::Interpolate(vtkDataArray* array)
{
  this->Interpolated.push_back({ array, vtkSPHNameOf(array), array->GetNumberOfComponents() });
  vtkSPHSign(this->AttributesSignature, array);
  this->Attributes.push_back(this->View(array));
  this->Core.attributes = this->Attributes.data();
  this->Core.attribute_count = static_cast<int>(this->Attributes.size());
}

bool vtkSPHParticles::CollectArray(const vtkSPHRequest& request, const std::string& role)
{
  if (vtkSPHRealName(request.Name).empty() && !request.Array)
  {
    this->Error = "No array was chosen: choose a point array. " + vtkSPHListNames(this->Points);
    return false;
  }
  if (!request.OnPoints)
  {
    this->Error = "The array " + Quote(request.Name) +
      " is not a point array; SPH particles are points. " + vtkSPHListNames(this->Points);
    return false;
  }
  const vtkSmartPointer<vtkDataArray> array =
    this->Take(role, request.Name, request.Array, role == "projection");
  if (array)
  {
    this->Interpolate(array);
  }
  return array != nullptr;
}

bool vtkSPHParticles::CollectFlow(const std::string& velocityName)
{
  const std::string name = vtkSPHRealName(velocityName);
  vtkSmartPointer<vtkDataArray> velocity;
  if (name.empty())
  {
    const vtkSmartPointer<vtkDataArray> joined = this->JoinVelocity();
    vtkDataArray* inSpace = vtkSPHDetect(this->Points, MCOR_VELOCITY, 3);
    velocity = inSpace ? inSpace
      : joined         ? joined.Get()
                       : vtkSPHDetect(this->Points, MCOR_VELOCITY, 2);
  }
  else
  {
    velocity = this->Take(
      "velocity", name, this->Points->GetPointData()->GetAbstractArray(name.c_str()), false);
  }
  if (!velocity)
  {
    this->Error = !this->Error.empty()
      ? this->Error
      : "The particles have no velocity: no point array has one of its usual names (Velocity, vel, "
        "v, ...). Choose Velocity Array. " +
        vtkSPHListNames(this->Points);
    return false;
  }
  this->Interpolate(velocity);
  mcor_array density = this->Core.density;
  if (!this->Density && this->Description.Density == 0.0 && !this->CollectDensity(0.0, density))
  {
    return false;
  }
  if (this->Density)
  {
    this->Interpolate(this->Density);
  }
  else if (this->Description.Density != 0.0)
  {
    density.constant = this->Description.Density;
    this->Attributes.push_back(density);
  }
  else if (mcor_is_given(&this->Core.volume) && this->CollectMass() &&
    mcor_is_given(&this->Core.mass))
  {
    vtkNew<vtkDoubleArray> divided;
    divided->SetName("Density");
    divided->SetNumberOfValues(this->Points->GetNumberOfPoints());
    for (vtkIdType i = 0; i < divided->GetNumberOfValues(); ++i)
    {
      const double mass = this->Mass ? this->Mass->GetComponent(i, 0) : this->Core.mass.constant;
      divided->SetValue(
        i, mass / (this->Volume ? this->Volume->GetComponent(i, 0) : this->Core.volume.constant));
    }
    this->Interpolate(divided);
  }
  this->Core.attributes = this->Attributes.data();
  this->Core.attribute_count = static_cast<int>(this->Attributes.size());
  return this->Error.empty();
}

bool vtkSPHParticles::CollectProjection(
  const vtkSPHRequest& scalar, int component, const std::string& weight, mcor_array& weightView)
{
  const bool hasScalar = !vtkSPHRealName(scalar.Name).empty() || scalar.Array;
  if ((hasScalar && !this->CollectArray(scalar, "projection")) || !this->CollectParticles() ||
    (!mcor_is_given(&this->Core.mass) && !this->CollectMass()) ||
    (!mcor_is_given(&this->Core.mass) &&
      !this->CollectDensity(this->Description.Density, this->Core.density)))
  {
    return false;
  }
  if (hasScalar)
  {
    this->Core.scalar = this->Attributes.front();
    const int components = this->Core.scalar.components;
    if (components > 1 && component >= components)
    {
      this->Error = "The scalar " + Quote(this->Interpolated.front().Name) + " has no component " +
        std::to_string(component) + "; choose 0 to " + std::to_string(components - 1) +
        ", or -1 for the magnitude.";
      return false;
    }
    this->Core.scalar_component = components > 1 ? std::max(component, MCOR_MAGNITUDE) : 0;
  }
  weightView = {};
  if (!vtkSPHRealName(weight).empty())
  {
    vtkDataArray* array = this->Find("weight", weight);
    if (!array)
    {
      return false;
    }
    this->Interpolate(array); // for other ranks, too
    weightView = array == this->Mass ? this->Core.mass : this->Attributes.back();
  }
  this->Core.attribute_count = 0;
  return true;
}

// The data set's own time is part of it: users change arrays in place and tell the data set.
std::vector<std::uint64_t> vtkSPHParticles::Sign() const
{
  std::vector<std::uint64_t> particles;
  vtkDataArray* positions = this->Points->GetPoints()->GetData();
  for (vtkObject* object : std::initializer_list<vtkObject*>{ this->Points, positions,
         this->SmoothingLength, this->Volume, this->Mass, this->Density, this->Fluid })
  {
    vtkSPHSign(particles, object);
  }
  const vtkSPHParticlesChoice& f = this->Description;
  std::vector<double> numbers(f.Within, f.Within + 6);
  for (const vtkSPHOnly& only : f.Only)
  {
    vtkSPHSign(particles, this->Points->GetPointData()->GetAbstractArray(only.Name.c_str()));
    numbers.insert(numbers.end(), { only.Low, only.High });
  }
  const mcor_input& c = this->Core;
  numbers.insert(numbers.end(),
    { f.FluidValue, c.smoothing_length.constant, c.mass.constant, c.density.constant,
      1.0 * c.smoothing_length_is_support_radius, 1.0 * c.estimate_smoothing_length,
      1.0 * c.ignore_solids, 1.0 * f.Kernel });
  for (const double number : numbers)
  {
    vtkSPHSign(particles, number);
  }
  return particles;
}

// float and double arrays are used where they lie, all others as a copy in double.
mcor_array vtkSPHParticles::View(vtkDataArray* array)
{
  mcor_array view = {};
  this->Names.push_back(vtkSPHNameOf(array));
  view.name = array->GetName() ? this->Names.back().c_str() : nullptr;
  view.components = array->GetNumberOfComponents();
  const vtkSmartPointer<vtkDataArray> real = vtkSPHAsReal(array);
  view.type = real->GetDataType() == VTK_FLOAT ? MCOR_FLOAT32 : MCOR_FLOAT64;
  view.data = OrEmpty(real->GetVoidPointer(0));
  this->Viewed.push_back(real);
  return view;
}

vtkDataArray* vtkSPHParticles::Find(const std::string& role, const std::string& name)
{
  vtkDataArray* array =
    this->Check(role, name, this->Points->GetPointData()->GetAbstractArray(name.c_str()));
  const int components = array ? array->GetNumberOfComponents() : 1;
  if (components != 1)
  {
    this->Error = "The " + role + " array " + Quote(name) + " has " + std::to_string(components) +
      " components; it must have one.";
    return nullptr;
  }
  return array;
}

vtkSmartPointer<vtkDataArray> vtkSPHParticles::Take(
  const std::string& role, const std::string& name, vtkAbstractArray* array, bool sums)
{
  if (sums && name == "Density" && !array)
  {
    // It gives volumes, too, from then on.
    this->Summed = this->CollectSmoothingLength() && this->CollectVolume()
      ? this->Compute("Density",
          [this](const mcor_input& all, const mcor_options& options, double* values, mcor_message* why)
          { return mcor_sum_densities(&all, &options, this->Core.count, values, why); })
      : nullptr;
    return this->Summed;
  }
  const vtkSmartPointer<vtkDataArray> velocity =
    name == "Velocity" && !array ? this->JoinVelocity() : nullptr;
  return velocity ? velocity : vtkSmartPointer<vtkDataArray>(this->Check(role, name, array));
}

vtkDataArray* vtkSPHParticles::Check(
  const std::string& role, const std::string& name, vtkAbstractArray* array)
{
  if (!array)
  {
    const bool isPlane = name == "Lambda2" && this->Points->GetPointData()->HasArray("Q-criterion");
    this->Error = "There is no point array " + Quote(name) + " for the " + role + ". " +
      (isPlane ? "There is no Lambda2 in two dimensions, because it is the middle one of three "
                 "eigenvalues; use Q-criterion. "
               : "") +
      vtkSPHListNames(this->Points);
    return nullptr;
  }
  vtkDataArray* numbers = vtkArrayDownCast<vtkDataArray>(array);
  if (!numbers)
  {
    this->Error =
      "The " + role + " array " + Quote(vtkSPHNameOf(array)) + " does not hold numbers.";
    return nullptr;
  }
  if (numbers->GetNumberOfTuples() != this->Core.count || numbers->GetNumberOfComponents() < 1)
  {
    this->Error = "The " + role + " array " + Quote(vtkSPHNameOf(array)) + " has " +
      std::to_string(numbers->GetNumberOfTuples()) + " values for " +
      std::to_string(this->Core.count) + " points.";
    return nullptr;
  }
  return numbers;
}

// As float only where all are.
vtkSmartPointer<vtkDataArray> vtkSPHParticles::JoinVelocity() const
{
  vtkPointData* pointData = this->Points->GetPointData();
  vtkDataArray* const parts[] = { pointData->GetArray("vx"), pointData->GetArray("vy"),
    pointData->GetArray("vz") };
  bool isFloat = true;
  for (vtkDataArray* part : parts)
  {
    if (!part || !vtkSPHIsReal(part) || part->GetNumberOfComponents() != 1 ||
      part->GetNumberOfTuples() != this->Core.count)
    {
      return nullptr;
    }
    isFloat = isFloat && part->GetDataType() == VTK_FLOAT;
  }
  if (pointData->HasArray("Velocity"))
  {
    return nullptr;
  }
  vtkSmartPointer<vtkDataArray> joined;
  joined.TakeReference(vtkDataArray::CreateDataArray(isFloat ? VTK_FLOAT : VTK_DOUBLE));
  joined->SetName("Velocity");
  joined->SetNumberOfComponents(3);
  joined->SetNumberOfTuples(this->Core.count);
  for (int component = 0; component < 3; ++component)
  {
    joined->CopyComponent(component, parts[component], 0);
  }
  return joined;
}

std::vector<std::string> vtkSPHParticles::ListLeftOut(
  const std::int64_t* notFinite, const std::string& place) const
{
  std::vector<std::string> sentences;
  for (size_t i = 0; notFinite && i < this->Interpolated.size(); ++i)
  {
    if (notFinite[i] >= 0)
    {
      sentences.push_back("The point array " + Quote(this->Interpolated[i].Name) +
        " is NaN or infinite at particle " + std::to_string(notFinite[i]) +
        " and was left out of " + place + ". Correct its values, or exclude it.");
    }
  }
  return sentences;
}
VTK_ABI_NAMESPACE_END

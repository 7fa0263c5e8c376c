// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHParticles.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
const char* const MadeName = "vtkSPHMade:";

/** Returns a message of the core with its slots filled; empty: there is none. */
std::string Filled(const mcor_message& message)
{
  return vtkSPHTakeText(mcor_fill_slots(message.text, vtkSPHWord, nullptr));
}

vtkSmartPointer<vtkDataArray> CopyOf(const mcor_named& made)
{
  const bool isFloat = made.type == MCOR_ELEMENT_FLOAT32;
  const auto copy = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(isFloat ? VTK_FLOAT : VTK_DOUBLE));
  copy->SetName(made.name);
  copy->SetNumberOfComponents(made.components);
  copy->SetNumberOfTuples(made.tuples);
  std::memcpy(copy->GetVoidPointer(0), made.data,
    static_cast<std::size_t>(copy->GetNumberOfValues()) * copy->GetDataTypeSize());
  return copy;
}

/** Returns the index in `data` of an array that was requested without a name; -1: requested by name, or not in `data`. */
int IndexOf(const vtkSPHRequest& request, vtkPointData* data)
{
  int index = request.Name.empty() && request.Array ? data->GetNumberOfArrays() - 1 : -1;
  while (index >= 0 && data->GetAbstractArray(index) != request.Array)
  {
    --index;
  }
  return index;
}
}

bool vtkSPHParticles::Collect(const mcor_ranks* ranks)
{
  const vtkSPHParticlesChoice& f = this->Description;
  const vtkSPHWanted& wanted = this->Wanted;
  vtkPointData* data = this->Points->GetPointData();
  std::string taken, excluded;
  for (const std::string& name : wanted.Taken)
  {
    taken += name + "\n";
  }
  for (const std::string& name : f.ExcludedArrays)
  {
    excluded += name + "\n";
  }
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    excluded += IsMade(data->GetArrayName(i)) ? std::string(data->GetArrayName(i)) + "\n" : "";
  }
  std::vector<mcor_only> only;
  for (const vtkSPHOnly& each : f.Only)
  {
    only.push_back({ each.Name.c_str(), each.Low, each.High });
  }
  const std::string dot =
    wanted.ScalarDot.Name.empty() ? vtkSPHNameOf(wanted.ScalarDot.Array) : wanted.ScalarDot.Name;
  mcor_request request = {};
  request.wants = wanted.Wants;
  for (const auto& each : { std::make_pair(MCOR_ROLE_SMOOTHING_LENGTH, &f.SmoothingLengthArrayName),
         { MCOR_ROLE_VOLUME, &f.VolumeArrayName }, { MCOR_ROLE_MASS, &f.MassArrayName },
         { MCOR_ROLE_DENSITY, &f.DensityArrayName }, { MCOR_ROLE_FLUID, &f.FluidArrayName },
         { MCOR_ROLE_VELOCITY, &wanted.Velocity }, { MCOR_ROLE_WEIGHT, &wanted.Weight },
         { MCOR_ROLE_SCALAR, &wanted.Scalar.Name }, { MCOR_ROLE_SCALAR_DOT, &dot } })
  {
    request.names[each.first] = each.second->c_str();
  }
  request.values[MCOR_ROLE_SMOOTHING_LENGTH] = f.SmoothingLength;
  request.values[MCOR_ROLE_MASS] = f.Mass;
  request.values[MCOR_ROLE_DENSITY] = f.Density;
  request.find = f.DetectArrays;
  request.compute_volumes = f.ComputeVolumes;
  request.particle_volume = f.ParticleVolume;
  request.estimate_smoothing_length = f.EstimateSmoothingLength;
  request.lengths_by_neighbours =
    f.SmoothingLengthEstimate; // 1: vtkSPHAlgorithm::ESTIMATE_NEIGHBORS
  request.smoothing_length_is_support_radius = f.SmoothingLengthIsSupportRadius;
  request.fluid_value = f.FluidValue;
  request.find_fluid = f.DetectFluid;
  request.ignore_solids = f.IgnoreSolids;
  request.scalar_component = wanted.ScalarComponent;
  request.active = IndexOf(wanted.Scalar, data);
  request.not_on_points = (wanted.Scalar.OnPoints ? 0 : 1 << MCOR_ROLE_SCALAR) |
    (wanted.ScalarDot.OnPoints ? 0 : 1 << MCOR_ROLE_SCALAR_DOT);
  std::copy(f.Within, f.Within + 6, request.within);
  request.only = only.data();
  request.only_count = static_cast<int>(only.size());
  request.taken = taken.c_str();
  request.excluded = excluded.c_str();
  request.free_surface = wanted.FreeSurface;
  request.has_iso_values = wanted.HasIsoValues;
  request.filled = wanted.Filled;
  request.label = wanted.Scalar.Array && wanted.ScalarComponent >= 0
    ? wanted.Scalar.Array->GetComponentName(wanted.ScalarComponent)
    : nullptr;

  this->Named = std::make_unique<vtkSPHNamed>(data);
  mcor_named positions = {};
  positions.components = 3;
  if (vtkPoints* points = this->Points->GetPoints())
  {
    this->Positions = std::make_unique<vtkSPHNamed>(points->GetData());
    positions = this->Positions->List.front();
  }
  mcor_free_found(&this->Found);
  const mcor_status status = mcor_find_input(&request, &positions, this->Named->List.data(),
    static_cast<int>(this->Named->List.size()), ranks, &this->Found);
  for (int k = 0; k < 2; ++k)
  {
    this->Made[k] = this->Found.made[k].name ? CopyOf(this->Found.made[k]) : nullptr;
  }
  this->Error = Filled(this->Found.error);
  if (status != MCOR_OK && this->Error.empty())
  {
    this->Error = mcor_says_text(MCOR_SAYS_HOST_MEMORY);
  }
  this->Unused = Filled(this->Found.unused);
  this->Lengths = this->Densities = nullptr;
  if (this->Error.empty() && this->Found.needs_lengths)
  {
    this->Lengths = this->SumNeighbors("SmoothingLength", &f.NeighborRatio);
    if (this->Lengths)
    {
      mcor_take_lengths(&this->Found, static_cast<const double*>(vtkSPHView(this->Lengths).data));
    }
  }
  if (this->Error.empty() && this->Found.needs_densities)
  {
    this->Densities = this->SumNeighbors("Density", nullptr);
    if (this->Densities)
    {
      mcor_take_densities(
        &this->Found, static_cast<const double*>(vtkSPHView(this->Densities).data));
    }
  }
  if (!this->Error.empty())
  {
    return false;
  }
  this->Interpolated.clear();
  this->FromNearest.clear();
  this->AttributesSignature.clear();
  for (int i = 0; i < this->Core.attribute_count; ++i)
  {
    if (this->Found.attributes[i] >= 0) // the attribute is an array, not a constant
    {
      vtkAbstractArray* array = this->ArrayOf(this->Found.attributes[i]);
      this->Interpolated.push_back({ array, vtkSPHNameOf(array), array->GetNumberOfComponents() });
      vtkSPHSign(this->AttributesSignature, array);
    }
  }
  for (int i = 0; i < this->Found.nearest_count; ++i)
  {
    vtkAbstractArray* array = this->ArrayOf(this->Found.nearest[i]);
    this->FromNearest.push_back({ array, vtkSPHNameOf(array), array->GetNumberOfComponents() });
  }
  this->ParticlesSignature = this->Sign();
  this->ScalarSignature = { static_cast<std::uint64_t>(this->Core.scalar_component) };
  vtkSPHSign(this->ScalarSignature, this->ArrayFor(MCOR_ROLE_SCALAR));
  vtkSPHSign(this->ScalarSignature, this->ArrayFor(MCOR_ROLE_SCALAR_DOT));
  return true;
}

void vtkSPHParticles::TakeWidening(vtkDataArray* factors, vtkDataArray* volumes)
{
  vtkSPHSign(this->ParticlesSignature, factors);
  vtkSPHSign(this->AttributesSignature, factors);
  this->Core.widening = vtkSPHView(factors);
  this->Attributes.assign(
    this->Core.attributes, this->Core.attributes + this->Core.attribute_count);
  this->Attributes.push_back(this->Core.widening);
  this->Core.attributes = this->Attributes.data();
  this->Core.attribute_count = static_cast<int>(this->Attributes.size());
  if (volumes)
  {
    this->Core.volume = vtkSPHView(volumes);
    this->Core.volume.name = nullptr; // then the statistics say that volumes were computed
  }
}

vtkSmartPointer<vtkAbstractArray> vtkSPHParticles::ArrayOf(int index) const
{
  const int count = static_cast<int>(this->Named->List.size());
  return index < 0   ? nullptr
    : index >= count ? this->Made[index - count].Get()
                     : this->Points->GetPointData()->GetAbstractArray(index);
}

vtkSmartPointer<vtkAbstractArray> vtkSPHParticles::ArrayFor(mcor_role role) const
{
  const bool isSummed = this->Densities &&
    (role == MCOR_ROLE_SCALAR ||
      (role == MCOR_ROLE_DENSITY && this->Core.density.data == this->Core.scalar.data));
  return role == MCOR_ROLE_SMOOTHING_LENGTH && this->Lengths ? this->Lengths.Get()
    : isSummed                                               ? this->Densities.Get()
               : this->ArrayOf(this->Found.which[role]);
}

std::string vtkSPHParticles::NameFor(mcor_role role) const
{
  return vtkSPHNameOf(this->ArrayFor(role));
}

mcor_options vtkSPHParticles::OwnOptions() const
{
  const vtkSPHParticlesChoice& f = this->Description;
  mcor_options options;
  mcor_set_default_options(&options);
  options.sph_kernel = static_cast<mcor_sph_kernel>(f.Kernel);
  options.dimension = f.Dimension;
  std::copy(f.PeriodicBounds, f.PeriodicBounds + 6, options.periodic);
  if (f.DetectPeriod)
  {
    const std::vector<double> bounds = vtkSPHBoundsOfPeriod(
      vtkSPHFindPeriod(this->Points->GetFieldData()).Period, this->Points->GetBounds());
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

std::string vtkSPHSumNeighbors(const mcor_input& input, const mcor_options& options,
  const double* ratio, std::int64_t count, double* values)
{
  mcor_message why;
  const mcor_status status = ratio
    ? mcor_find_smoothing_lengths(&input, &options, *ratio, count, values, &why)
    : mcor_sum_densities(&input, &options, count, values, &why);
  const std::string problem = vtkSPHTakeText(why);
  return status == MCOR_CANCELLED ? "" : problem;
}

// Particles from another process come with their sums, in the array NameMade(name).
vtkSmartPointer<vtkDataArray> vtkSPHParticles::SumNeighbors(const char* name, const double* ratio)
{
  vtkPointData* arrays = this->Points->GetPointData();
  vtkNew<vtkDoubleArray> array;
  if (vtkDataArray* sent = arrays->GetArray(NameMade(name).c_str()))
  {
    array->ShallowCopy(sent);
    array->SetName(name);
    return array.GetPointer();
  }
  const mcor_options options = this->OwnOptions();
  std::vector<std::uint64_t> signature = this->Sign();
  for (const double number : { this->Description.NeighborRatio, 1.0 * options.dimension,
         options.periodic[0], options.periodic[1], options.periodic[2], options.periodic[3],
         options.periodic[4], options.periodic[5] })
  {
    vtkSPHSign(signature, number);
  }
  auto& made = (*this->Description.Made)[name];
  const vtkSPHSumShared& share = this->Description.SumShared;
  if (made.first == signature && !share)
  {
    return made.second;
  }
  mcor_input input = this->Core;
  input.mass = this->Found.views[MCOR_ROLE_MASS];
  array->SetName(name);
  array->SetNumberOfValues(this->Points->GetNumberOfPoints());
  double* values = array->GetPointer(0);
  this->Error = share ? share(this->Points, input, options, ratio, values)
                      : vtkSPHSumNeighbors(input, options, ratio, input.count, values);
  if (!this->Error.empty())
  {
    return nullptr;
  }
  made = { signature, array.GetPointer() };
  if (share)
  {
    vtkNew<vtkDoubleArray> sent;
    sent->ShallowCopy(array);
    sent->SetName(NameMade(name).c_str());
    arrays->AddArray(sent);
  }
  return made.second;
}

// A density array may tell of a liquid even if the core does not compute volumes from it.
bool vtkSPHParticles::HasFreeSurface(const mcor_ranks* ranks) const
{
  mcor_input core = {};
  if (this->Error.empty())
  {
    core = this->Core;
    core.density = this->Found.views[MCOR_ROLE_DENSITY];
  }
  return mcor_has_free_surface(&core, ranks) != 0;
}

// The data set's time counts, too, because users change arrays and call only the set's Modified().
std::vector<std::uint64_t> vtkSPHParticles::Sign() const
{
  std::vector<std::uint64_t> particles;
  vtkSPHSign(particles, this->Points);
  vtkSPHSign(particles, this->Points->GetPoints() ? this->Points->GetPoints()->GetData() : nullptr);
  for (const mcor_role role : { MCOR_ROLE_SMOOTHING_LENGTH, MCOR_ROLE_VOLUME, MCOR_ROLE_MASS,
         MCOR_ROLE_DENSITY, MCOR_ROLE_FLUID })
  {
    vtkSPHSign(particles, this->ArrayFor(role));
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
    { this->Found.fluid_value, c.smoothing_length.constant, c.volume.constant, c.mass.constant,
      c.density.constant, 1.0 * c.smoothing_length_is_support_radius,
      1.0 * c.estimate_smoothing_length, 1.0 * c.ignore_solids, 1.0 * f.Kernel });
  for (const double number : numbers)
  {
    vtkSPHSign(particles, number);
  }
  return particles;
}

void vtkSPHChoose(
  vtkSPHParticlesChoice& choice, vtkPointSet* points, vtkSPHRequest* first, const mcor_ranks* ranks)
{
  vtkSPHWanted wanted;
  wanted.Wants = first ? MCOR_WANT_FLUID | MCOR_WANT_ARRAY : MCOR_WANT_FLUID;
  wanted.Scalar = first ? *first : vtkSPHRequest();
  vtkSPHParticles found(choice, points, wanted);
  found.Collect(ranks);
  if (vtkSPHRealName(choice.FluidArrayName).empty() || choice.IsBlock())
  {
    const std::string name = found.NameFor(MCOR_ROLE_FLUID);
    choice.FluidArrayName = name.empty() ? choice.FluidArrayName : name;
    choice.FluidValue = name.empty() ? choice.FluidValue : found.Found.fluid_value;
  }
  choice.UnusedType = Filled(found.Found.unused_type);
  if (first && vtkSPHRealName(first->Name).empty())
  {
    first->Array = found.ArrayFor(MCOR_ROLE_SCALAR);
    first->Name = vtkSPHNameOf(first->Array);
  }
}

vtkSPHFound vtkSPHFindArrays(vtkPointSet* particles)
{
  vtkSPHParticlesChoice choice;
  choice.DetectFluid = 1;
  vtkSPHWanted wanted;
  wanted.Wants |= MCOR_WANT_LIST | MCOR_WANT_FLUID;
  vtkSPHParticles list(choice, particles, wanted);
  list.Collect();
  vtkSPHFound found;
  found.SmoothingLength = list.NameFor(MCOR_ROLE_SMOOTHING_LENGTH);
  found.Volume = list.NameFor(MCOR_ROLE_VOLUME);
  found.Mass = list.NameFor(MCOR_ROLE_MASS);
  found.Density = list.NameFor(MCOR_ROLE_DENSITY);
  found.Velocity = list.NameFor(MCOR_ROLE_VELOCITY);
  if (found.Velocity == "Velocity" && !particles->GetPointData()->HasArray("Velocity"))
  {
    found.Velocity = "vx, vy, vz as Velocity";
  }
  found.Fluid = list.NameFor(MCOR_ROLE_FLUID);
  found.FluidValue = list.Found.fluid_value;
  return found;
}

std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points)
{
  vtkSPHParticlesChoice bare = choice;
  bare.FluidArrayName.clear();
  vtkSPHWanted wanted;
  wanted.Wants = 0;
  vtkSPHParticles particles(bare, points, wanted);
  particles.Collect();
  const std::uint8_t* marks = particles.Core.solid;
  std::vector<bool> present(marks ? particles.Core.count : 0);
  std::transform(marks, marks + present.size(), present.begin(),
    [](std::uint8_t mark) { return mark != MCOR_ABSENT; });
  return present;
}

std::string vtkSPHParticles::DescribeFluid() const
{
  std::ostringstream text;
  if (const auto fluid = this->ArrayFor(MCOR_ROLE_FLUID))
  {
    text << vtkSPHNameOf(fluid) << " = " << this->Found.fluid_value;
  }
  return text.str();
}

std::vector<std::string> vtkSPHParticles::ListLeftOut(
  const std::int64_t* notFinite, const std::string& place) const
{
  std::vector<std::string> sentences;
  for (size_t i = 0; notFinite && i < this->Interpolated.size(); ++i)
  {
    if (notFinite[i] >= 0)
    {
      sentences.push_back(vtkSPHSay(MCOR_SAY(ARRAY_LEFT_OUT), this->Interpolated[i].Name.c_str(),
        static_cast<long long>(notFinite[i]), place.c_str()));
    }
  }
  return sentences;
}
VTK_ABI_NAMESPACE_END

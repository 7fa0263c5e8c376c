// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHTemporalPair.h"

#include "mcor.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkMarchingCorrectorsValues.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSMPTools.h"
#include "vtkSPHNumbers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

namespace
{
const vtkIdType Grain = 8192;       // particles that are worth a thread
const vtkIdType FewParticles = 100; // that say nothing of the unit of velocities

std::string NameOf(vtkAbstractArray* array)
{
  return array && array->GetName() ? array->GetName() : "";
}

/** Empty where the array is to be found. */
std::string RealName(const std::string& name)
{
  return name == "(automatic)" || name == "(none)" ? "" : name;
}

std::string Text(double value)
{
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

std::string ListArrays(vtkPointSet* particles)
{
  std::string list;
  for (int i = 0; i < particles->GetPointData()->GetNumberOfArrays(); ++i)
  {
    list += (i ? ", " : "") + NameOf(particles->GetPointData()->GetAbstractArray(i));
  }
  return list.empty() ? "There are no point arrays." : "Point arrays: " + list + ".";
}

/** The array with the most usual name for this quantity. */
vtkDataArray* Detect(vtkPointSet* particles, mcor_quantity quantity, int components)
{
  vtkPointData* data = particles->GetPointData();
  vtkDataArray* found = nullptr;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    const int rank = array ? mcor_name_rank(quantity, array->GetName()) : -1;
    if (rank >= 0 && array->GetNumberOfComponents() == components &&
      (!found || rank < mcor_name_rank(quantity, found->GetName())))
    {
      found = array;
    }
  }
  return found;
}

bool IsReal(vtkAbstractArray* array)
{
  return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/** Itself where it is of a type and layout for Reals, else a copy. */
vtkSmartPointer<vtkDataArray> AsReal(vtkDataArray* array)
{
  const bool plain = vtkAOSDataArrayTemplate<float>::FastDownCast(array) ||
    vtkAOSDataArrayTemplate<double>::FastDownCast(array);
  return plain ? vtkSmartPointer<vtkDataArray>(array) : vtkMarchingCorrectorsCopyAsDouble(array);
}

/** The values of an array that AsReal() has returned. */
class Reals
{
public:
  explicit Reals(vtkDataArray* array)
    : Components(array->GetNumberOfComponents())
    , Floats(
        array->GetDataType() == VTK_FLOAT ? static_cast<float*>(array->GetVoidPointer(0)) : nullptr)
    , Doubles(this->Floats ? nullptr : static_cast<double*>(array->GetVoidPointer(0)))
  {
  }

  double operator()(vtkIdType tuple, int component) const
  {
    const vtkIdType i = tuple * this->Components + component;
    return this->Floats ? static_cast<double>(this->Floats[i]) : this->Doubles[i];
  }

  const int Components;

private:
  const float* const Floats;
  const double* const Doubles;
};

/** An array of the wider type of two, with value(tuple, component), in parallel. */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> MakeArray(
  vtkDataArray* a, vtkDataArray* b, vtkIdType count, const ValueT& value)
{
  const bool isFloat = a->GetDataType() == VTK_FLOAT && b->GetDataType() == VTK_FLOAT;
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(isFloat ? static_cast<vtkDataArray*>(vtkFloatArray::New())
                              : static_cast<vtkDataArray*>(vtkDoubleArray::New()));
  const int components = a->GetNumberOfComponents();
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  array->SetName(a->GetName());
  array->CopyComponentNames(a);
  const auto fill = [&](auto* typed)
  {
    auto* const to = typed->GetPointer(0);
    using T = std::decay_t<decltype(*to)>;
    vtkSMPTools::For(0, count, Grain,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          for (int c = 0; c < components; ++c)
          {
            to[i * components + c] = static_cast<T>(value(i, c));
          }
        }
      });
  };
  if (isFloat)
  {
    fill(static_cast<vtkFloatArray*>(array.Get()));
  }
  else
  {
    fill(static_cast<vtkDoubleArray*>(array.Get()));
  }
  return array;
}

void Sign(std::vector<std::uint64_t>& signature, vtkObject* object)
{
  signature.push_back(static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(object)));
  signature.push_back(object ? object->GetMTime() : 0);
}

/** The two cubic polynomials of Hermite for positions, and the two for tangents. */
struct HermiteWeights
{
  explicit HermiteWeights(double s)
    : Second(s * s * (3.0 - 2.0 * s))
    , FirstTangent(s * (1.0 - s) * (1.0 - s))
    , SecondTangent(s * s * (s - 1.0))
  {
  }

  const double Second; // that of the first position is 1 - Second
  const double FirstTangent;
  const double SecondTangent;
};
}

//------------------------------------------------------------------------------
void vtkSPHTemporalCopy(vtkPointSet* particles, vtkPolyData* output)
{
  output->Initialize();
  output->SetPoints(particles->GetPoints());
  output->GetPointData()->PassData(particles->GetPointData());
  output->GetFieldData()->PassData(particles->GetFieldData());
  if (particles->GetNumberOfCells() > 0)
  {
    const vtkIdType count = particles->GetNumberOfPoints();
    vtkNew<vtkIdTypeArray> points, offsets;
    points->SetNumberOfValues(count);
    offsets->SetNumberOfValues(count + 1);
    for (vtkIdType i = 0; i < count; ++i)
    {
      points->SetValue(i, i);
      offsets->SetValue(i, i);
    }
    offsets->SetValue(count, count);
    vtkNew<vtkCellArray> vertices;
    vertices->SetData(offsets, points);
    output->SetVerts(vertices);
  }
}

//------------------------------------------------------------------------------
bool vtkSPHTemporalPair::Match(
  vtkPointSet* first, vtkPointSet* second, const vtkSPHTemporalChoice& choice)
{
  this->Error.clear();
  this->Warnings.clear();
  this->TimeScale = choice.TimeScale;
  vtkPointSet* const particles[2] = { first, second };
  for (int k = 0; k < 2; ++k)
  {
    this->Steps[k].Particles = particles[k];
    this->Steps[k].Time = choice.Times[k];
  }
  if (first->GetNumberOfPoints() == 0 || second->GetNumberOfPoints() == 0)
  {
    this->MatchNothing();
    return true;
  }
  std::vector<std::uint64_t> signature;
  if (!this->FindIds(choice.IdArrayName) || !this->FindVelocities(choice))
  {
    this->Signature.clear();
    return false;
  }
  for (const Step& step : this->Steps)
  {
    Sign(signature, step.Particles->GetPoints()->GetData());
    Sign(signature, step.Ids);
    Sign(signature, step.Velocities);
  }
  for (const double number : { choice.Times[0], choice.Times[1], choice.TimeScale })
  {
    signature.push_back(std::hash<double>()(number));
  }
  if (signature != this->Signature)
  {
    this->Signature.clear();
    this->Error = vtkSPHMatchNumbers({ this->Steps[0].Ids, this->Steps[1].Ids },
      { this->NameOfStep(0), this->NameOfStep(1) },
      { &this->Steps[0].Partners, &this->Steps[1].Partners });
    if (!this->Error.empty())
    {
      return false;
    }
    this->CheckVelocities();
    this->WarnOfLostArrays();
    this->Signature = signature;
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkSPHTemporalPair::MatchNothing()
{
  this->IdName.clear();
  this->VelocityName.clear();
  this->Signature.clear();
  this->FollowsVelocities = false;
  for (Step& step : this->Steps)
  {
    step.Ids = nullptr;
    step.Velocities = nullptr;
    step.Partners.assign(static_cast<size_t>(step.Particles->GetNumberOfPoints()), -1);
  }
}

//------------------------------------------------------------------------------
std::string vtkSPHTemporalPair::NameOfStep(int step) const
{
  return "the step at time " + Text(this->Steps[step].Time);
}

//------------------------------------------------------------------------------
bool vtkSPHTemporalPair::FindIds(const std::string& name)
{
  this->IdName = RealName(name);
  if (this->IdName.empty())
  {
    vtkPointSet* first = this->Steps[0].Particles;
    vtkDataArray* found = Detect(first, MCOR_PARTICLE_ID, 1);
    found = found ? found : first->GetPointData()->GetGlobalIds();
    this->IdName = NameOf(found);
  }
  if (this->IdName.empty())
  {
    this->Error =
      "Between two steps particles are recognised by their numbers, but no point array "
      "has one of the usual names (Idp, ParticleId, id, GlobalIds, ...). Name the array "
      "of numbers, or ask for stored times alone. " +
      ListArrays(this->Steps[0].Particles);
    return false;
  }
  for (int k = 0; k < 2; ++k)
  {
    this->Steps[k].Ids = this->Find("particles' numbers", this->IdName, 1, k);
  }
  return this->Error.empty();
}

//------------------------------------------------------------------------------
bool vtkSPHTemporalPair::FindVelocities(const vtkSPHTemporalChoice& choice)
{
  this->VelocityName = choice.UseVelocities ? RealName(choice.VelocityArrayName) : "";
  for (Step& step : this->Steps)
  {
    step.Velocities = nullptr;
  }
  if (!choice.UseVelocities)
  {
    return true;
  }
  if (this->VelocityName.empty())
  {
    this->VelocityName = NameOf(Detect(this->Steps[0].Particles, MCOR_VELOCITY, 3));
    vtkDataArray* other =
      this->Steps[1].Particles->GetPointData()->GetArray(this->VelocityName.c_str());
    if (this->VelocityName.empty() || !other || other->GetNumberOfComponents() != 3)
    {
      this->VelocityName.clear();
      return true;
    }
  }
  for (int k = 0; k < 2; ++k)
  {
    this->Steps[k].Velocities = this->Find("velocity", this->VelocityName, 3, k);
  }
  return this->Error.empty();
}

//------------------------------------------------------------------------------
vtkDataArray* vtkSPHTemporalPair::Find(
  const std::string& role, const std::string& name, int components, int step)
{
  vtkPointSet* particles = this->Steps[step].Particles;
  vtkDataArray* array = particles->GetPointData()->GetArray(name.c_str());
  if (!array)
  {
    this->Error = "There is no point array '" + name + "' for the " + role + " in " +
      this->NameOfStep(step) + ". " + ListArrays(particles);
  }
  else if (array->GetNumberOfComponents() != components ||
    array->GetNumberOfTuples() != particles->GetNumberOfPoints())
  {
    this->Error = "The array '" + name + "' for the " + role + " has " +
      std::to_string(array->GetNumberOfTuples()) + " entries of " +
      std::to_string(array->GetNumberOfComponents()) + " components in " + this->NameOfStep(step) +
      "; it must have " + std::to_string(components) + " for each of the " +
      std::to_string(particles->GetNumberOfPoints()) + " particles.";
  }
  return this->Error.empty() ? array : nullptr;
}

//------------------------------------------------------------------------------
// How far the particles moved along their mean velocities, over how far these would have moved
// them. Summed slice by slice and then in order: the same whatever the number of threads.
void vtkSPHTemporalPair::CheckVelocities()
{
  const Step &first = this->Steps[0], &second = this->Steps[1];
  const vtkIdType count = static_cast<vtkIdType>(first.Partners.size());
  const vtkIdType matched =
    count - std::count(first.Partners.begin(), first.Partners.end(), vtkIdType(-1));
  this->FollowsVelocities = first.Velocities != nullptr;
  if (!first.Velocities || matched < FewParticles)
  {
    return;
  }
  const auto x0 = AsReal(first.Particles->GetPoints()->GetData()),
             x1 = AsReal(second.Particles->GetPoints()->GetData()), v0 = AsReal(first.Velocities),
             v1 = AsReal(second.Velocities);
  const Reals from(x0), to(x1), begun(v0), ended(v1);
  const double duration = this->TimeScale * (second.Time - first.Time);
  std::vector<std::pair<double, double>> sums(static_cast<size_t>(count / Grain + 1));
  vtkSMPTools::For(0, static_cast<vtkIdType>(sums.size()), 1,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType slice = begin; slice < end; ++slice)
      {
        std::pair<double, double>& sum = sums[static_cast<size_t>(slice)];
        for (vtkIdType i = slice * Grain; i < std::min(count, (slice + 1) * Grain); ++i)
        {
          const vtkIdType j = first.Partners[static_cast<size_t>(i)];
          for (int c = 0; j >= 0 && c < 3; ++c)
          {
            const double expected = 0.5 * duration * (begun(i, c) + ended(j, c));
            sum.first += (to(j, c) - from(i, c)) * expected;
            sum.second += expected * expected;
          }
        }
      }
    });
  double moved = 0.0, expected = 0.0;
  for (const std::pair<double, double>& sum : sums)
  {
    moved += sum.first;
    expected += sum.second;
  }
  if (expected > 0.0 && !(moved >= 0.5 * expected && moved <= 2.0 * expected))
  {
    this->Warnings.push_back("From time " + Text(first.Time) + " to " + Text(second.Time) +
      " the particles moved " + Text(moved / expected) + " times as far as '" + this->VelocityName +
      "' says, so their positions are linear in time here: the times have another unit than the "
      "velocities (the time scale mends that), or the steps are too far apart.");
    this->FollowsVelocities = false;
  }
}

//------------------------------------------------------------------------------
void vtkSPHTemporalPair::WarnOfLostArrays()
{
  std::string lost;
  for (int k = 0; k < 2; ++k)
  {
    vtkPointData* data = this->Steps[k].Particles->GetPointData();
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = data->GetAbstractArray(i);
      if (!this->IsInBoth(array))
      {
        lost += (lost.empty() ? "" : ", ") + NameOf(array);
      }
    }
  }
  if (!lost.empty())
  {
    this->Warnings.push_back("Point arrays that " + this->NameOfStep(0) + " and " +
      this->NameOfStep(1) + " do not have alike are left out between them: " + lost + ".");
  }
}

//------------------------------------------------------------------------------
bool vtkSPHTemporalPair::IsInBoth(vtkAbstractArray* array) const
{
  if (NameOf(array).empty())
  {
    return false;
  }
  for (const Step& step : this->Steps)
  {
    vtkAbstractArray* own = step.Particles->GetPointData()->GetAbstractArray(array->GetName());
    if (!own || own->GetNumberOfComponents() != array->GetNumberOfComponents() ||
      own->GetNumberOfTuples() != step.Particles->GetNumberOfPoints() ||
      IsReal(own) != IsReal(array))
    {
      return false;
    }
  }
  return true;
}

//------------------------------------------------------------------------------
void vtkSPHTemporalPair::Interpolate(double time, vtkPolyData* output) const
{
  const double s = (time - this->Steps[0].Time) / (this->Steps[1].Time - this->Steps[0].Time);
  const Step& near = this->Steps[s < 0.5 ? 0 : 1];
  vtkSPHTemporalCopy(near.Particles, output);
  output->GetFieldData()->RemoveArray("TimeValue"); // that of the step
  if (!near.Ids)
  {
    return; // one step has no particles, and the other nothing to interpolate with
  }
  this->InterpolatePositions(s, time, output);
  this->InterpolateArrays(s, output);
}

//------------------------------------------------------------------------------
// In double, from the step that is nearer, so that a particle at rest stays where it is.
void vtkSPHTemporalPair::InterpolatePositions(double s, double time, vtkPolyData* output) const
{
  const bool early = s < 0.5;
  const Step &near = this->Steps[early ? 0 : 1], &far = this->Steps[early ? 1 : 0];
  const double share = early ? s : 1.0 - s;
  const double toFar = this->TimeScale * (far.Time - near.Time); // below 0 for the later half
  const double toTime = this->TimeScale * (time - near.Time);
  const auto x0 = AsReal(near.Particles->GetPoints()->GetData()),
             x1 = AsReal(far.Particles->GetPoints()->GetData());
  const bool curved = this->FollowsVelocities;
  const auto v0 = curved ? AsReal(near.Velocities) : x0, v1 = curved ? AsReal(far.Velocities) : x1;
  const Reals from(x0), to(x1), begun(v0), ended(v1);
  const HermiteWeights weight(share);
  const auto position = [&](vtkIdType i, int c)
  {
    const vtkIdType j = near.Partners[static_cast<size_t>(i)];
    const double x = from(i, c);
    if (j < 0)
    {
      return curved ? x + toTime * begun(i, c) : x;
    }
    const double way = to(j, c) - x;
    return curved ? x + weight.Second * way +
        toFar * (weight.FirstTangent * begun(i, c) + weight.SecondTangent * ended(j, c))
                  : x + share * way;
  };
  vtkNew<vtkPoints> points;
  points->SetData(MakeArray(x0, x1, near.Particles->GetNumberOfPoints(), position));
  output->SetPoints(points);
}

//------------------------------------------------------------------------------
// What the output has is that of the nearer step already.
void vtkSPHTemporalPair::InterpolateArrays(double s, vtkPolyData* output) const
{
  const bool early = s < 0.5;
  const Step &near = this->Steps[early ? 0 : 1], &far = this->Steps[early ? 1 : 0];
  const double share = early ? s : 1.0 - s;
  vtkPointData* own = near.Particles->GetPointData();
  for (int k = 0; k < own->GetNumberOfArrays(); ++k)
  {
    vtkAbstractArray* array = own->GetAbstractArray(k);
    if (!this->IsInBoth(array))
    {
      output->GetPointData()->RemoveArray(array->GetName());
      continue;
    }
    vtkDataArray* other = far.Particles->GetPointData()->GetArray(array->GetName());
    if (!IsReal(array) || array == near.Ids)
    {
      continue;
    }
    const auto a = AsReal(vtkDataArray::SafeDownCast(array)), b = AsReal(other);
    const Reals from(a), to(b);
    output->GetPointData()->AddArray(MakeArray(a, b, near.Particles->GetNumberOfPoints(),
      [&](vtkIdType i, int c)
      {
        const vtkIdType j = near.Partners[static_cast<size_t>(i)];
        const double value = from(i, c);
        return j < 0 ? value : value + share * (to(j, c) - value);
      }));
  }
}

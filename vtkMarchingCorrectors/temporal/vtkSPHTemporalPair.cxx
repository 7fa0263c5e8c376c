// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHTemporalPair.h"

#include "mcor.h"
#include "vtkCellArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSMPTools.h"
#include "vtkSPHArrays.h"
#include "vtkSPHSay.h"
#include "vtkTypeInt64Array.h"

#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
const vtkIdType Grain = 8192;       // particles that are worth a thread
const vtkIdType FewParticles = 100; // fewer particles tell nothing about the unit of velocities

std::string Text(double value)
{
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

/** Reads the values of an array as doubles. */
struct Values
{
  explicit Values(vtkDataArray* array)
    : Held(vtkSPHAsReal(array))
    , View(vtkSPHView(this->Held))
  {
  }

  double operator()(vtkIdType tuple, int component) const
  {
    return vtkSPHValueOf(this->View, tuple * this->View.components + component);
  }

  const vtkSmartPointer<vtkDataArray> Held; ///< the array, or its copy
  const mcor_array View;
};

/**
 * Makes an array like `a`, of floats if `a` and `b` are floats, else of doubles. The function
 * value(tuple, component) returns its values; several threads call the function.
 */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> MakeArray(
  const Values& a, const Values& b, vtkIdType count, const ValueT& value)
{
  const bool isFloat = a.View.type == MCOR_FLOAT32 && b.View.type == MCOR_FLOAT32;
  const vtkSmartPointer<vtkDataArray> array =
    vtkDataArray::SafeDownCast(vtkSPHMakeLike(a.Held, count, isFloat ? VTK_FLOAT : VTK_DOUBLE));
  vtkSMPTools::For(0, count, Grain,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        for (int c = 0; c < a.View.components; ++c)
        {
          array->SetComponent(i, c, value(i, c));
        }
      }
    });
  return array;
}
}

void vtkSPHTemporalCopy(vtkPointSet* particles, vtkPolyData* output)
{
  output->Initialize();
  output->SetPoints(particles->GetPoints());
  output->GetPointData()->PassData(particles->GetPointData());
  output->GetFieldData()->PassData(particles->GetFieldData());
  if (particles->GetNumberOfCells() > 0)
  {
    output->SetVerts(vtkSPHMakeVertices(particles->GetNumberOfPoints()));
  }
}

bool vtkSPHTemporalPair::Match(
  vtkPointSet* first, vtkPointSet* second, const vtkSPHTemporalChoice& choice)
{
  this->Error.clear();
  this->Warnings.clear();
  this->IdName.clear();
  this->VelocityName.clear();
  const double ratio = std::exchange(this->Ratio, 0.0);
  this->Choice = choice;
  const std::vector<std::uint64_t> before = std::exchange(this->Signature, {});
  this->Steps[0].Particles = first;
  this->Steps[1].Particles = second;
  for (Step& step : this->Steps)
  {
    step.Ids = step.Velocities = nullptr;
  }
  if (first->GetNumberOfPoints() == 0 || second->GetNumberOfPoints() == 0)
  {
    this->FollowsVelocities = false;
    return true;
  }
  if (!this->FindIds() || !this->FindVelocities())
  {
    return false;
  }
  std::vector<std::uint64_t> signature;
  for (const Step& step : this->Steps)
  {
    vtkSPHSign(signature, step.Particles->GetPoints()->GetData());
    vtkSPHSign(signature, step.Ids);
    vtkSPHSign(signature, step.Velocities);
  }
  for (const double number : { choice.Times[0], choice.Times[1], choice.TimeScale, choice.Period[0],
         choice.Period[1], choice.Period[2] })
  {
    vtkSPHSign(signature, number);
  }
  if (signature == before)
  {
    this->Ratio = ratio;
  }
  else
  {
    if (!this->MatchNumbers())
    {
      return false;
    }
    this->CheckVelocities();
    this->WarnOfLostArrays();
  }
  this->Signature = signature;
  return true;
}

// Sorts each step's particles by id, and finds the ids in both steps. Returns false, after an error, if ids are not whole or not unique.
bool vtkSPHTemporalPair::MatchNumbers()
{
  std::vector<std::pair<std::int64_t, vtkIdType>> sorted[2];
  for (int k = 0; k < 2; ++k)
  {
    vtkDataArray* ids = this->Steps[k].Ids;
    for (vtkIdType i = 0; vtkSPHIsReal(ids) && i < ids->GetNumberOfTuples(); ++i)
    {
      // Beyond 2^53, floating point cannot hold all whole numbers, so distinct numbers may have
      // become equal.
      const double real = ids->GetComponent(i, 0);
      if (!(std::floor(real) == real && std::abs(real) <= 9007199254740992.0))
      {
        this->Error = "The number '" + this->IdName + "' of particle " + std::to_string(i) +
          " in " + this->NameOfStep(k) + " is " + Text(real) + "; particles have whole numbers.";
        return false;
      }
    }
    vtkNew<vtkTypeInt64Array> numbers;
    numbers->DeepCopy(ids);
    for (vtkIdType i = 0; i < numbers->GetNumberOfValues(); ++i)
    {
      sorted[k].emplace_back(numbers->GetValue(i), i);
    }
    if (!std::is_sorted(sorted[k].begin(), sorted[k].end()))
    {
      vtkSMPTools::Sort(sorted[k].begin(), sorted[k].end());
    }
    const auto twin = std::adjacent_find(sorted[k].begin(), sorted[k].end(),
      [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twin != sorted[k].end())
    {
      this->Error = "Particles " + std::to_string(twin->second) + " and " +
        std::to_string((twin + 1)->second) + " in " + this->NameOfStep(k) +
        " have the same number " + std::to_string(twin->first) +
        ", so they cannot be told apart: '" + this->IdName + "' is not an array of particle ids.";
      return false;
    }
    this->Steps[k].Partners.assign(sorted[k].size(), -1);
  }
  for (auto one = sorted[0].begin(), other = sorted[1].begin();
       one != sorted[0].end() && other != sorted[1].end();)
  {
    const std::int64_t a = one->first, b = other->first;
    if (a == b)
    {
      this->Steps[0].Partners[one->second] = other->second;
      this->Steps[1].Partners[other->second] = one->second;
    }
    one += a <= b ? 1 : 0;
    other += b <= a ? 1 : 0;
  }
  return true;
}

std::string vtkSPHTemporalPair::NameOfStep(int step) const
{
  return "the step at time " + Text(this->Choice.Times[step]);
}

double vtkSPHTemporalPair::Nearest(double way, int axis) const
{
  const double period = this->Choice.Period[axis];
  return period > 0.0 ? way - period * std::round(way / period) : way;
}

bool vtkSPHTemporalPair::FindIds()
{
  this->IdName = vtkSPHRealName(this->Choice.IdArrayName);
  if (this->IdName.empty())
  {
    vtkPointSet* first = this->Steps[0].Particles;
    vtkDataArray* found = vtkSPHDetect(first, MCOR_PARTICLE_ID, 1);
    found = found ? found : first->GetPointData()->GetGlobalIds();
    this->IdName = vtkSPHNameOf(found);
  }
  if (this->IdName.empty())
  {
    this->Error = vtkSPHSay(MCOR_SAY(NO_IDS), vtkSPHListNames(this->Steps[0].Particles).c_str());
    return false;
  }
  return this->Find("particles' numbers", this->IdName, 1, &Step::Ids);
}

bool vtkSPHTemporalPair::FindVelocities()
{
  if (!this->Choice.UseVelocities)
  {
    return true;
  }
  this->VelocityName = vtkSPHRealName(this->Choice.VelocityArrayName);
  if (this->VelocityName.empty())
  {
    this->VelocityName = vtkSPHNameOf(vtkSPHDetect(this->Steps[0].Particles, MCOR_VELOCITY, 3));
    vtkDataArray* other =
      this->Steps[1].Particles->GetPointData()->GetArray(this->VelocityName.c_str());
    if (this->VelocityName.empty() || !other || other->GetNumberOfComponents() != 3)
    {
      this->VelocityName.clear();
      return true;
    }
  }
  return this->Find("velocity", this->VelocityName, 3, &Step::Velocities);
}

bool vtkSPHTemporalPair::Find(const std::string& role, const std::string& name, int components,
  vtkSmartPointer<vtkDataArray> Step::*member)
{
  for (int k = 0; k < 2; ++k)
  {
    vtkPointSet* particles = this->Steps[k].Particles;
    vtkDataArray* array = particles->GetPointData()->GetArray(name.c_str());
    this->Steps[k].*member = array;
    if (!array)
    {
      this->Error = vtkSPHSay(MCOR_SAY(NO_SUCH_ARRAY), name.c_str(),
        (role + " in " + this->NameOfStep(k)).c_str(), "", vtkSPHListNames(particles).c_str());
    }
    else if (array->GetNumberOfComponents() != components ||
      array->GetNumberOfTuples() != particles->GetNumberOfPoints())
    {
      std::ostringstream error;
      error << "The array '" << name << "' for the " << role << " has "
            << array->GetNumberOfTuples() << " entries of " << array->GetNumberOfComponents()
            << " components in " << this->NameOfStep(k) << "; it must have " << components
            << " for each of the " << particles->GetNumberOfPoints() << " particles.";
      this->Error = error.str();
    }
  }
  return this->Error.empty();
}

// Warns, and does not use the velocities, if a velocity is not finite, or if the velocities do not fit the motion:
// FewParticles or more are in both steps, and have together moved less than half or more than twice as far as the velocities say.
void vtkSPHTemporalPair::CheckVelocities()
{
  const Step &first = this->Steps[0], &second = this->Steps[1];
  const double* const times = this->Choice.Times;
  this->FollowsVelocities = first.Velocities != nullptr;
  if (!this->FollowsVelocities)
  {
    return;
  }
  const Values from(first.Particles->GetPoints()->GetData()),
    to(second.Particles->GetPoints()->GetData()), begun(first.Velocities), ended(second.Velocities);
  for (const Values* velocity : { &begun, &ended })
  {
    for (vtkIdType i = 0; i < velocity->Held->GetNumberOfTuples(); ++i)
    {
      if (!(std::isfinite((*velocity)(i, 0)) && std::isfinite((*velocity)(i, 1)) &&
            std::isfinite((*velocity)(i, 2))))
      {
        this->Warnings.push_back(vtkSPHSay(MCOR_SAY(STEP_NOT_FINITE), this->VelocityName.c_str(),
          static_cast<long long>(i), this->NameOfStep(velocity == &begun ? 0 : 1).c_str(),
          Text(times[0]).c_str(), Text(times[1]).c_str()));
        this->FollowsVelocities = false;
        return;
      }
    }
  }
  const double duration = this->Choice.TimeScale * (times[1] - times[0]);
  double moved = 0.0, expected = 0.0;
  vtkIdType matched = 0;
  for (vtkIdType i = 0; i < first.Particles->GetNumberOfPoints(); ++i)
  {
    const vtkIdType j = first.Partners[i];
    matched += j >= 0 ? 1 : 0;
    for (int c = 0; j >= 0 && c < 3; ++c)
    {
      const double way = 0.5 * duration * (begun(i, c) + ended(j, c));
      moved += this->Nearest(to(j, c) - from(i, c), c) * way;
      expected += way * way;
    }
  }
  if (matched >= FewParticles && expected > 0.0 &&
    !(moved >= 0.5 * expected && moved <= 2.0 * expected))
  {
    const double ratio = moved / expected;
    std::ostringstream remedy;
    if (ratio > 0.0)
    {
      remedy << std::setprecision(3) << "Choose {time_scale " << this->Choice.TimeScale * ratio
             << "}, or other times. ";
    }
    this->Warnings.push_back(
      vtkSPHSay(MCOR_SAY(STEP_MOVED), remedy.str().c_str(), Text(times[0]).c_str(),
        Text(times[1]).c_str(), Text(ratio).c_str(), this->VelocityName.c_str()));
    this->FollowsVelocities = false;
    this->Ratio = ratio;
  }
}

void vtkSPHTemporalPair::WarnOfLostArrays()
{
  std::string lost;
  for (const Step& step : this->Steps)
  {
    for (const auto& array : vtkSPHListArrays(step.Particles->GetPointData()))
    {
      if (!this->IsInBoth(array))
      {
        lost += (lost.empty() ? "" : ", ") + vtkSPHNameOf(array);
      }
    }
  }
  if (!lost.empty())
  {
    this->Warnings.push_back("Point arrays that " + this->NameOfStep(0) + " and " +
      this->NameOfStep(1) + " do not share are left out between them: " + lost + ".");
  }
}

bool vtkSPHTemporalPair::IsInBoth(vtkAbstractArray* array) const
{
  if (vtkSPHNameOf(array).empty())
  {
    return false;
  }
  for (const Step& step : this->Steps)
  {
    vtkAbstractArray* own = step.Particles->GetPointData()->GetAbstractArray(array->GetName());
    if (!own || own->GetNumberOfComponents() != array->GetNumberOfComponents() ||
      own->GetNumberOfTuples() != step.Particles->GetNumberOfPoints() ||
      vtkSPHIsReal(own) != vtkSPHIsReal(array))
    {
      return false;
    }
  }
  return true;
}

void vtkSPHTemporalPair::Interpolate(double time, vtkPolyData* output) const
{
  const double* const times = this->Choice.Times;
  const double s = (time - times[0]) / (times[1] - times[0]);
  const bool early = s < 0.5;
  const Step &near = this->Steps[early ? 0 : 1], &far = this->Steps[early ? 1 : 0];
  const double share = early ? s : 1.0 - s; // share of the way to the other step
  vtkSPHTemporalCopy(near.Particles, output);
  output->GetFieldData()->RemoveArray("TimeValue"); // the step's own time
  if (!near.Ids)
  {
    return; // one step has no particles, so nothing can be interpolated
  }
  // Positions are computed in double, from the nearer step, so that particles at rest do not move.
  const double nearTime = times[early ? 0 : 1], farTime = times[early ? 1 : 0];
  const double toFar = this->Choice.TimeScale * (farTime - nearTime); // negative in the later half
  const double toTime = this->Choice.TimeScale * (time - nearTime);
  const bool curved = this->FollowsVelocities;
  vtkDataArray *const x0 = near.Particles->GetPoints()->GetData(),
                      *const x1 = far.Particles->GetPoints()->GetData();
  const Values from(x0), to(x1), begun(curved ? near.Velocities.Get() : x0),
    ended(curved ? far.Velocities.Get() : x1);
  // Hermite's cubic polynomials: the factors of the far position and of both velocities.
  const double ofFar = share * share * (3.0 - 2.0 * share),
               ofBegun = share * (1.0 - share) * (1.0 - share),
               ofEnded = share * share * (share - 1.0);
  const auto position = [&](vtkIdType i, int c)
  {
    const vtkIdType j = near.Partners[i];
    const double x = from(i, c);
    if (j < 0)
    {
      return curved ? x + toTime * begun(i, c) : x;
    }
    const double way = this->Nearest(to(j, c) - x, c);
    return curved ? x + ofFar * way + toFar * (ofBegun * begun(i, c) + ofEnded * ended(j, c))
                  : x + share * way;
  };
  vtkNew<vtkPoints> points;
  points->SetData(MakeArray(from, to, near.Particles->GetNumberOfPoints(), position));
  output->SetPoints(points);
  for (const auto& array : vtkSPHListArrays(near.Particles->GetPointData()))
  {
    if (!this->IsInBoth(array))
    {
      output->GetPointData()->RemoveArray(array->GetName());
    }
    else if (vtkSPHIsReal(array) && array != near.Ids)
    {
      const Values here(vtkDataArray::SafeDownCast(array)),
        there(far.Particles->GetPointData()->GetArray(array->GetName()));
      output->GetPointData()->AddArray(MakeArray(here, there, near.Particles->GetNumberOfPoints(),
        [&](vtkIdType i, int c)
        {
          const vtkIdType j = near.Partners[i];
          const double value = here(i, c);
          return j < 0 ? value : value + share * (there(j, c) - value);
        }));
    }
  }
}
VTK_ABI_NAMESPACE_END

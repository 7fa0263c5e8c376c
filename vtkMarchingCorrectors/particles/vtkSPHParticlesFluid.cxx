// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Which particles are fluid: as chosen, or as an array tells.
#include "vtkSPHParticles.h"

#include "vtkPointData.h"
#include "vtkSPHArrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
bool HasWithin(const vtkSPHParticlesChoice& choice)
{
  return std::any_of(choice.Within, choice.Within + 6, [](double side) { return side != 0.0; });
}

/** Numbers in their order, and NaN as the last one of them. */
struct NaNLast
{
  bool operator()(double a, double b) const { return a < b || (std::isnan(b) && !std::isnan(a)); }
};

/**
 * Counts how often each value occurs in an array; none if there are more than kinds of particles,
 * for which its first values suffice.
 */
std::map<double, vtkIdType, NaNLast> CountValues(vtkDataArray* array)
{
  std::map<double, vtkIdType, NaNLast> counts;
  for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
  {
    const double value = array->GetComponent(i, 0);
    ++counts[std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value];
    if (counts.size() > MCOR_PARTICLE_TYPES)
    {
      return {};
    }
  }
  return counts;
}

/**
 * Names of the arrays that may tell fluid from solids, the most usual one first; none where the
 * choice names the fluid array.
 */
std::vector<std::string> ListTypes(const vtkSPHParticlesChoice& choice, vtkPointData* data)
{
  std::multimap<int, std::string> names;
  const bool isNamed = !vtkSPHRealName(choice.FluidArrayName).empty();
  for (int i = 0; !isNamed && i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    const int rank = array ? mcor_name_priority(MCOR_PARTICLE_TYPE, array->GetName()) : -1;
    if (rank >= 0 && array->GetNumberOfComponents() == 1)
    {
      names.emplace(rank, array->GetName());
    }
  }
  std::vector<std::string> list;
  for (const auto& name : names)
  {
    list.push_back(name.second);
  }
  return list;
}
}

bool vtkSPHParticles::CollectSolids()
{
  this->FluidCount = static_cast<vtkIdType>(this->Core.count);
  this->Core.ignore_solids = this->Description.IgnoreSolids ? 1 : 0;
  const std::string name = vtkSPHRealName(this->Description.FluidArrayName);
  if (!name.empty())
  {
    this->Fluid = this->Find("fluid", name);
    if (!this->Fluid)
    {
      return false;
    }
    const vtkSPHReals values(this->Fluid);
    this->Solid.resize(std::max<size_t>(this->Core.count, 1));
    for (vtkIdType i = 0; i < this->Core.count; ++i)
    {
      this->Solid[i] = values(i, 0) == this->Description.FluidValue ? 0 : 1;
    }
    this->Core.solid = this->Solid.data();
  }
  for (const vtkSPHOnly& only : this->Description.Only)
  {
    if (this->Core.count > 0 && !this->Find("choice of particles", only.Name))
    {
      return false;
    }
  }
  const std::vector<bool> present = vtkSPHFindPresent(this->Description, this->Points);
  if (!present.empty())
  {
    this->Solid.resize(this->Core.count); // 0: fluid
    for (size_t i = 0; i < present.size(); ++i)
    {
      this->Solid[i] = present[i] ? this->Solid[i] : MCOR_ABSENT;
    }
    this->AllAbsent = std::count(present.begin(), present.end(), true) == 0;
    this->Core.solid = this->Solid.data();
  }
  if (this->Core.solid)
  {
    this->FluidCount = std::count(this->Solid.begin(), this->Solid.begin() + this->Core.count, 0);
  }
  return true;
}

// With several ranges of one array, any may hold.
std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points)
{
  const vtkIdType count = points->GetNumberOfPoints();
  const double* b = choice.Within;
  const bool isWithin = HasWithin(choice);
  if (!isWithin && choice.Only.empty())
  {
    return {};
  }
  std::vector<bool> present(count, true);
  for (vtkIdType i = 0; isWithin && i < count; ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    present[i] =
      x[0] >= b[0] && x[0] <= b[1] && x[1] >= b[2] && x[1] <= b[3] && x[2] >= b[4] && x[2] <= b[5];
  }
  std::map<std::string, std::vector<vtkSPHOnly>> ranges;
  for (const vtkSPHOnly& only : choice.Only)
  {
    ranges[only.Name].push_back(only);
  }
  for (const auto& each : ranges)
  {
    vtkDataArray* array = points->GetPointData()->GetArray(each.first.c_str());
    for (vtkIdType i = 0; array && i < count; ++i)
    {
      const double value = array->GetComponent(i, 0);
      present[i] = present[i] &&
        std::any_of(each.second.begin(), each.second.end(),
          [value](const vtkSPHOnly& range) { return value >= range.Low && value <= range.High; });
    }
  }
  return present;
}

std::string vtkSPHParticles::DescribeNoFluid() const
{
  std::ostringstream text;
  const double* b = this->Description.Within;
  if (!this->AllAbsent)
  {
    text << "No particle has " << this->Description.FluidArrayName << " = "
         << this->Description.FluidValue;
    return text.str();
  }
  text << "No particle is ";
  if (HasWithin(this->Description))
  {
    for (int i = 0; i < 6; ++i)
    {
      // A side just off 0 is how the point 0, 0, 0 can be chosen; all 0 would be no choice.
      text << (i == 0 ? "within " : ",") << (std::fpclassify(b[i]) == FP_SUBNORMAL ? 0.0 : b[i]);
    }
    text << (this->Description.Only.empty() ? "" : " and ");
  }
  for (size_t i = 0; i < this->Description.Only.size(); ++i)
  {
    const vtkSPHOnly& only = this->Description.Only[i];
    text << (i ? " and " : "left by ") << only.Name << "=" << only.Low;
    if (only.High != only.Low)
    {
      text << ":" << only.High;
    }
  }
  return text.str();
}

void vtkSPHParticles::FindFluid(
  vtkSPHParticlesChoice& choice, vtkPointSet* points, const vtkSPHMergeRanges& merge)
{
  if (choice.IsBlock() && points->GetPointData()->HasArray(MCOR_WALL_BLOCK))
  {
    choice.FluidArrayName = MCOR_WALL_BLOCK;
    choice.FluidValue = 0.0;
  }
  for (const std::string& name : ListTypes(choice, points->GetPointData()))
  {
    // The range of whole numbers; for other numbers one that tells of no fluid.
    const double none = std::numeric_limits<double>::infinity();
    vtkDataArray* array = points->GetPointData()->GetArray(name.c_str());
    const auto counts = CountValues(array);
    const bool isWhole = !counts.empty() &&
      std::all_of(counts.begin(), counts.end(),
        [](const auto& count) { return count.first == std::floor(count.first); });
    double range[2] = { isWhole          ? counts.begin()->first
        : array->GetNumberOfTuples() > 0 ? -none
                                         : none,
      isWhole ? counts.rbegin()->first : -none };
    if (merge)
    {
      merge(range, 1);
    }
    if (mcor_find_fluid_value(name.c_str(), range[0], range[1], &choice.FluidValue))
    {
      choice.FluidArrayName = name;
      return;
    }
  }
}

std::string vtkSPHParticles::DescribeFluid() const
{
  std::ostringstream text;
  if (this->Fluid)
  {
    text << vtkSPHNameOf(this->Fluid) << " = " << this->Description.FluidValue;
  }
  return text.str();
}

// Each process tells its values, each followed by how often it occurs; one number where there are too
// many to be kinds.
std::string vtkSPHParticles::DescribeUnusedType(const vtkSPHGather& gather)
{
  vtkPointData* data = this->Points->GetPointData();
  for (const std::string& name : ListTypes(this->Description, data))
  {
    const std::vector<vtkSPHOnly>& chosen = this->Description.Only;
    if (std::any_of(chosen.begin(), chosen.end(),
          [&name](const vtkSPHOnly& only) { return only.Name == name; }))
    {
      continue; // it is used, to choose particles
    }
    vtkDataArray* array = data->GetArray(name.c_str());
    std::vector<double> mine;
    for (const auto& count : CountValues(array))
    {
      mine.insert(mine.end(), { count.first, static_cast<double>(count.second) });
    }
    mine.resize(mine.empty() && array->GetNumberOfTuples() > 0 ? 1 : mine.size());
    bool areKinds = true;
    std::map<double, std::int64_t, NaNLast> all;
    for (const std::vector<double>& theirs : gather(mine))
    {
      areKinds = areKinds && theirs.size() != 1;
      for (std::size_t i = 0; i + 1 < theirs.size(); i += 2)
      {
        all[theirs[i]] += static_cast<std::int64_t>(theirs[i + 1]);
      }
    }
    std::vector<double> values;
    std::vector<std::int64_t> counts;
    for (const auto& count : all)
    {
      values.push_back(count.first);
      counts.push_back(count.second);
    }
    const std::string text = vtkSPHTakeText(mcor_describe_unused_type(
      name.c_str(), values.data(), counts.data(), areKinds ? static_cast<int>(values.size()) : 0));
    if (!text.empty())
    {
      return text;
    }
  }
  return {};
}
VTK_ABI_NAMESPACE_END

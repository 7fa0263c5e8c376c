// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Which particles are fluid: as chosen, or as an array tells.
#include "vtkSPHParticles.h"

#include "vtkPointData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHReals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
bool vtkSPHParticles::CollectSolids()
{
  this->FluidCount = static_cast<vtkIdType>(this->Core.count);
  this->Core.ignore_solids = this->Description.IgnoreSolids ? 1 : 0;
  const std::string name = vtkSPHRealName(this->Description.FluidArrayName);
  if (name.empty())
  {
    return this->CollectAbsent();
  }
  this->Fluid = this->Find("fluid", name);
  if (!this->Fluid)
  {
    return false;
  }
  this->Solid.resize(std::max<size_t>(static_cast<size_t>(this->Core.count), 1));
  this->FluidCount =
    vtkSPHMarkSolids(this->Fluid, this->Description.FluidValue, this->Solid.data());
  this->Core.solid = this->Solid.data();
  return this->CollectAbsent();
}

// Finds the absent particles. With several ranges of one array, any may hold.
bool vtkSPHParticles::CollectAbsent()
{
  if (!vtkSPHLeavesOut(this->Description) || this->Core.count == 0)
  {
    return true;
  }
  for (const vtkSPHOnly& only : this->Description.Only)
  {
    if (!this->Find("choice of particles", only.Name))
    {
      return false;
    }
  }
  this->Solid.resize(static_cast<size_t>(this->Core.count)); // 0: fluid
  vtkIdType fluid = 0, there = 0;
  const std::vector<bool> present = vtkSPHFindPresent(this->Description, this->Points);
  for (size_t i = 0; i < present.size(); ++i)
  {
    this->Solid[i] = present[i] ? this->Solid[i] : MCOR_ABSENT;
    fluid += this->Solid[i] == 0 ? 1 : 0;
    there += present[i] ? 1 : 0;
  }
  this->FluidCount = fluid;
  this->AllAbsent = there == 0;
  this->Core.solid = this->Solid.data();
  return true;
}

bool vtkSPHLeavesOut(const vtkSPHParticlesChoice& choice)
{
  return !choice.Only.empty() ||
    std::any_of(choice.Within, choice.Within + 6, [](double side) { return side != 0.0; });
}

std::vector<bool> vtkSPHFindPresent(const vtkSPHParticlesChoice& choice, vtkPointSet* points)
{
  const vtkIdType count = points->GetNumberOfPoints();
  std::vector<bool> present(static_cast<size_t>(count), true);
  const double* b = choice.Within;
  const bool isWithin = std::any_of(b, b + 6, [](double side) { return side != 0.0; });
  for (vtkIdType i = 0; isWithin && i < count; ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    present[static_cast<size_t>(i)] =
      x[0] >= b[0] && x[0] <= b[1] && x[1] >= b[2] && x[1] <= b[3] && x[2] >= b[4] && x[2] <= b[5];
  }
  std::map<std::string, std::vector<std::pair<double, double>>> ranges;
  for (const vtkSPHOnly& only : choice.Only)
  {
    ranges[only.Name].emplace_back(only.Low, only.High);
  }
  for (const auto& each : ranges)
  {
    vtkDataArray* array = points->GetPointData()->GetArray(each.first.c_str());
    for (vtkIdType i = 0; array && i < count; ++i)
    {
      const double value = array->GetComponent(i, 0);
      present[static_cast<size_t>(i)] = present[static_cast<size_t>(i)] &&
        std::any_of(each.second.begin(), each.second.end(),
          [value](const std::pair<double, double>& range)
          { return value >= range.first && value <= range.second; });
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
  if (std::any_of(b, b + 6, [](double side) { return side != 0.0; }))
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

std::vector<std::string> vtkSPHParticles::ListTypes(
  const vtkSPHParticlesChoice& choice, vtkPointSet* points)
{
  std::multimap<int, std::string> names;
  vtkPointData* pointData = points->GetPointData();
  for (int i = 0;
       vtkSPHRealName(choice.FluidArrayName).empty() && i < pointData->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = pointData->GetArray(i);
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

namespace
{
/** Finds the range of an array of whole numbers; for other numbers one that tells of no fluid. */
void FindWholeRange(vtkDataArray* array, double range[2])
{
  const double none = std::numeric_limits<double>::infinity();
  const std::map<double, vtkIdType> counts = vtkSPHCountValues(array, MCOR_PARTICLE_TYPES);
  const bool isWhole = !counts.empty() &&
    std::all_of(counts.begin(), counts.end(),
      [](const std::pair<const double, vtkIdType>& count)
      { return count.first == std::floor(count.first); });
  range[0] = isWhole ? counts.begin()->first : array->GetNumberOfTuples() > 0 ? -none : none;
  range[1] = isWhole ? counts.rbegin()->first : -none;
}
}

void vtkSPHParticles::FindFluid(
  vtkSPHParticlesChoice& choice, vtkPointSet* points, const vtkSPHMergeRanges& merge)
{
  if (choice.IsBlock() && points->GetPointData()->HasArray(MCOR_WALL_BLOCK))
  {
    choice.FluidArrayName = MCOR_WALL_BLOCK;
    choice.FluidValue = 0.0;
  }
  for (const std::string& name : ListTypes(choice, points))
  {
    double range[2];
    FindWholeRange(points->GetPointData()->GetArray(name.c_str()), range);
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

std::string vtkSPHParticles::DescribeUnusedType()
{
  for (const std::string& name : ListTypes(this->Description, this->Points))
  {
    std::vector<double> values;
    std::vector<std::int64_t> counts;
    for (const auto& count :
      vtkSPHCountValues(this->Points->GetPointData()->GetArray(name.c_str()), MCOR_PARTICLE_TYPES))
    {
      values.push_back(count.first);
      counts.push_back(count.second);
    }
    const std::string text = vtkSPHTakeText(mcor_describe_unused_type(
      name.c_str(), values.data(), counts.data(), static_cast<int>(values.size())));
    if (!text.empty())
    {
      return text;
    }
  }
  return {};
}
VTK_ABI_NAMESPACE_END

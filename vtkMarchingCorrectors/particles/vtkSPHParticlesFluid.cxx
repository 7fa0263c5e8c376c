// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Which particles are fluid: as chosen, or as an array tells.
#include "vtkSPHParticles.h"

#include "vtkPointData.h"
#include "vtkPointSet.h"
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
  const std::string name = RealName(this->Description.FluidArrayName);
  if (name.empty())
  {
    return true;
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
  return true;
}

std::vector<std::string> vtkSPHParticles::ListTypes(
  const vtkSPHParticlesChoice& choice, vtkPointSet* points)
{
  std::multimap<int, std::string> names;
  vtkPointData* pointData = points->GetPointData();
  for (int i = 0; RealName(choice.FluidArrayName).empty() && i < pointData->GetNumberOfArrays();
       ++i)
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
    text << NameOf(this->Fluid) << " = " << this->Description.FluidValue;
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

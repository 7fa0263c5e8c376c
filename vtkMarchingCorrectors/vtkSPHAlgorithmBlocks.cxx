// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// What the data tell of particles: blocks of composite data, and which particles are fluid.
#include "vtkSPHAlgorithm.h"

#include "mcor.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkDataObjectTypes.h"
#include "vtkFieldData.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithmInternals.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHParticles.h"
#if MCOR_HAS_RANKS
#include "vtkSPHRanks.h"
#endif

#include <algorithm>
#include <limits>
#include <vector>

//------------------------------------------------------------------------------
// Each block is a run that all processes take part in.
bool vtkSPHAlgorithm::AgreeOnBlocks(vtkDataObjectTree* blocks)
{
  bool good = true;
#if !MCOR_HAS_RANKS
  static_cast<void>(blocks);
#else
  vtkSPHRanks ranks(this->Controller);
  const std::int64_t count =
    blocks ? static_cast<std::int64_t>(vtkSPHNameBlocks(blocks).size()) : -1;
  std::int64_t ends[2] = { count, -count };
  ranks.Reduce(vtkSPHRanks::LEAST, ends, 2);
  good = ends[0] == -ends[1];
#endif
  if (!good)
  {
    this->Fail("The processes have different numbers of blocks. Merge the blocks of each process.");
  }
  return good;
}

//------------------------------------------------------------------------------
// A block that fails leaves its place empty, and the others as they are.
void vtkSPHAlgorithm::ProcessBlocks(vtkDataObjectTree* input, vtkDataObjectTree* output)
{
  output->CopyStructure(input);
  const std::vector<std::string> names = vtkSPHNameBlocks(input);
  vtkSmartPointer<vtkDataObjectTreeIterator> iterator;
  iterator.TakeReference(input->NewTreeIterator());
  iterator->InitTraversal();
  this->WarnOnce(WARN_WALL_BLOCK, vtkSPHFindWalls(names));
  const double share = 1.0 / static_cast<double>(names.size());
  for (size_t i = 0; i < names.size(); ++i, iterator->GoToNextItem())
  {
    this->SetProgressShiftScale(static_cast<double>(i) * share, share);
    this->BlockName = names[i] + ": ";
    vtkDataObject* block = iterator->GetCurrentDataObject();
    auto made = vtkSmartPointer<vtkDataObject>::Take(
      vtkDataObjectTypes::NewDataObject(this->GetOutputClassName(block->GetClassName())));
    made->GetFieldData()->PassData(block->GetFieldData());
    this->Process(block, made);
    output->SetDataSetFrom(iterator, made);
  }
  this->SetProgressShiftScale(0.0, 1.0);
  if (this->IsAborted())
  {
    output->CopyStructure(input); // not some blocks of a result
  }
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> vtkSPHAlgorithm::TakeParticles(vtkDataObject* data)
{
  vtkInternals& kept = *this->Internals;
  auto* tree = vtkDataObjectTree::SafeDownCast(data);
  if (!tree)
  {
    kept.Joined = nullptr;
    return vtkPointSet::SafeDownCast(data);
  }
  if (!kept.Joined || kept.JoinedFrom.GetPointer() != data ||
    vtkSPHTimeOfBlocks(tree) > kept.JoinedTime.GetMTime())
  {
    kept.Joined = vtkSPHJoinBlocks(tree);
    kept.JoinedFrom = data;
    kept.JoinedTime.Modified();
  }
  return kept.Joined;
}

//------------------------------------------------------------------------------
void vtkSPHAlgorithm::ProcessJoined(vtkDataObjectTree* input, vtkDataObject* output)
{
  const vtkSmartPointer<vtkPointSet> particles = this->TakeParticles(input);
  auto* tree = vtkDataObjectTree::SafeDownCast(output);
  if (!tree)
  {
    output->GetFieldData()->PassData(particles->GetFieldData());
    this->Process(particles, output);
    return;
  }
  auto made = vtkSmartPointer<vtkPointSet>::Take(particles->NewInstance());
  this->Process(particles, made);
  if (this->ErrorMessage.empty() && !this->IsAborted())
  {
    vtkSPHSplitBlocks(input, particles, made, tree);
  }
}

//------------------------------------------------------------------------------
void vtkSPHAlgorithm::FindFluid(vtkSPHParticlesChoice& choice, vtkPointSet* particles)
{
  if (this->DetectFluid)
  {
    vtkSPHParticles::FindFluid(choice, particles);
  }
}

#if MCOR_HAS_RANKS
//------------------------------------------------------------------------------
// All have the same arrays; what varies on one of them varies.
vtkSPHRequest vtkSPHAlgorithm::FindFirstRequestDistributed(
  vtkSPHRanks& ranks, vtkPointSet* particles)
{
  vtkSPHRequest request = this->FindRequest(0, particles);
  if (!request.Name.empty())
  {
    return request;
  }
  vtkPointData* data = particles->GetPointData();
  std::vector<double> ends; // least value, and minus the greatest, of each component
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    for (int c = 0; array && c < array->GetNumberOfComponents(); ++c)
    {
      double range[2] = { VTK_DOUBLE_MAX, VTK_DOUBLE_MIN };
      if (array->GetNumberOfTuples() > 0)
      {
        array->GetRange(range, c);
      }
      ends.insert(ends.end(), { range[0], -range[1] });
    }
  }
  ranks.Reduce(vtkSPHRanks::LEAST, ends.data(), static_cast<int>(ends.size()));
  vtkSPHArrayChoice all, active;
  const double* end = ends.data();
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    bool varies = false;
    for (int c = 0; array && c < array->GetNumberOfComponents(); ++c, end += 2)
    {
      varies = varies || end[0] < -end[1];
    }
    vtkSPHArrayChoice& choice = array && array == request.Array ? active : all;
    if (array && array->GetName())
    {
      choice.Consider(array->GetName(), array->GetNumberOfComponents(),
        array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE, varies);
    }
  }
  const std::string& best = active.Best.empty() ? all.Best : active.Best;
  if (!best.empty())
  {
    request.Array = data->GetAbstractArray(best.c_str());
  }
  return request;
}

//------------------------------------------------------------------------------
// All have the same arrays, or no particles.
void vtkSPHAlgorithm::FindFluidDistributed(
  vtkSPHRanks& ranks, vtkSPHParticlesChoice& choice, vtkPointSet* particles)
{
  const double none = std::numeric_limits<double>::infinity();
  for (const std::string& name :
    this->DetectFluid ? vtkSPHParticles::ListTypes(choice, particles) : std::vector<std::string>())
  {
    double ends[2] = { none, none };
    double range[2];
    if (vtkSPHParticles::FindWholeRange(particles, name, range))
    {
      ends[0] = range[0];
      ends[1] = -range[1];
    }
    else if (particles->GetNumberOfPoints() > 0)
    {
      ends[0] = -none;
    }
    ranks.Reduce(vtkSPHRanks::LEAST, ends, 2);
    if (mcor_find_fluid_value(name.c_str(), ends[0], -ends[1], &choice.FluidValue))
    {
      choice.FluidArrayName = name;
      return;
    }
  }
}
#endif

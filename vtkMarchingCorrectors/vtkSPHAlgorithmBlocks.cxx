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

#include <vector>

// Each block is a run that all processes take part in.
bool vtkSPHAlgorithm::AgreeOnBlocks(vtkDataObjectTree* blocks)
{
  bool good = true;
#if !MCOR_HAS_RANKS
  static_cast<void>(blocks);
#else
  vtkSPHRanks ranks(this->Controller);
  const double count = blocks ? static_cast<double>(vtkSPHNameBlocks(blocks).size()) : -1.0;
  double range[2] = { count, count };
  ranks.ReduceRanges(range, 1);
  good = range[0] == range[1];
#endif
  if (!good)
  {
    this->Fail("The processes have different numbers of blocks. Merge the blocks of each process.");
  }
  return good;
}

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

void vtkSPHAlgorithm::FindFluid(
  vtkSPHParticlesChoice& choice, vtkPointSet* particles, const vtkSPHMergeRanges& merge)
{
  if (this->DetectFluid)
  {
    vtkSPHParticles::FindFluid(choice, particles, merge);
  }
}

int vtkSPHAlgorithm::FindDimension(vtkPointSet* particles)
{
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    return this->FindDimensionDistributed(particles);
  }
#endif
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  return vtkSPHParticles(choice, particles).FindDimension(nullptr, this->Dimension);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHBlocks.h"

#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkInformation.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cctype>
#include <iterator>

namespace
{
using Blocks = std::vector<vtkPointSet*>;

/** The arrays of this name one after the other; nothing if a block lacks it. */
vtkSmartPointer<vtkAbstractArray> JoinArrays(
  const Blocks& blocks, vtkAbstractArray* first, vtkIdType total)
{
  auto joined = vtkSmartPointer<vtkAbstractArray>::Take(first->NewInstance());
  joined->SetName(first->GetName());
  joined->SetNumberOfComponents(first->GetNumberOfComponents());
  joined->CopyComponentNames(first);
  joined->SetNumberOfTuples(total);
  vtkIdType at = 0;
  for (vtkPointSet* block : blocks)
  {
    const vtkIdType count = block->GetNumberOfPoints();
    vtkAbstractArray* array = block->GetPointData()->GetAbstractArray(first->GetName());
    if (!array || array->GetDataType() != first->GetDataType() ||
      array->GetNumberOfComponents() != first->GetNumberOfComponents() ||
      array->GetNumberOfTuples() != count)
    {
      return nullptr;
    }
    joined->InsertTuples(at, count, 0, array);
    at += count;
  }
  return joined;
}
}

//------------------------------------------------------------------------------
std::vector<std::string> vtkSPHNameBlocks(vtkDataObjectTree* tree)
{
  std::vector<std::string> names;
  std::string whole; // of which the blocks up to index `last` are partitions
  unsigned int last = 0;
  vtkSmartPointer<vtkDataObjectTreeIterator> iterator;
  iterator.TakeReference(tree->NewTreeIterator());
  iterator->VisitOnlyLeavesOff();
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    const unsigned int index = iterator->GetCurrentFlatIndex();
    vtkInformation* about =
      iterator->HasCurrentMetaData() ? iterator->GetCurrentMetaData() : nullptr;
    const char* own = about ? about->Get(vtkCompositeDataSet::NAME()) : nullptr;
    if (auto* parts = vtkPartitionedDataSet::SafeDownCast(iterator->GetCurrentDataObject()))
    {
      whole = own ? own : "";
      last = index + parts->GetNumberOfPartitions();
    }
    else if (!iterator->GetCurrentDataObject()->IsA("vtkCompositeDataSet"))
    {
      const std::string name = own ? own : index <= last ? whole : "";
      names.push_back(
        "Block " + (name.empty() ? "" : "'" + name + "', ") + "index " + std::to_string(index));
    }
  }
  return names;
}

//------------------------------------------------------------------------------
std::vector<vtkPointSet*> vtkSPHListPointSets(vtkDataObject* data)
{
  Blocks found;
  const auto add = [&found](vtkDataObject* block)
  {
    auto* points = vtkPointSet::SafeDownCast(block);
    if (points && points->GetNumberOfPoints() > 0)
    {
      found.push_back(points);
    }
  };
  if (auto* tree = vtkDataObjectTree::SafeDownCast(data))
  {
    vtkSmartPointer<vtkDataObjectTreeIterator> iterator;
    iterator.TakeReference(tree->NewTreeIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
    {
      add(iterator->GetCurrentDataObject());
    }
  }
  add(data);
  return found;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> vtkSPHJoinBlocks(vtkDataObjectTree* tree)
{
  const Blocks blocks = vtkSPHListPointSets(tree);
  auto joined = vtkSmartPointer<vtkPolyData>::New();
  if (blocks.size() == 1)
  {
    return blocks.front();
  }
  vtkIdType total = 0;
  bool asDouble = false;
  for (vtkPointSet* block : blocks)
  {
    total += block->GetNumberOfPoints();
    asDouble = asDouble || block->GetPoints()->GetDataType() != VTK_FLOAT;
  }
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(asDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(total);
  vtkIdType at = 0;
  for (vtkPointSet* block : blocks)
  {
    points->InsertPoints(at, block->GetNumberOfPoints(), 0, block->GetPoints());
    at += block->GetNumberOfPoints();
  }
  joined->SetPoints(points);
  vtkPointData* first = blocks.empty() ? nullptr : blocks.front()->GetPointData();
  for (int i = 0; first && i < first->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = first->GetAbstractArray(i);
    const auto all = array->GetName() ? JoinArrays(blocks, array, total) : nullptr;
    if (all)
    {
      joined->GetPointData()->AddArray(all);
    }
  }
  return joined;
}

//------------------------------------------------------------------------------
std::string vtkSPHFindWalls(const std::vector<std::string>& names)
{
  std::size_t walls = 0;
  std::string first;
  for (const std::string& name : names)
  {
    std::string small = name;
    std::transform(small.begin(), small.end(), small.begin(),
      [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    const char* const words[] = { "wall", "bound", "solid", "obstacle", "rigid" };
    const bool isWall = std::any_of(std::begin(words), std::end(words),
      [&small](const char* word) { return small.find(word) != std::string::npos; });
    first = isWall && walls == 0 ? name : first;
    walls += isWall ? 1 : 0;
  }
  if (walls == 0 || walls == names.size())
  {
    return {};
  }
  return first + " of " + std::to_string(names.size()) +
    " seems to hold walls. Each block is contoured by itself, so that its particles are neither "
    "walls nor neighbours of the others'. Merge the blocks, and tell fluid from solids by an "
    "array.";
}

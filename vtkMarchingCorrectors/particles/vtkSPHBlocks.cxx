// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHBlocks.h"

#include "mcor_find.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHSay.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstddef>
#include <set>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Blocks = std::vector<vtkPointSet*>;

/**
 * Joins each block's array that has the name of `first`, one block after the other, as doubles if
 * their types differ. The points of a wall that lacks the array get the first tuple of `first`; but
 * if `first` is an array of particle types, walls must have it, too. Returns null if a block lacks
 * the array and must have it, or if a block's array of this name has another number of components or
 * tuples, or another type and one of the two does not hold numbers.
 */
vtkSmartPointer<vtkAbstractArray> JoinArrays(
  const Blocks& blocks, const std::vector<bool>& walls, vtkAbstractArray* first, vtkIdType total)
{
  const bool isType = mcor_name_priority(MCOR_PARTICLE_TYPE, first->GetName()) >= 0;
  std::vector<vtkAbstractArray*> arrays;
  int type = first->GetDataType();
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    arrays.push_back(blocks[b]->GetPointData()->GetAbstractArray(first->GetName()));
    vtkAbstractArray* array = arrays.back();
    const bool isLike = array &&
      (array->GetDataType() == first->GetDataType() || (array->IsNumeric() && first->IsNumeric()));
    const bool fits = array
      ? isLike && array->GetNumberOfComponents() == first->GetNumberOfComponents() &&
        array->GetNumberOfTuples() == blocks[b]->GetNumberOfPoints()
      : !walls.empty() && walls[b] && !isType;
    if (!fits)
    {
      return nullptr;
    }
    type = array && array->GetDataType() != type ? VTK_DOUBLE : type;
  }
  vtkSmartPointer<vtkAbstractArray> joined = vtkSPHMakeLike(first, total, type);
  vtkIdType at = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const vtkIdType count = blocks[b]->GetNumberOfPoints();
    if (arrays[b])
    {
      joined->InsertTuples(at, count, 0, arrays[b]);
    }
    for (vtkIdType i = at; !arrays[b] && i < at + count; ++i)
    {
      joined->InsertTuple(i, 0, first);
    }
    at += count;
  }
  return joined;
}

bool TellsOfWalls(const std::string& name)
{
  return mcor_tells_of_walls(name.c_str()) != 0;
}

/** A block and its name. */
struct Leaf
{
  vtkDataObject* Data; ///< null: the block is empty
  std::string Name;    ///< a partition without a name gets its data set's name; may be empty
  unsigned int Index;

  vtkPointSet* Points() const
  {
    auto* points = vtkPointSet::SafeDownCast(this->Data);
    return points && points->GetNumberOfPoints() > 0 ? points : nullptr;
  }

  /** Returns the value of the setting FluidArrayName that makes this block the fluid. */
  std::string FluidArray() const { return "Block: " + this->Name; }
};

std::vector<Leaf> ListLeaves(vtkDataObjectTree* tree)
{
  std::vector<Leaf> leaves;
  std::string whole; // name of the block whose partitions are the blocks up to index `last`
  unsigned int last = 0;
  const auto iterator = vtk::TakeSmartPointer(tree->NewTreeIterator());
  iterator->VisitOnlyLeavesOff();
  iterator->SkipEmptyNodesOff();
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    const unsigned int index = iterator->GetCurrentFlatIndex();
    vtkDataObject* data = iterator->GetCurrentDataObject();
    vtkInformation* about =
      iterator->HasCurrentMetaData() ? iterator->GetCurrentMetaData() : nullptr;
    const char* own = about ? about->Get(vtkCompositeDataSet::NAME()) : nullptr;
    if (auto* parts = vtkPartitionedDataSet::SafeDownCast(data))
    {
      whole = own ? own : "";
      last = index + parts->GetNumberOfPartitions();
    }
    else if (!data || !data->IsA("vtkCompositeDataSet"))
    {
      leaves.push_back({ data, own ? own : index <= last ? whole : "", index });
    }
  }
  return leaves;
}

/**
 * Returns, for each block with points, whether it is a wall. If `fluidArray` chooses blocks as
 * fluid, all other blocks are walls; else blocks are walls if their names tell of walls. Returns an
 * empty list if no block is a wall, or if all blocks are walls. Blocks without points count in this
 * decision, because a block may have its points on another process.
 */
std::vector<bool> MarkWalls(vtkDataObjectTree* tree, const std::string& fluidArray)
{
  const std::vector<std::string> choices = vtkSPHListFluidBlocks(tree);
  const bool isChosen = std::find(choices.begin(), choices.end(), fluidArray) != choices.end();
  std::vector<bool> walls;
  const std::vector<Leaf> leaves = ListLeaves(tree);
  std::size_t count = 0;
  for (const Leaf& leaf : leaves)
  {
    const bool isWall = isChosen ? leaf.FluidArray() != fluidArray : TellsOfWalls(leaf.Name);
    count += isWall ? 1 : 0;
    if (leaf.Points())
    {
      walls.push_back(isWall);
    }
  }
  return count > 0 && count < leaves.size() ? walls : std::vector<bool>();
}

/** Lists the data set itself and all blocks in it, at any depth. */
std::vector<vtkDataObject*> ListAll(vtkDataObjectTree* tree)
{
  std::vector<vtkDataObject*> all{ tree };
  const auto iterator = vtk::TakeSmartPointer(tree->NewTreeIterator());
  iterator->VisitOnlyLeavesOff();
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    all.push_back(iterator->GetCurrentDataObject());
  }
  return all;
}
}

std::vector<std::string> vtkSPHNameBlocks(vtkDataObjectTree* tree)
{
  std::vector<std::string> names;
  for (const Leaf& leaf : ListLeaves(tree))
  {
    if (leaf.Data)
    {
      names.push_back("Block " + (leaf.Name.empty() ? "" : "'" + leaf.Name + "', ") + "index " +
        std::to_string(leaf.Index));
    }
  }
  return names;
}

std::vector<vtkPointSet*> vtkSPHListPointSets(vtkDataObject* data)
{
  Blocks found;
  auto* tree = vtkDataObjectTree::SafeDownCast(data);
  for (const Leaf& leaf : tree ? ListLeaves(tree) : std::vector<Leaf>{ { data, "", 0 } })
  {
    if (leaf.Points())
    {
      found.push_back(leaf.Points());
    }
  }
  return found;
}

vtkMTimeType vtkSPHTimeOfBlocks(vtkDataObjectTree* tree)
{
  vtkMTimeType time = 0;
  for (vtkDataObject* each : ListAll(tree))
  {
    time = std::max(time, each->GetMTime());
  }
  return time;
}

std::vector<std::string> vtkSPHListFluidBlocks(vtkDataObjectTree* tree)
{
  std::vector<std::string> list;
  for (const Leaf& leaf : ListLeaves(tree))
  {
    const std::string choice = leaf.FluidArray();
    if (!leaf.Name.empty() && std::find(list.begin(), list.end(), choice) == list.end())
    {
      list.push_back(choice);
    }
  }
  return list.size() > 1 ? list : std::vector<std::string>();
}

vtkSmartPointer<vtkPointSet> vtkSPHJoinBlocks(
  vtkDataObjectTree* tree, const std::string& fluidArray)
{
  const Blocks blocks = vtkSPHListPointSets(tree);
  const std::vector<bool> walls = MarkWalls(tree, fluidArray);
  auto joined = vtkSmartPointer<vtkPolyData>::New();
  const bool asDouble = std::any_of(blocks.begin(), blocks.end(),
    [](vtkPointSet* block) { return block->GetPoints()->GetDataType() != VTK_FLOAT; });
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(asDouble ? VTK_DOUBLE : VTK_FLOAT);
  for (vtkPointSet* block : blocks)
  {
    points->InsertPoints(
      points->GetNumberOfPoints(), block->GetNumberOfPoints(), 0, block->GetPoints());
  }
  joined->SetPoints(points);
  const vtkIdType total = points->GetNumberOfPoints();
  for (vtkPointSet* block : blocks)
  {
    for (const auto& array : vtkSPHListArrays(block->GetPointData()))
    {
      const bool isNew = array->GetName() && !joined->GetPointData()->HasArray(array->GetName());
      if (const auto all = isNew ? JoinArrays(blocks, walls, array, total) : nullptr)
      {
        joined->GetPointData()->AddArray(all);
      }
    }
  }
  if (!walls.empty())
  {
    auto marks = vtkSmartPointer<vtkUnsignedCharArray>::New();
    marks->SetName(MCOR_WALL_BLOCK);
    for (std::size_t b = 0; b < blocks.size(); ++b)
    {
      const vtkIdType count = blocks[b]->GetNumberOfPoints();
      std::fill_n(marks->WritePointer(marks->GetNumberOfValues(), count), count, walls[b] ? 1 : 0);
    }
    joined->GetPointData()->AddArray(marks);
  }
  std::vector<vtkDataObject*> all = ListAll(tree);
  std::reverse(all.begin(), all.end()); // so that the first of several arrays with one name stays
  for (vtkDataObject* each : all)
  {
    joined->GetFieldData()->PassData(each->GetFieldData());
  }
  return joined;
}

std::string vtkSPHDescribeLost(vtkDataObject* blocks, vtkPointSet* joined)
{
  std::set<std::string> lost;
  for (vtkPointSet* block : vtkSPHListPointSets(blocks))
  {
    for (const auto& array : vtkSPHListArrays(block->GetPointData()))
    {
      if (array->GetName() && !joined->GetPointData()->HasArray(array->GetName()))
      {
        lost.insert(array->GetName());
      }
    }
  }
  lost.erase(vtkDataSetAttributes::GhostArrayName());
  std::string names;
  for (const std::string& name : lost)
  {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names.empty() ? names : vtkSPHSay(MCOR_SAY(ARRAYS_NOT_SHARED), names.c_str());
}

void vtkSPHSplitBlocks(
  vtkDataObjectTree* tree, vtkPointSet* before, vtkPointSet* joined, vtkDataObjectTree* output)
{
  output->CopyStructure(tree);
  vtkPointData* made = joined->GetPointData();
  vtkIdType at = 0;
  const auto iterator = vtk::TakeSmartPointer(tree->NewTreeIterator());
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    auto* block = vtkPointSet::SafeDownCast(iterator->GetCurrentDataObject());
    if (!block)
    {
      continue;
    }
    auto copy = vtkSmartPointer<vtkPointSet>::Take(block->NewInstance());
    copy->ShallowCopy(block);
    const vtkIdType count = block->GetNumberOfPoints();
    for (const auto& from : vtkSPHListArrays(count > 0 ? made : nullptr))
    {
      if (from->GetName() && before->GetPointData()->GetAbstractArray(from->GetName()) != from)
      {
        const vtkSmartPointer<vtkAbstractArray> part = vtkSPHMakeLike(from, count);
        part->InsertTuples(0, count, at, from);
        copy->GetPointData()->AddArray(part);
      }
    }
    at += count;
    output->SetDataSet(iterator, copy);
  }
}

std::string vtkSPHFindWalls(const std::vector<std::string>& names)
{
  const auto walls = std::count_if(names.begin(), names.end(), TellsOfWalls);
  if (walls == 0 || walls == static_cast<std::ptrdiff_t>(names.size()))
  {
    return {};
  }
  return vtkSPHSay(MCOR_SAY(WALLS_IN_BLOCK),
    std::find_if(names.begin(), names.end(), TellsOfWalls)->c_str(),
    static_cast<int>(names.size()));
}
VTK_ABI_NAMESPACE_END

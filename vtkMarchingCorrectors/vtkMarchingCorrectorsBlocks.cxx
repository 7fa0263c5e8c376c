// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsBlocks.h"

#include "vtkCompositeDataSet.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkInformation.h"
#include "vtkPartitionedDataSet.h"
#include "vtkSmartPointer.h"

std::vector<std::string> vtkMarchingCorrectorsNameBlocks(vtkDataObjectTree* tree)
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

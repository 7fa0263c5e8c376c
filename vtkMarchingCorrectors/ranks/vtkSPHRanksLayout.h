// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: which point arrays particles have on all ranks.
 */
#ifndef vtkSPHRanksLayout_h
#define vtkSPHRanksLayout_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstdint>
#include <string>
#include <vector>

class vtkAbstractArray;
class vtkPointData;
class vtkPolyData;
class vtkSPHRanks;

/** What a point array is, but for its values. */
struct vtkSPHRanksForm
{
  std::string Name;
  int Type;
  int Attribute; // of vtkDataSetAttributes, or -1
  std::vector<std::string> Components;
  bool HasLabels;

  bool IsLike(const vtkSPHRanksForm& other) const
  {
    return this->Name == other.Name && this->Type == other.Type &&
      this->Components.size() == other.Components.size();
  }

  bool operator==(const vtkSPHRanksForm& other) const
  {
    return this->IsLike(other) && this->Attribute == other.Attribute &&
      this->HasLabels == other.HasLabels && this->Components == other.Components;
  }
};

struct vtkSPHRanksLayout
{
  std::int64_t Points = 0;
  std::int64_t IsDouble = 0;
  std::vector<vtkSPHRanksForm> Forms;
};

/** Of the arrays with so many tuples that have a name, but for vtkGhostType. */
vtkSPHRanksLayout vtkSPHDescribeArrays(vtkPointData* arrays, vtkIdType count);
vtkSPHRanksLayout vtkSPHDescribe(vtkPolyData* particles);

/** What all ranks that have particles have. Collective. */
vtkSPHRanksLayout vtkSPHAgreeOnLayout(vtkSPHRanks& ranks, const vtkSPHRanksLayout& mine);

/** Arrays of so many tuples, without values yet. */
void vtkSPHAddArrays(vtkPointData* data, const vtkSPHRanksLayout& layout, vtkIdType count);
vtkSmartPointer<vtkAbstractArray> vtkSPHMakeArray(const vtkSPHRanksForm& form, vtkIdType count);
vtkSmartPointer<vtkPolyData> vtkSPHMakeParticles(const vtkSPHRanksLayout& layout, vtkIdType count);

#endif

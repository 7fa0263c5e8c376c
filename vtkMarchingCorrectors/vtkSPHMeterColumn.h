// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: columns of the tables of vtkSPHMeter.
 */
#ifndef vtkSPHMeterColumn_h
#define vtkSPHMeterColumn_h

#include "vtkNew.h"
#include "vtkTable.h"

VTK_ABI_NAMESPACE_BEGIN
template <typename ArrayT>
ArrayT* vtkSPHAddColumn(vtkTable* table, const char* name, vtkIdType rows)
{
  vtkNew<ArrayT> column;
  column->SetName(name);
  column->SetNumberOfTuples(rows);
  table->AddColumn(column);
  return column;
}
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ComponentRun.h"

#include "Job.h"
#include "MessageCapture.h"
#include "SurfaceRun.h"
#include "TableText.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkSPHComponents.h"
#include "vtkTable.h"

#include <stdexcept>

namespace
{

double SumOf(vtkTable* table, const char* column)
{
  auto* numbers = vtkDoubleArray::SafeDownCast(table->GetColumnByName(column));
  double sum = 0.0;
  for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i)
  {
    sum += numbers->GetValue(i);
  }
  return sum;
}

void SetNumber(vtkFieldData* statistics, const char* name, double value)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  statistics->AddArray(array);
}

/// Adds the number of pieces. If some are left out, area and volume are those of the others.
void AddNumbers(vtkFieldData* statistics, vtkTable* pieces, bool isWhole)
{
  SetNumber(statistics, "Pieces", static_cast<double>(pieces->GetNumberOfRows()));
  for (const char* name : { "Area", "Volume" })
  {
    if (!isWhole && statistics->HasArray(name))
    {
      SetNumber(statistics, name, SumOf(pieces, name[0] == 'A' ? "area" : "volume"));
    }
  }
}

}

// Particles count as the surface was told of them.
void ComponentTable::Add(Run& run, vtkPointSet* particles, MessageCapture* messages, double time)
{
  if (this->Options->ComponentFile.empty())
  {
    return;
  }
  if (run.Surface->GetNumberOfLines() > 0)
  {
    throw std::runtime_error(
      "--components is for surfaces, but particles in a plane give lines; leave it out");
  }
  vtkMarchingCorrectors* surface = this->Options->Surface;
  vtkNew<vtkSPHComponents> split;
  split->SetInputData(run.Surface);
  split->SetParticlesData(surface->TakePresent(particles));
  if (!surface->GetCapping()) // caps end pieces
  {
    split->SetPeriodicBounds(surface->GetPeriodicBounds());
  }
  split->SetMassArrayName(surface->GetMassArrayName());
  split->SetMass(surface->GetMass());
  split->SetFluidArrayName(surface->GetFluidArrayName());
  split->SetFluidValue(surface->GetFluidValue());
  split->SetLeastVolume(this->Options->LeastVolume);
  split->SetLeastParticles(this->Options->LeastParticles);
  split->Update();
  if (!messages->GetErrors().empty())
  {
    throw std::runtime_error(messages->GetErrors().front());
  }
  vtkTable* pieces = split->GetTable();
  const bool isWhole = this->Options->LeastVolume == 0.0 && this->Options->LeastParticles == 0;
  run.Surface->ShallowCopy(split->GetOutput());
  AddNumbers(run.Statistics, pieces, isWhole);
  vtkNew<vtkTable> table;
  if (this->Options->IsFilm())
  {
    vtkNew<vtkDoubleArray> times;
    times->SetName("time");
    times->SetNumberOfTuples(pieces->GetNumberOfRows());
    times->FillValue(time);
    table->AddColumn(times);
  }
  for (vtkIdType c = 0; c < pieces->GetNumberOfColumns(); ++c)
  {
    table->AddColumn(pieces->GetColumn(c));
  }
  this->Lines += (this->Lines.empty() ? TableHeader(table) : "") + TableRows(table);
}

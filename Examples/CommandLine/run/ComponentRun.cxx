// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ComponentRun.h"

#include "Job.h"
#include "MessageCapture.h"
#include "SurfaceRun.h"
#include "TableText.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkSPHComponents.h"
#include "vtkTable.h"

#include <stdexcept>

//------------------------------------------------------------------------------
// Of the particles as the surface was told of them.
void ComponentTable::Add(Run& run, vtkPointSet* particles, MessageCapture* messages, double time)
{
  if (this->Options.ComponentFile.empty())
  {
    return;
  }
  vtkMarchingCorrectors* surface = this->Options.Surface;
  vtkNew<vtkSPHComponents> split;
  split->SetInputData(run.Surface);
  split->SetParticlesData(particles);
  if (!surface->GetCapping()) // caps end pieces
  {
    split->SetPeriodicBounds(surface->GetPeriodicBounds());
  }
  split->SetMassArrayName(surface->GetMassArrayName());
  split->SetMass(surface->GetMass());
  split->SetFluidArrayName(surface->GetFluidArrayName());
  split->SetFluidValue(surface->GetFluidValue());
  split->SetLeastVolume(this->Options.LeastVolume);
  split->SetLeastParticles(this->Options.LeastParticles);
  split->Update();
  if (!messages->GetErrors().empty())
  {
    throw std::runtime_error(messages->GetErrors().front());
  }
  run.Surface->ShallowCopy(split->GetOutput());
  vtkTable* pieces = split->GetTable();
  vtkNew<vtkTable> table;
  if (this->Options.IsFilm())
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

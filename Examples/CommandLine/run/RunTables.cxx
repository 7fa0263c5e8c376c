// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Runs.h"

#include "DataFile.h"
#include "Job.h"
#include "MessageCapture.h"
#include "Sharing.h"

#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkSPHComponents.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <limits>
#include <stdexcept>

namespace
{

/// Adds an array of one number, to statistics or a table's row.
void AddNumber(vtkFieldData* data, const std::string& name, double value)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name.c_str());
  array->InsertNextValue(value);
  data->AddArray(array);
}

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

}

// Describes the particles to the filter of pieces as to that of the surface.
void AddPieces(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time)
{
  const Job& job = sharing.Options;
  if (job.ComponentFile.empty())
  {
    return;
  }
  if (run.Surface->GetNumberOfLines() > 0)
  {
    throw std::runtime_error(
      "--components is for surfaces, but particles in a plane give lines; leave it out");
  }
  vtkMarchingCorrectors* surface = job.Surface;
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
  split->SetLeastVolume(job.LeastVolume);
  split->SetLeastParticles(job.LeastParticles);
  split->Update();
  sharing.Messages->Check();
  vtkTable* pieces = split->GetTable();
  run.Surface->ShallowCopy(split->GetOutput());
  AddNumber(run.Statistics, "Pieces", static_cast<double>(pieces->GetNumberOfRows()));
  for (const char* name : { "Area", "Volume" }) // those of the pieces that are left
  {
    if ((job.LeastVolume > 0.0 || job.LeastParticles > 0) && run.Statistics->HasArray(name))
    {
      AddNumber(run.Statistics, name, SumOf(pieces, name[0] == 'A' ? "area" : "volume"));
    }
  }
  vtkNew<vtkTable> table;
  if (job.IsFilm())
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
  AppendTable(text, table);
}

void AddFilmNumbers(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time)
{
  const Job& job = sharing.Options;
  if (job.NumbersFile.empty())
  {
    return;
  }
  const auto numberOf = [&run](const char* name)
  {
    vtkDataArray* array = run.Statistics->GetArray(name);
    return array ? array->GetComponent(0, 0) : std::numeric_limits<double>::quiet_NaN();
  };
  vtkNew<vtkTable> table;
  vtkFieldData* row = table->GetRowData();
  AddNumber(row, "time", time);
  AddNumber(row, "triangles", static_cast<double>(run.Surface->GetNumberOfPolys()));
  const bool hasRun = run.Statistics->HasArray("Triangles"); // else there is no fluid
  AddNumber(row, "area", hasRun ? numberOf("Area") : 0.0);
  AddNumber(row, "volume", hasRun ? numberOf("Volume") : 0.0);
  if (!job.ComponentFile.empty())
  {
    AddNumber(row, "pieces", numberOf("Pieces"));
  }
  if (job.Gauge->GetNumberOfGauges() > 0)
  {
    vtkTable* gauges = MeasureWith(job.Gauge, sharing, particles, time, "");
    sharing.Messages->AppendWarnings(run.Warnings);
    for (vtkIdType i = 0; i < gauges->GetNumberOfRows(); ++i)
    {
      const std::string name = gauges->GetValueByName(i, "gauge").ToString();
      for (const char* what : { "last", "depth", "crossings" })
      {
        AddNumber(row, name + "." + what, gauges->GetValueByName(i, what).ToDouble());
      }
    }
  }
  AppendTable(text, table);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Runs.h"

#include "DataFile.h"
#include "Job.h"
#include "MessageCapture.h"

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

/// Adds the number of pieces. If some are left out, area and volume are those of the others.
void AddNumbers(vtkFieldData* statistics, vtkTable* pieces, bool isWhole)
{
  AddNumber(statistics, "Pieces", static_cast<double>(pieces->GetNumberOfRows()));
  for (const char* name : { "Area", "Volume" })
  {
    if (!isWhole && statistics->HasArray(name))
    {
      AddNumber(statistics, name, SumOf(pieces, name[0] == 'A' ? "area" : "volume"));
    }
  }
}

}

// Describes the particles to the filter of pieces as to that of the surface.
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
  messages->Check();
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

FilmNumbers::FilmNumbers(const Job& job)
  : Options(job)
{
  if (!job.NumbersFile.empty())
  {
    AddGauges(job);
  }
}

void FilmNumbers::Add(const Run& run, vtkPointSet* particles, MessageCapture* messages, double time,
  std::vector<std::string>& warnings)
{
  if (this->Options.NumbersFile.empty())
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
  if (!this->Options.ComponentFile.empty())
  {
    AddNumber(row, "pieces", numberOf("Pieces"));
  }
  if (this->Options.Gauge->GetNumberOfGauges() > 0)
  {
    vtkTable* gauges =
      MeasureWith(this->Options.Gauge, this->Options, particles, time, messages, "");
    messages->AppendWarnings(warnings);
    for (vtkIdType i = 0; i < gauges->GetNumberOfRows(); ++i)
    {
      const std::string name = gauges->GetValueByName(i, "gauge").ToString();
      for (const char* what : { "last", "depth", "crossings" })
      {
        AddNumber(row, name + "." + what, gauges->GetValueByName(i, what).ToDouble());
      }
    }
  }
  this->Lines += (this->Lines.empty() ? TableHeader(table) : "") + TableRows(table);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "FilmNumbers.h"

#include "GaugeRun.h"
#include "Job.h"
#include "MessageCapture.h"
#include "MeterRun.h"
#include "SurfaceRun.h"
#include "TableText.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <limits>

namespace
{

void AddNumber(vtkTable* row, const std::string& name, double value)
{
  vtkNew<vtkDoubleArray> column;
  column->SetName(name.c_str());
  column->InsertNextValue(value);
  row->AddColumn(column);
}

/// Returns one number of a run's statistics; NaN if it does not apply.
double NumberOf(vtkFieldData* statistics, const char* name)
{
  vtkDataArray* array = statistics->GetArray(name);
  return array ? array->GetComponent(0, 0) : std::numeric_limits<double>::quiet_NaN();
}

}

FilmNumbers::FilmNumbers(const Job& job)
  : Options(job)
{
  if (!job.NumbersFile.empty())
  {
    AddGauges(job, ListGauges(job));
  }
}

void FilmNumbers::Add(const Run& run, vtkPointSet* particles, MessageCapture* messages, double time,
  std::vector<std::string>& warnings)
{
  if (this->Options.NumbersFile.empty())
  {
    return;
  }
  vtkNew<vtkTable> row;
  AddNumber(row, "time", time);
  AddNumber(row, "triangles", static_cast<double>(run.Surface->GetNumberOfPolys()));
  const bool hasRun = run.Statistics->HasArray("Triangles"); // else there is no fluid
  AddNumber(row, "area", hasRun ? NumberOf(run.Statistics, "Area") : 0.0);
  AddNumber(row, "volume", hasRun ? NumberOf(run.Statistics, "Volume") : 0.0);
  if (!this->Options.ComponentFile.empty())
  {
    AddNumber(row, "pieces", NumberOf(run.Statistics, "Pieces"));
  }
  if (this->Options.Gauge->GetNumberOfGauges() > 0)
  {
    vtkTable* gauges =
      MeasureWith(this->Options.Gauge, this->Options, particles, time, messages, "");
    const std::vector<std::string> more = messages->GetWarnings();
    warnings.insert(warnings.end(), more.begin(), more.end());
    for (vtkIdType i = 0; i < gauges->GetNumberOfRows(); ++i)
    {
      const std::string name = gauges->GetValueByName(i, "gauge").ToString();
      for (const char* what : { "last", "depth", "crossings" })
      {
        AddNumber(row, name + "." + what, gauges->GetValueByName(i, what).ToDouble());
      }
    }
  }
  this->Lines += (this->Lines.empty() ? TableHeader(row) : "") + TableRows(row);
}

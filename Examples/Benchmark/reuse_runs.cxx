// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Times one filter whose iso value and scalar change, against a new filter for each change.
//
//   benchmark-reuse PARTICLES.vtp REPETITIONS DEVICE SCALAR ISO ISO SCALAR ISO
//
// First scalar with its two iso values, second scalar with one; DEVICE may be "". Writes JSON: for
// each step the seconds of all repetitions with one filter and with a new one, and of these the
// search grid and the seeds. Fails if reuse changes the surface.
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataReader.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace
{

/// Seconds of all repetitions: of Update(), and of two phases.
struct Times
{
  std::vector<double> All, Grid, Seeds;
};

struct Step
{
  const char* Name;
  const char* Scalar;
  double Iso;
  Times Reused, Fresh;
};

double PhaseSeconds(vtkMarchingCorrectors* filter, const char* phase)
{
  vtkDataArray* seconds = filter->GetRunStatistics()->GetArray("Seconds");
  for (int i = 0; i < seconds->GetNumberOfComponents(); ++i)
  {
    if (std::strcmp(seconds->GetComponentName(i), phase) == 0)
    {
      return seconds->GetComponent(0, i);
    }
  }
  return 0.0;
}

/// Updates and adds the seconds; false where that fails.
bool Extract(vtkMarchingCorrectors* filter, const Step& step, Times& times)
{
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, step.Scalar);
  filter->SetValue(0, step.Iso);
  const auto begin = std::chrono::steady_clock::now();
  filter->Update();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  if (std::strlen(filter->GetErrorMessage()) > 0 || filter->GetOutput()->GetNumberOfCells() == 0)
  {
    std::fprintf(stderr, "benchmark-reuse: no surface: %s\n", filter->GetErrorMessage());
    return false;
  }
  times.All.push_back(seconds.count());
  times.Grid.push_back(PhaseSeconds(filter, "search grid"));
  times.Seeds.push_back(PhaseSeconds(filter, "seeds"));
  return true;
}

bool SamePoints(vtkPolyData* a, vtkPolyData* b)
{
  if (a->GetNumberOfPoints() != b->GetNumberOfPoints() ||
    a->GetNumberOfCells() != b->GetNumberOfCells())
  {
    return false;
  }
  double p[3], q[3];
  for (vtkIdType i = 0; i < a->GetNumberOfPoints(); ++i)
  {
    a->GetPoint(i, p);
    b->GetPoint(i, q);
    if (p[0] != q[0] || p[1] != q[1] || p[2] != q[2])
    {
      return false;
    }
  }
  return true;
}

/// All steps with one filter, each of them with a new filter too. False where one fails.
bool RunSteps(std::vector<Step>& steps, vtkPolyData* particles, const char* device)
{
  vtkNew<vtkMarchingCorrectors> reused;
  reused->SetDevice(device);
  reused->SetInputData(particles);
  for (Step& step : steps)
  {
    vtkNew<vtkMarchingCorrectors> fresh;
    fresh->SetDevice(device);
    fresh->SetInputData(particles);
    if (!Extract(reused, step, step.Reused) || !Extract(fresh, step, step.Fresh))
    {
      return false;
    }
    if (!SamePoints(reused->GetOutput(), fresh->GetOutput()))
    {
      std::fprintf(stderr, "benchmark-reuse: %s: reuse changes the surface\n", step.Name);
      return false;
    }
  }
  return true;
}

void WriteList(const char* name, const std::vector<double>& values, const char* end)
{
  std::printf("\"%s\": [", name);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    std::printf("%s%.6g", i ? ", " : "", values[i]);
  }
  std::printf("]%s", end);
}

void WriteTimes(const char* name, const Times& times, const char* end)
{
  std::printf("\"%s\": {", name);
  WriteList("all", times.All, ", ");
  WriteList("grid", times.Grid, ", ");
  WriteList("seeds", times.Seeds, "}");
  std::printf("%s", end);
}

}

int main(int argc, char* argv[])
{
  if (argc != 9)
  {
    std::fprintf(stderr,
      "usage: benchmark-reuse PARTICLES.vtp REPETITIONS DEVICE SCALAR ISO ISO SCALAR ISO\n");
    return 2;
  }
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(argv[1]);
  reader->Update();
  std::vector<Step> steps = { { "first run", argv[4], std::atof(argv[5]), {}, {} },
    { "other iso value", argv[4], std::atof(argv[6]), {}, {} },
    { "first iso value again", argv[4], std::atof(argv[5]), {}, {} },
    { "other scalar", argv[7], std::atof(argv[8]), {}, {} } };
  for (int i = 0; i < std::atoi(argv[2]); ++i)
  {
    if (!RunSteps(steps, reader->GetOutput(), argv[3]))
    {
      return 1;
    }
  }
  std::printf("{\"steps\": [");
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    std::printf("%s{\"name\": \"%s\", ", i ? ", " : "", steps[i].Name);
    WriteTimes("reused", steps[i].Reused, ", ");
    WriteTimes("fresh", steps[i].Fresh, "}");
  }
  std::printf("]}\n");
  return 0;
}

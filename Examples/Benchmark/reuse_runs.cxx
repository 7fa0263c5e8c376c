// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Times one filter whose iso value and scalar change, against a new filter for each change.
//
//   benchmark-reuse PARTICLES.vtp REPETITIONS DEVICE SCALAR ISO ISO SCALAR ISO
//
// First scalar with its two iso values, second scalar with one; DEVICE may be "". Writes JSON: for
// each step the seconds of all repetitions with one filter and with a new one, and those of the
// search grid with one filter. Fails if reuse changes the surface.
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

struct Step
{
  const char* Name;
  const char* Scalar;
  double Iso;
  std::vector<double> Reused, Fresh, ReusedGrid;
};

/// Seconds of Update(); below 0 where it fails.
double Extract(vtkMarchingCorrectors* filter, const Step& step)
{
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, step.Scalar);
  filter->SetValue(0, step.Iso);
  const auto begin = std::chrono::steady_clock::now();
  filter->Update();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  const bool good =
    std::strlen(filter->GetErrorMessage()) == 0 && filter->GetOutput()->GetNumberOfCells() > 0;
  return good ? seconds.count() : -1.0;
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
    step.Reused.push_back(Extract(reused, step));
    step.Fresh.push_back(Extract(fresh, step));
    if (step.Reused.back() < 0.0 || step.Fresh.back() < 0.0)
    {
      std::fprintf(stderr, "benchmark-reuse: no surface: %s\n", reused->GetErrorMessage());
      return false;
    }
    vtkDataArray* seconds = reused->GetOutput()->GetFieldData()->GetArray("Seconds");
    for (int i = 0; i < seconds->GetNumberOfComponents(); ++i)
    {
      if (std::strcmp(seconds->GetComponentName(i), "search grid") == 0)
      {
        step.ReusedGrid.push_back(seconds->GetComponent(0, i));
      }
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
  std::vector<Step> steps = { { "first run", argv[4], std::atof(argv[5]), {}, {}, {} },
    { "other iso value", argv[4], std::atof(argv[6]), {}, {}, {} },
    { "other scalar", argv[7], std::atof(argv[8]), {}, {}, {} },
    { "first scalar and iso value again", argv[4], std::atof(argv[5]), {}, {}, {} } };
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
    WriteList("reused", steps[i].Reused, ", ");
    WriteList("fresh", steps[i].Fresh, ", ");
    WriteList("reused_grid", steps[i].ReusedGrid, "}");
  }
  std::printf("]}\n");
  return 0;
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Run by mpirun: what ranks find together at points, and at the particles themselves, is bit for bit
// what rank 0 finds alone, however particles and points are strewn over the ranks.
//
//   TestRankSamples FOLDER OF DATA [some]     some: of each case one partition, all of them in turn
#include "RankParts.h"

#include "vtkDataArray.h"
#include "vtkIdTypeArray.h"
#include "vtkMPIController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHDerivatives.h"
#include "vtkSPHProbe.h"

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace
{

const char* const IndexName = "TestIndex";

using Data = vtkSmartPointer<vtkPolyData>;

/// Runs a filter on particles and points.
using Run = std::function<Data(vtkPolyData*, vtkPolyData*, vtkMultiProcessController*)>;

struct Case
{
  const char* Name;
  const char* File;
  bool IsPlane; // the points lie in a plane
  int Constant; // the particles are moved into a plane across this axis; -1: they are not
  Run Do;
};

const char* const Dams = "double_dam_break_small"; // a small one, and one with walls and smoothing lengths that differ
const char* const Dam = "dam_break_45k";

Case Probe(const char* name, const char* file, bool isPlane, int constant, void (*setUp)(vtkSPHProbe*))
{
  return { name, file, isPlane, constant,
    [=](vtkPolyData* particles, vtkPolyData* points, vtkMultiProcessController* controller)
    {
      vtkNew<vtkSPHProbe> probe;
      setUp(probe);
      probe->SetController(controller);
      probe->SetInputData(points);
      probe->SetSourceData(particles);
      probe->Update();
      return Data(vtkPolyData::SafeDownCast(probe->GetOutput()));
    } };
}

Case Derive(const char* name, const char* file, const char* array, int constant, void (*setUp)(vtkSPHDerivatives*))
{
  return { name, file, false, constant,
    [=](vtkPolyData* particles, vtkPolyData*, vtkMultiProcessController* controller)
    {
      vtkNew<vtkSPHDerivatives> filter;
      setUp(filter);
      filter->SetController(controller);
      filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, array);
      filter->ComputeStrainRateOn();
      filter->SetInputData(particles);
      filter->Update();
      return Data(vtkPolyData::SafeDownCast(filter->GetOutput()));
    } };
}

const std::vector<Case> Cases = {
  Probe("probe, plane", Dams, true, -1, [](vtkSPHProbe* probe) { probe->ComputeGradientsOn(); }),
  Probe("probe, sum, computed volumes, M'4", Dams, false, -1,
    [](vtkSPHProbe* probe)
    {
      probe->ShepardNormalizationOff();
      probe->DetectArraysOff();
      probe->SetSmoothingLength(0.06);
      probe->SetKernelToMPrime4();
      probe->SetHScaleFactor(0.9);
    }),
  Probe("probe, solids, smoothing lengths that differ, double precision", Dam, false, -1,
    [](vtkSPHProbe* probe)
    {
      probe->SetSmoothingLengthArrayName("SmoothingLengthAdaptive");
      probe->SetFluidArrayName("ParticleType");
      probe->SetPrecision(vtkAlgorithm::DOUBLE_PRECISION);
      probe->ComputeGradientsOn();
    }),
  Probe("probe, periods", Dams, false, -1,
    [](vtkSPHProbe* probe)
    {
      probe->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5);
      probe->ComputeGradientsOn();
    }),
  Probe("probe, two dimensions, periods, also across the plane", Dams, false, 1,
    [](vtkSPHProbe* probe)
    {
      probe->DetectArraysOff();
      probe->SetSmoothingLength(0.06);
      probe->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.6, -1.0, 0.5);
      probe->ComputeGradientsOn();
    }),
  Derive("derivatives", Dams, "Velocity", -1, [](vtkSPHDerivatives*) {}),
  Derive("derivatives, periods, computed volumes", Dams, "Velocity", -1,
    [](vtkSPHDerivatives* filter)
    {
      filter->SetPeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5);
      filter->DetectArraysOff();
      filter->SetSmoothingLength(0.06);
    }),
  Derive("derivatives, estimated smoothing length, computed volumes", Dams, "Speed", -1,
    [](vtkSPHDerivatives* filter)
    {
      filter->CorrectGradientsOff();
      filter->DetectArraysOff();
      filter->EstimateSmoothingLengthOn();
    }),
  Derive("derivatives, solids, smoothing lengths that differ", Dam, "Velocity", -1,
    [](vtkSPHDerivatives* filter)
    {
      filter->SetSmoothingLengthArrayName("SmoothingLengthAdaptive");
      filter->SetFluidArrayName("ParticleType");
    }),
  Derive("derivatives, two dimensions, estimated smoothing length", Dams, "Velocity", 2,
    [](vtkSPHDerivatives* filter)
    {
      filter->DetectArraysOff();
      filter->EstimateSmoothingLengthOn();
      filter->ComputeLambda2On();
    }),
};

/// Numbers the points, so that they are known wherever they go.
void AddIndex(vtkPolyData* data)
{
  vtkNew<vtkIdTypeArray> index;
  index->SetName(IndexName);
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    index->InsertNextValue(i);
  }
  data->GetPointData()->AddArray(index);
}

/// Reads particles, and moves them into a plane as Case::Constant says.
Data Read(const std::string& file, int constant)
{
  Data data = ReadParticles(file);
  AddIndex(data);
  for (vtkIdType i = 0; constant >= 0 && i < data->GetNumberOfPoints(); ++i)
  {
    double at[3];
    data->GetPoint(i, at);
    at[constant] = 0.7;
    data->GetPoints()->SetPoint(i, at);
  }
  return data;
}

/// A lattice somewhat larger than the particles' bounds, with points that are nowhere; where they lie in a plane,
/// most points do, too.
Data MakePoints(vtkPolyData* particles, const Case& tried)
{
  auto data = Data::New();
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  double bounds[6];
  particles->GetBounds(bounds);
  const int counts[3] = { 31, 29, tried.IsPlane ? 1 : 27 };
  for (int k = 0; k < counts[0] * counts[1] * counts[2]; ++k)
  {
    const int cell[3] = { k % counts[0], k / counts[0] % counts[1], k / counts[0] / counts[1] };
    double at[3];
    for (int a = 0; a < 3; ++a)
    {
      const double share = counts[a] == 1 ? 0.25 : 1.2 * cell[a] / (counts[a] - 1) - 0.1;
      at[a] = bounds[2 * a] + share * (bounds[2 * a + 1] - bounds[2 * a]);
    }
    if (tried.Constant >= 0 && k % 7 == 3)
    {
      at[tried.Constant] += 0.01 * (k % 5);
    }
    at[1] = k % 501 == 7 ? std::numeric_limits<double>::quiet_NaN() : at[1];
    points->InsertNextPoint(at);
  }
  data->SetPoints(points);
  AddIndex(data);
  return data;
}

/// Returns whether a result has anything but zeros.
bool HasNonZeros(vtkPolyData* whole)
{
  vtkDataArray* valid = whole->GetPointData()->GetArray("vtkValidPointMask");
  vtkDataArray* found = valid ? valid : whole->GetPointData()->GetArray("Gradients");
  int others = 0;
  for (vtkIdType i = 0; found && i < found->GetNumberOfTuples(); ++i)
  {
    others += found->GetComponent(i, 0) != 0.0 ? 1 : 0;
  }
  return others > 50;
}

/// Compares this partition's result with the whole. Returns on how many ranks they differ.
int CheckPart(const Case& tried, int part, vtkPolyData* particles, vtkPolyData* points,
  vtkPolyData* whole, vtkMPIController* controller)
{
  const int rank = controller->GetLocalProcessId(), count = controller->GetNumberOfProcesses();
  const bool isProbe = std::string(tried.Name).find("probe") == 0;
  const Data own = TakePart(particles, part, rank, count);
  const Data at = TakePart(points, (part + 2) % (PartCount - 1), rank, count);
  vtkPolyData* given = isProbe ? at : own;
  const Data result = tried.Do(own, at, controller);
  std::vector<int> seen(static_cast<std::size_t>(whole->GetNumberOfPoints()), 0), all = seen;
  const std::string problem = result && result->GetNumberOfPoints() == given->GetNumberOfPoints()
    ? ComparePoints(result, given->GetPointData()->GetArray(IndexName), given, whole, seen)
    : "points are missing";
  controller->AllReduce(
    seen.data(), all.data(), whole->GetNumberOfPoints(), vtkCommunicator::SUM_OP);
  const bool isGood = problem.empty() && all == std::vector<int>(all.size(), 1);
  if (!isGood || rank == 0)
  {
    std::printf("%s, %s: %s\n", tried.Name, PartName(part),
      isGood ? "same" : ("rank " + std::to_string(rank) + ": " + problem).c_str());
    std::fflush(stdout);
  }
  return isGood ? 0 : 1;
}

int Check(int number, bool some, const std::string& folder, vtkMPIController* controller)
{
  const Case& tried = Cases[static_cast<std::size_t>(number)];
  const Data particles = Read(folder + "/" + tried.File + ".vtp", tried.Constant);
  const Data points = MakePoints(particles, tried);
  // Each alone: VTK would send no points that are not numbers as they are.
  const Data whole = tried.Do(particles, points, nullptr);
  if (!HasNonZeros(whole))
  {
    std::printf("%s: nothing to compare with\n", tried.Name);
    return 1;
  }
  int failures = 0;
  for (int part = 0; part < PartCount; ++part)
  {
    if (some && part != number % PartCount)
    {
      continue;
    }
    failures += CheckPart(tried, part, particles, points, whole, controller);
  }
  return failures;
}

/// A probe without points on the last rank fails on all ranks, and no rank waits for it.
int CheckWithoutPoints(vtkMPIController* controller)
{
  vtkNew<vtkPolyData> nothing;
  vtkNew<vtkSPHProbe> probe;
  probe->SetController(controller);
  probe->SetSourceData(nothing);
  if (controller->GetLocalProcessId() + 1 < controller->GetNumberOfProcesses())
  {
    probe->SetInputData(nothing);
  }
  probe->Update();
  const std::string said = probe->GetErrorMessage();
  std::printf("without points: %s\n", said.c_str());
  return said.find("Choose the points") == std::string::npos ? 1 : 0;
}

}

int main(int argc, char* argv[])
{
  return RunRanks(argc, argv,
    [=](vtkMPIController* controller)
    {
      int failures = CheckWithoutPoints(controller);
      for (int number = 0; number < static_cast<int>(Cases.size()); ++number)
      {
        failures += Check(number, argc > 2, argv[1], controller);
      }
      return failures;
    });
}

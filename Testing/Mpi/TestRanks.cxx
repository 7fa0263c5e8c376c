// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Run by mpirun: the surface that ranks make together is, point for point and bit for bit, the one that
// rank 0 makes alone, however the particles are strewn over the ranks.
//
//   TestRanks FOLDER OF DATA [CASE]
#include "RankParts.h"

#include "vtkCellArray.h"
#include "vtkCommunicator.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMPIController.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace
{

using Setting = std::function<void(vtkMarchingCorrectors*)>;
using Settings = std::vector<Setting>;

struct Case
{
  const char* Name;
  const char* File;
  Settings SetUp;
};

#define SET(call) [](vtkMarchingCorrectors* filter) { filter->Set##call; }
#define ON(name) [](vtkMarchingCorrectors* filter) { filter->name##On(); }
#define OFF(name) [](vtkMarchingCorrectors* filter) { filter->name##Off(); }

Setting Contour(const char* array, double value)
{
  return [=](vtkMarchingCorrectors* filter)
  {
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, array);
    filter->SetValue(0, value);
  };
}

const char* const Dams = "double_dam_break_small";
const char* const Dam = "dam_break_45k";        // with walls
const char* const TwoSizes = "two sizes";       // no file
const char* const InPlane = "in a plane";       // the dams, moved into z = 0.5
const char* const BesideMesh = "beside a mesh"; // the dams

const Setting Speed = Contour("Speed", 2.0), Free = ON(FreeSurface), Fine = SET(CubeSize(0.025)),
              Coarse = SET(CubeSizeFactor(1.0));
const Setting Fluid = SET(FluidArrayName("ParticleType"));

/// Contours velocities of fluid whose smoothing lengths differ.
void ContourVaried(vtkMarchingCorrectors* filter)
{
  Contour("Velocity", 1.0)(filter);
  Fluid(filter);
  filter->SetSmoothingLengthArrayName("SmoothingLengthAdaptive");
  filter->SetCubeSizeFactor(0.8);
  filter->SetCubeSizeModeToAdaptive();
}

/// Makes isolines of particles whose areas and smoothing lengths are larger on one side.
void ContourInPlane(vtkMarchingCorrectors* filter)
{
  Speed(filter);
  filter->SetValue(1, 1.0);
  filter->SetSmoothingLengthArrayName("h");
  filter->SetVolumeArrayName("area");
  filter->SetCubeSizeFactor(0.2);
  filter->ComputeBoundaryFlagOn();
  filter->SetCubeSizeModeToAdaptive();
}

const std::vector<Case> Cases = {
  { "free surface", Dams, { Free } },
  { "trimmed", Dams, { Speed } },
  { "beside a mesh", BesideMesh, { Speed } },
  { "two values, topology of the field, all arrays", Dams,
    { Speed, SET(Value(1, 1.2)), SET(TopologyToField()), ON(ComputeGradients), ON(ComputeWeightSum),
      ON(ComputeBoundaryEigenvalue), ON(ComputeBoundaryFlag), ON(ComputeCorrectionLength) } },
  { "value in the middle of the range, eigenvalue, double precision", "bunny_splash_small",
    { Contour("Speed", std::nan("")), SET(BoundaryDetectionToEigenvalue()),
      SET(Precision(vtkAlgorithm::DOUBLE_PRECISION)) } },
  { "array, value and fluid that are found", Dam, { ON(DetectFluid) } },
  { "computed volumes, estimated smoothing length", Dams,
    { Free, OFF(DetectArrays), ON(EstimateSmoothingLength) } },
  { "M'4, computed volumes, scaled", Dams,
    { Free, OFF(DetectArrays), SET(SmoothingLength(0.06)), SET(KernelToMPrime4()),
      SET(HScaleFactor(0.9)) } },
  { "box, preview", Dams,
    { Speed, ON(Preview), ON(UseBox), SET(Box(-0.4, 0.51, -10.0, 0.33, -0.2, 10.0)) } },
  { "fewer bricks than ranks", Dam,
    { Free, Fluid, SET(CubeSize(0.12)), ON(UseBox), SET(Box(0.0, 3.0, 0.0, 0.96, 0.0, 0.96)) } },
  { "periods", Dams, { Free, Fine, SET(PeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.5)) } },
  { "periods that the particles tell of", Dams, { Free, Fine, ON(DetectPeriod) } },
  { "periods that no cube divides", Dams,
    { Free, Fine, SET(PeriodicBounds(-1.0, 1.0, 0.0, 0.0, -1.0, 0.4717)) } },
  { "walls", Dam,
    { Contour("Velocity", 1.0), Fluid, SET(Solids(vtkMarchingCorrectors::SOLIDS_WALL)), Coarse } },
  { "adaptive cubes", Dam, { ContourVaried } },
  { "adaptive cubes, periods", Dam,
    { ContourVaried, SET(PeriodicBounds(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)) } },
  { "smoothing lengths that differ", Dam, { ContourVaried, SET(CubeSizeModeToUniform()), Coarse } },
  { "smooth", Dams, { Free, ON(Smooth) } },
  { "widened, computed volumes, periods", Dams,
    { Speed, OFF(DetectArrays), ON(EstimateSmoothingLength), SET(Widening(1.7)),
      SET(PeriodicBounds(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)) } },
  { "widened, adaptive cubes", Dam, { ContourVaried, SET(Widening(2.0)) } },
  { "computed volumes of large particles beside small ones", TwoSizes,
    { Free, OFF(DetectArrays), SET(SmoothingLengthArrayName("h")) } },
  { "lines", InPlane, { ContourInPlane } },
  { "lines, uniform squares, computed areas, eigenvalue", InPlane,
    { ContourInPlane, SET(VolumeArrayName(nullptr)), OFF(DetectArrays),
      SET(CubeSizeModeToUniform()), SET(BoundaryDetectionToEigenvalue()), SET(VertexThreshold(0.1)),
      ON(ComputeBoundaryEigenvalue) } },
  { "lines, topology of the field, double precision", InPlane,
    { ContourInPlane, SET(TopologyToField()), SET(Precision(vtkAlgorithm::DOUBLE_PRECISION)) } },
  { "lines, free surface, periods, capped", InPlane,
    { ContourInPlane, Free, SET(PeriodicBounds(-1.0, 1.0, -0.2, 0.9, 0.0, 0.0)), ON(Capping) } },
  { "lines, box in a period, capped", InPlane,
    { ContourInPlane, SET(PeriodicBounds(0.0, 0.0, -0.2, 0.9, 0.0, 0.0)), ON(UseBox),
      SET(Box(-0.7, 0.6, -10.0, 10.0, 0.0, 1.0)), ON(Capping) } },
  { "lines, flat box", InPlane,
    { ContourInPlane, ON(UseBox), SET(Box(-0.7, 0.6, -10.0, 10.0, 0.5, 0.5)), ON(Capping) } },
  { "filled, flat box", InPlane,
    { ContourInPlane, ON(Filled), ON(UseBox), SET(Box(-0.7, 0.6, -10.0, 0.4, 0.5, 0.5)) } },
  { "filled", InPlane, { ContourInPlane, ON(Filled) } },
  { "filled, period and box", InPlane,
    { ContourInPlane, ON(Filled), SET(PeriodicBounds(0.0, 0.0, -0.2, 0.9, 0.0, 0.0)), ON(UseBox),
      SET(Box(-0.7, 0.6, -10.0, 10.0, 0.0, 1.0)) } },
};

/// Small particles for x < 2, beyond these large ones, whose supports hold many small ones: a rank that has
/// no large one must be told how far others need its particles.
vtkSmartPointer<vtkPolyData> MakeTwoSizes()
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> lengths;
  lengths->SetName("h");
  for (const double size : { 0.05, 0.8 })
  {
    const double first = size < 0.1 ? 0.0 : 2.0;
    const int along = size < 0.1 ? 40 : 1, across = static_cast<int>(std::lround(1.2 / size));
    for (int i = 0; i < along * across * across; ++i)
    {
      const int x = i % along, y = i / along % across, z = i / along / across;
      const double shift = 0.2 * std::sin(1.3 * x + 2.1 * y + 0.7 * z);
      points->InsertNextPoint(
        first + size * (x + 0.5 + shift), size * (y + 0.5 - shift), size * (z + 0.5));
      lengths->InsertNextValue(1.2 * size);
    }
  }
  particles->SetPoints(points);
  particles->GetPointData()->AddArray(lengths);
  return particles;
}

/// Reads particles, and adds a period that matters only where it is used.
vtkSmartPointer<vtkPolyData> Read(const std::string& file)
{
  vtkSmartPointer<vtkPolyData> particles = ReadParticles(file);
  vtkNew<vtkDoubleArray> period;
  period->SetName("PeriodicBounds");
  for (const double side : { -1.0, 1.0, 0.0, 0.0, -1.0, 0.5 })
  {
    period->InsertNextValue(side);
  }
  particles->GetFieldData()->AddArray(period);
  return particles;
}

/// Returns a rank's share; the last rank has a triangle of a mesh, and no vertices.
vtkSmartPointer<vtkPolyData> TakeBesideMesh(vtkPolyData* particles, int part, int rank, int count)
{
  const vtkSmartPointer<vtkPolyData> own = TakePart(particles, part, rank % (count - 1), count - 1);
  const bool isMesh = rank == count - 1;
  vtkNew<vtkCellArray> cells;
  for (vtkIdType i = 0; i + (isMesh ? 2 : 0) < own->GetNumberOfPoints(); ++i)
  {
    const vtkIdType corners[3] = { i, i + 1, i + 2 };
    cells->InsertNextCell(isMesh ? 3 : 1, corners);
  }
  isMesh ? own->SetPolys(cells) : own->SetVerts(cells);
  return own;
}

void MoveIntoPlane(vtkPolyData* particles)
{
  vtkNew<vtkDoubleArray> lengths, areas;
  lengths->SetName("h");
  areas->SetName("area");
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    double x[3];
    particles->GetPoint(i, x);
    particles->GetPoints()->SetPoint(i, x[0], x[1], 0.5);
    const double h = 0.04 * std::pow(2.0, x[0] + 1.0);
    lengths->InsertNextValue(h);
    areas->InsertNextValue(0.2 * h * h);
  }
  particles->GetPointData()->AddArray(lengths);
  particles->GetPointData()->AddArray(areas);
}

/// Names of the statistics that describe the surface, and so do not depend on how ranks shared the work.
const char* const OfSurface[] = { "Area", "Volume", "Length", "CellsUsed",
  "TrianglesBeforeTrimming", "CorrectionMean", "CorrectionMax", "CorrectionStandardDeviation",
  "VerticesCorrected", "VerticesAboveTolerance", "IterationsMean", "IterationsMax", "TrimVertices",
  "TrimVerticesLinear", "WideningOutside" };
constexpr std::size_t OfSurfaceCount = sizeof(OfSurface) / sizeof(OfSurface[0]);

/// A surface, and what the filter says of it: ranges and cells, of the run and of the next one;
/// statistics.
struct Extracted
{
  vtkSmartPointer<vtkPolyData> Surface;
  std::array<double, 6 + OfSurfaceCount> Said = {};
};

Extracted Extract(
  const Settings& setUp, vtkPolyData* particles, vtkMultiProcessController* controller)
{
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetController(controller);
  for (const Setting& set : setUp)
  {
    set(filter);
  }
  filter->SetInputData(particles);
  filter->Update();
  const double *range = filter->GetFluidScalarRange(), *next = filter->GetNextScalarRange();
  Extracted extracted = { filter->GetOutput(),
    { range[0], range[1], filter->GetEstimatedCells(), next[0], next[1], filter->GetNextCells() } };
  for (std::size_t i = 0; i < OfSurfaceCount; ++i)
  {
    vtkDataArray* found = filter->GetRunStatistics()->GetArray(OfSurface[i]);
    extracted.Said[6 + i] = found ? found->GetComponent(0, 0) : -1.0;
  }
  return extracted;
}

/// Returns whether all ranks have rank 0's statistics: area, volume and length to the last bit, others to the rounding
/// of sums.
bool SayTheSame(vtkMultiProcessController* controller, const Extracted& own, Extracted whole)
{
  const int count = static_cast<int>(whole.Said.size());
  controller->Broadcast(whole.Said.data(), count, 0);
  int wrong = 0, wrongAnywhere = 0;
  for (int i = 0; i < count; ++i)
  {
    const double allowed = i >= 6 && i <= 8 ? 0.0 : 1e-12 * std::fabs(whole.Said[i]);
    wrong += std::fabs(own.Said[i] - whole.Said[i]) <= allowed ? 0 : 1;
  }
  wrong += whole.Said[2] > 0 ? 0 : 1;
  controller->AllReduce(&wrong, &wrongAnywhere, 1, vtkCommunicator::MAX_OP);
  return wrongAnywhere == 0;
}

/// Returns how many partitions give another surface.
int Check(const Case& tried, const std::string& folder, vtkMPIController* controller)
{
  const bool isInPlane = tried.File == InPlane, isMesh = tried.File == BesideMesh;
  const vtkSmartPointer<vtkPolyData> particles = tried.File == TwoSizes
    ? MakeTwoSizes()
    : Read(folder + "/" + (isInPlane || isMesh ? Dams : tried.File) + ".vtp");
  if (isInPlane)
  {
    MoveIntoPlane(particles);
  }
  const bool isFirst = controller->GetLocalProcessId() == 0;
  const Extracted whole = isFirst ? Extract(tried.SetUp, particles, nullptr) : Extracted();
  int failures = 0;
  for (int part = 0; part < PartCount; ++part)
  {
    const vtkSmartPointer<vtkPolyData> own = (isMesh ? TakeBesideMesh : TakePart)(
      particles, part, controller->GetLocalProcessId(), controller->GetNumberOfProcesses());
    const Extracted made = Extract(tried.SetUp, own, controller);
    std::string problem = CompareWithWhole(controller, made.Surface, whole.Surface);
    problem +=
      SayTheSame(controller, made, whole) ? "" : "other ranges, numbers of cells or statistics";
    if (isFirst)
    {
      failures += problem.empty() ? 0 : 1;
      std::printf(
        "%s, %s: %s\n", tried.Name, PartName(part), problem.empty() ? "same" : problem.c_str());
      std::fflush(stdout);
    }
  }
  return failures;
}

}

int main(int argc, char* argv[])
{
  return RunRanks(argc, argv,
    [=](vtkMPIController* controller)
    {
      int failures = 0;
      for (const Case& tried : Cases)
      {
        const bool isWanted = argc < 3 || std::string(tried.Name).find(argv[2]) != std::string::npos;
        failures += isWanted ? Check(tried, argv[1], controller) : 0;
      }
      return failures;
    });
}

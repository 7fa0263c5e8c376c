// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Runs that give the field, not a surface: at points, and along lines of sight.
#include "ColorScale.h"
#include "DataFile.h"
#include "Extra.h"
#include "Failures.h"
#include "Job.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ParticleTimes.h"
#include "Runs.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSPHArrays.h"
#include "vtkSPHSay.h"
#include "vtkThreshold.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <sstream>
#include <utility>

namespace
{

const char* const MaskName = "vtkValidPointMask";

/// Makes points on the part of a line that lies in --box, with their distance from the line's
/// beginning, for plots.
vtkSmartPointer<vtkDataSet> MakeLine(const Job& job)
{
  const std::vector<double>& ends = job.Slice.Line;
  const int count = job.Slice.Resolution;
  double first = 0.0, last = 1.0; // share of the way
  for (int a = 0; job.Surface->GetUseBox() && a < 3; ++a)
  {
    const double* sides = job.Surface->GetBox() + 2 * a;
    const double way = ends[3 + a] - ends[a];
    if (way != 0.0)
    {
      const double low = (sides[0] - ends[a]) / way, high = (sides[1] - ends[a]) / way;
      first = std::max(first, std::min(low, high));
      last = std::min(last, std::max(low, high));
    }
    else if (ends[a] < sides[0] || ends[a] > sides[1])
    {
      last = -1.0;
    }
  }
  Require(first < last, "no part of the --line lies in the --box");
  const double length = std::hypot(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]);
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> way;
  vtkNew<vtkCellArray> cells;
  points->SetDataTypeToDouble();
  way->SetName("arc_length");
  cells->InsertNextCell(count);
  for (int i = 0; i < count; ++i)
  {
    const double t = first + (last - first) * i / (count - 1);
    cells->InsertCellPoint(points->InsertNextPoint((1.0 - t) * ends[0] + t * ends[3],
      (1.0 - t) * ends[1] + t * ends[4], (1.0 - t) * ends[2] + t * ends[5]));
    way->InsertNextValue(t * length);
  }
  auto line = vtkSmartPointer<vtkPolyData>::New();
  line->SetPoints(points);
  line->SetLines(cells);
  line->GetPointData()->AddArray(way);
  return line;
}

/// Makes the points of --line or --slice. A slice spans the bounds of the particles, walls included; each finite
/// side of --box replaces that side of the bounds.
vtkSmartPointer<vtkDataSet> MakePoints(const Job& job, vtkPointSet* particles)
{
  if (job.Slice.Axis < 0)
  {
    return MakeLine(job);
  }
  double bounds[6];
  vtkNew<vtkSPHProbe> all; // walls count, too
  Require(all->FindFluidBounds(job.Probe->TakePresent(particles), bounds),
    "--slice has no plane to show, as --within and --only leave no particles");
  const SliceOptions& slice = job.Slice;
  const double* box = job.Surface->GetBox();
  for (int i = 0; job.Surface->GetUseBox() && i < 6; ++i)
  {
    bounds[i] = std::isfinite(box[i]) ? box[i] : bounds[i];
    const bool isOutside = i % 2 ? box[i] < slice.Place : box[i] > slice.Place;
    Require(i / 2 != slice.Axis || !isOutside, "the plane of --slice does not cross the --box");
  }
  double origin[3], size[3];
  for (int a = 0; a < 3; ++a)
  {
    origin[a] = a == slice.Axis ? slice.Place : bounds[2 * a];
    size[a] = a == slice.Axis ? 0.0 : bounds[2 * a + 1] - bounds[2 * a];
  }
  const double longest = *std::max_element(size, size + 3);
  Require(longest > 0.0,
    std::string("--slice ") + "xyz"[slice.Axis] +
      "= has no plane to show: all particles lie on one line along this axis");
  auto image = vtkSmartPointer<vtkImageData>::New();
  const double spacing = longest / (slice.Resolution - 1);
  const auto count = [spacing](double length)
  { return 1 + static_cast<int>(std::ceil(length / spacing - 1e-9)); };
  image->SetOrigin(origin);
  image->SetSpacing(spacing, spacing, spacing);
  image->SetDimensions(count(size[0]), count(size[1]), count(size[2]));
  return image;
}

/// Treats points of a file that are not in --box as points without fluid.
void HideOutside(const Job& job, vtkDataSet* points, vtkDataSet* result)
{
  const vtkBoundingBox box(job.Surface->GetBox());
  const bool isAsked = job.Has("--probe") && job.Surface->GetUseBox();
  for (vtkAbstractArray* each : vtkSPHListArrays(isAsked ? result->GetPointData() : nullptr))
  {
    auto* array = vtkDataArray::SafeDownCast(each);
    const bool isMade = array && !points->GetPointData()->HasArray(array->GetName());
    const std::vector<double> zeros(
      static_cast<std::size_t>(isMade ? array->GetNumberOfComponents() : 0));
    for (vtkIdType i = 0; isMade && i < array->GetNumberOfTuples(); ++i)
    {
      if (!box.ContainsPoint(result->GetPoint(i)))
      {
        array->SetTuple(i, zeros.data());
      }
    }
  }
}

/// Adds a row for each point. The first step decides on the columns, and adds their names. A value is
/// empty if the step lacks the array. Where there is no fluid, only arrays that were read with the
/// points have values.
void AddPointRows(const Job& job, double time, vtkDataSet* points,
  std::vector<std::pair<std::string, int>>& columns, std::string& text)
{
  auto* probed = vtkDataSet::SafeDownCast(job.Probe->GetOutput());
  HideOutside(job, points, probed);
  vtkPointData* arrays = probed->GetPointData();
  if (columns.empty())
  {
    text = "time,point,x,y,z,valid";
    for (vtkAbstractArray* array : vtkSPHListArrays(arrays))
    {
      const std::string name = array->GetName();
      const int components = array->GetNumberOfComponents();
      for (int c = 0; name != MaskName && c < components; ++c)
      {
        columns.emplace_back(name, c);
        text += "," + TableField(name + (components > 1 ? ":" + std::to_string(c) : ""));
      }
    }
    text += "\n";
  }
  vtkDataArray* mask = arrays->GetArray(MaskName);
  for (vtkIdType p = 0; p < points->GetNumberOfPoints(); ++p)
  {
    const double* x = points->GetPoint(p);
    const bool isValid = mask && mask->GetComponent(p, 0) > 0.0;
    text += Joined({ DigitsOf(time), std::to_string(p), DigitsOf(x[0]), DigitsOf(x[1]),
                     DigitsOf(x[2]), isValid ? "1" : "0" },
      ",");
    for (const auto& [name, component] : columns)
    {
      vtkAbstractArray* array = arrays->GetAbstractArray(name.c_str());
      const bool isOwn = points->GetPointData()->HasArray(name.c_str());
      text += "," + (array && (isValid || isOwn) ? TableField(array, p, component) : std::string());
    }
    text += "\n";
  }
}

/// Returns a line of text about the points, or about the image, and a warning if no fluid is there.
std::pair<std::string, std::string> Describe(vtkDataSet* data)
{
  std::ostringstream line;
  if (auto* mask = vtkCharArray::SafeDownCast(data->GetPointData()->GetArray(MaskName)))
  {
    const auto valid = std::count(mask->Begin(), mask->End(), 1);
    line << "points      " << data->GetNumberOfPoints() << ", " << valid << " of them valid\n";
    return { line.str(), valid > 0 ? "" : vtkSPHSay(MCOR_SAY(POINTS_DRY)) };
  }
  vtkDataArray* values = data->GetPointData()->GetScalars();
  const double* range = values->GetFiniteRange(); // of no values: the first is the larger one
  const bool isDry = range[0] >= 0.0 && range[1] <= 0.0;
  line << "image       " << DescribeSize(vtkImageData::SafeDownCast(data)) << ", "
       << Printable(values->GetName()) << " from " << range[0] << " to " << range[1] << "\n";
  return { line.str(), isDry ? "the image has no value but 0; check --box and --scalar" : "" };
}

}

double Evaluate(Sharing& sharing, vtkPointSet* particles, vtkDataSet* points,
  const std::string& progress)
{
  const Job& job = sharing.Options;
  vtkSPHAlgorithm* const filter =
    points ? static_cast<vtkSPHAlgorithm*>(job.Probe) : job.Projection.Get();
  double seconds = 0.0;
  sharing.OnAll(
    [&] { filter->SetInputDataObject(points ? 1 : 0, SetUpParticles(filter, job, particles)); });
  if (points)
  {
    filter->SetInputDataObject(0, points);
  }
  sharing.OnAll([&] { seconds = Update(filter, sharing, progress); });
  return seconds;
}

vtkImageData* SeenImage(const Job& job)
{
  vtkImageData* image = job.Projection->GetImage();
  Require(image->GetNumberOfPoints() > 0 && image->GetPointData()->GetScalars(),
    "no particle is seen, so no image was written");
  return image;
}

std::string DescribeSize(vtkImageData* image)
{
  std::ostringstream text;
  const int* size = image->GetDimensions();
  text << size[0] << " x " << size[1] << " x " << size[2] << " pixels";
  return text.str();
}

std::string Draw(const Job& job, const std::string& file, vtkDataSet* data, vtkDataSet* frame,
  const Picture& picture, ColorScale& colors)
{
  vtkSmartPointer<vtkDataSet> shown = data;
  std::string name = job.Picture.ColorBy;
  int axis = job.Slice.Axis;
  if (job.Mode() & CONTOUR)
  {
    colors.Suggest(data, job.Surface->GetIsoValueArrayName());
    name = colors.GetName();
  }
  else if (job.Mode() & POINTS)
  {
    vtkNew<vtkThreshold> valid; // without this, arrays would be 0 elsewhere, which looks like a value
    valid->SetInputData(data);
    valid->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, MaskName);
    valid->SetLowerThreshold(0.5);
    valid->SetUpperThreshold(2.0);
    valid->Update();
    shown = valid->GetOutput();
    name = name.empty() ? vtkSPHChooseArray(shown->GetPointData()) : name;
    name = name.empty() ? "WeightSum" : name;
  }
  else
  {
    const double* sight = job.Projection->GetDirection();
    name = name.empty() ? data->GetPointData()->GetScalars()->GetName() : name;
    axis = sight[0] != 0.0 ? 0 : sight[1] != 0.0 ? 1 : 2;
    axis = vtkImageData::SafeDownCast(data)->GetDimensions()[axis] == 1 ? axis : -1;
  }
  colors.SetName(name);
  colors.Include(shown);
  return picture(file, shown, frame, colors, axis);
}

void WritePicture(const Job& job, vtkDataSet* data, vtkDataSet* frame, ColorScale& colors)
{
  const std::string& file = job.Picture.File;
  if (!file.empty())
  {
    WriteOutput(
      file, Draw(job, file, data, frame, LoadExtra().NewPicture(job.Picture), colors));
  }
}

bool MakePointTable(Sharing& sharing)
{
  const Job& job = sharing.Options;
  vtkSmartPointer<vtkDataSet> points = vtkSmartPointer<vtkPolyData>::New(); // empty on others
  sharing.OnFirst([&] { points = ReadDataSet(job.Text("--probe")); });
  std::vector<std::pair<std::string, int>> columns; // the columns' arrays and components
  const auto addRows = [&](const ParticleTimes::Moment& moment, std::string& text)
  {
    Evaluate(sharing, moment.Particles, points, moment.Progress);
    sharing.OnFirst([&] { AddPointRows(job, moment.Time, points, columns, text); });
  };
  return MakeTable(sharing, std::to_string(points->GetNumberOfPoints()) + " points", addRows,
    [] { return ""; });
}

bool MakeField(Sharing& sharing)
{
  const Job& job = sharing.Options;
  vtkSmartPointer<vtkDataSet> points; // null for a projection
  sharing.OnFirst(
    [&]
    {
      OpenSources(job.InputFiles());
      CheckOutputs({ job.Output, job.Picture.File });
      if (job.Has("--probe"))
      {
        points = ReadDataSet(job.Text("--probe"));
        CheckDataSetFile(job.Output, points);
      }
    });
  const vtkSmartPointer<vtkPointSet> particles = sharing.ReadInput();
  if (job.Mode() & POINTS)
  {
    sharing.OnAll([&] { points = job.Has("--probe") ? points : MakePoints(job, particles); });
    if (!sharing.IsFirst())
    {
      points = vtkSmartPointer<vtkPolyData>::New();
    }
  }
  const double seconds = Evaluate(sharing, particles, points, "");
  sharing.OnFirst(
    [&]
    {
      for (const std::string& warning : Messages().Warnings)
      {
        Say("warning: " + warning);
      }
      vtkDataSet* result =
        points ? vtkDataSet::SafeDownCast(job.Probe->GetOutput()) : SeenImage(job);
      HideOutside(job, points, result);
      const auto [line, fault] = Describe(result);
      // A run without any fluid has no statistics, and a warning above says so.
      if (!fault.empty() && (!points || job.Probe->GetRunStatistics()->GetNumberOfArrays() > 0))
      {
        Say("warning: " + fault);
      }
      if (!job.Has("--quiet"))
      {
        std::cout << line << "seconds     " << seconds << "\n";
      }
      WriteDataSet(job.Output, result);
      ColorScale colors(job.Picture);
      WritePicture(job, result, result, colors);
    });
  return true;
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// The field in place of a surface: at points, and along lines of sight.
#include "ColorScale.h"
#include "DataFile.h"
#include "Extra.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Picture.h"
#include "Runs.h"
#include "SafeText.h"
#include "Sharing.h"

#include "vtkCellArray.h"
#include "vtkCharArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkThreshold.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <stdexcept>

namespace
{

vtkIdType CountValid(vtkDataSet* data)
{
  auto* mask = vtkCharArray::SafeDownCast(data->GetPointData()->GetArray("vtkValidPointMask"));
  const char* begin = mask->GetPointer(0);
  return std::count(begin, begin + mask->GetNumberOfValues(), 1);
}

vtkSmartPointer<vtkDataSet> MakeSlice(const SliceOptions& slice, const double bounds[6])
{
  double longest = 0.0;
  for (int a = 0; a < 3; ++a)
  {
    longest = std::max(longest, a == slice.Axis ? 0.0 : bounds[2 * a + 1] - bounds[2 * a]);
  }
  if (!(longest > 0.0))
  {
    throw std::runtime_error(std::string("--slice ") + "xyz"[slice.Axis] +
      "= has no plane to show: all particles lie on one line along this axis");
  }
  auto image = vtkSmartPointer<vtkImageData>::New();
  const double spacing = longest / (slice.Resolution - 1);
  double origin[3];
  int counts[3];
  for (int a = 0; a < 3; ++a)
  {
    const bool isNormal = a == slice.Axis;
    origin[a] = isNormal ? slice.Place : bounds[2 * a];
    const double length = isNormal ? 0.0 : bounds[2 * a + 1] - bounds[2 * a];
    counts[a] = 1 + static_cast<int>(std::ceil(length / spacing - 1e-9));
  }
  image->SetOrigin(origin);
  image->SetSpacing(spacing, spacing, spacing);
  image->SetDimensions(counts);
  return image;
}

/// Makes points on a line, with their distance from its beginning, for plots.
vtkSmartPointer<vtkDataSet> MakeLine(const SliceOptions& slice)
{
  const std::vector<double>& ends = slice.Line;
  const int count = slice.Resolution;
  const double length = std::hypot(ends[3] - ends[0], ends[4] - ends[1], ends[5] - ends[2]);
  vtkNew<vtkPoints> points;
  vtkNew<vtkDoubleArray> way;
  vtkNew<vtkCellArray> cells;
  points->SetDataTypeToDouble();
  way->SetName("arc_length");
  cells->InsertNextCell(count);
  for (int i = 0; i < count; ++i)
  {
    const double t = static_cast<double>(i) / (count - 1);
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

/// Takes the valid part: elsewhere arrays are 0, which would look like values.
vtkSmartPointer<vtkDataSet> ValidPart(vtkDataSet* data)
{
  vtkNew<vtkThreshold> threshold;
  threshold->SetInputData(data);
  threshold->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "vtkValidPointMask");
  threshold->SetLowerThreshold(0.5);
  threshold->SetUpperThreshold(2.0);
  threshold->Update();
  return vtkSmartPointer<vtkDataSet>(threshold->GetOutput());
}

/// The first vector, or the first array that is not everywhere the same.
std::string ArrayToShow(vtkDataSet* data)
{
  std::string found;
  for (int i = 0; i < data->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetPointData()->GetArray(i);
    if (array && array->GetNumberOfComponents() == 3)
    {
      return array->GetName();
    }
    double range[2] = { 0.0, 0.0 };
    if (array && array->GetNumberOfComponents() == 1)
    {
      array->GetFiniteRange(range);
    }
    found = found.empty() && range[0] < range[1] ? array->GetName() : found;
  }
  return found.empty() ? "WeightSum" : found;
}

/// Points of a slice or a line, which needs the bounds of all particles.
vtkSmartPointer<vtkDataSet> MakePoints(const Job& job, vtkPointSet* particles)
{
  double bounds[6];
  vtkNew<vtkSPHProbe> all; // walls, too
  const bool hasBounds = all->FindFluidBounds(job.Probe->TakePresent(particles), bounds);
  if (job.Slice.Axis >= 0 && !hasBounds)
  {
    throw std::runtime_error(
      "--slice has no plane to show, as --within and --only leave no particles");
  }
  return job.Slice.Axis >= 0 ? MakeSlice(job.Slice, bounds) : MakeLine(job.Slice);
}

void TellWarnings(MessageCapture* messages)
{
  for (const std::string& warning : messages->GetWarnings())
  {
    Say("warning: " + warning);
  }
}

}

void ProbePoints(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  vtkSmartPointer<vtkDataSet> points = vtkSmartPointer<vtkPolyData>::New(); // others have none
  sharing.OnFirst(
    [&]
    {
      CheckOutputs(ListFiles(job.InputFiles(), messages), { job.Output, job.Picture.File });
      if (!job.ProbeFile.empty())
      {
        points = ReadDataSet(job.ProbeFile, messages);
        CheckDataSetFile(job.Output, points);
      }
    });
  const vtkSmartPointer<vtkPointSet> particles =
    sharing.Read(job.Inputs.front(), job.Walls, messages);
  double seconds = 0.0;
  sharing.OnAll(
    [&]
    {
      if (job.ProbeFile.empty())
      {
        const vtkSmartPointer<vtkDataSet> made = MakePoints(job, particles);
        points = sharing.IsFirst() ? made : points;
      }
      job.Probe->SetInputData(points);
      job.Probe->SetSourceData(SetUpParticles(job.Probe, job, particles));
    });
  sharing.OnAll([&] { seconds = Update(job.Probe, job, messages); });
  sharing.OnFirst(
    [&]
    {
      TellWarnings(messages);
      auto* result = vtkDataSet::SafeDownCast(job.Probe->GetOutput());
      if (!job.Quiet)
      {
        std::cout << "points      " << result->GetNumberOfPoints() << ", " << CountValid(result)
                  << " of them valid\nseconds     " << seconds << "\n";
      }
      WriteDataSet(job.Output, result, messages);
      if (!job.Picture.File.empty())
      {
        const vtkSmartPointer<vtkDataSet> shown = ValidPart(result);
        ColorScale colors(job.Picture);
        colors.SetName(job.Picture.ColorBy.empty() ? ArrayToShow(shown) : job.Picture.ColorBy);
        colors.Include(shown);
        const auto picture = LoadExtra().NewPicture(job.Picture);
        WriteOutput(job.Picture.File,
          picture->Draw(job.Picture.File, shown, result, colors, messages, job.Slice.Axis));
      }
    });
}

double Project(const Job& job, vtkPointSet* particles, MessageCapture* messages, Sharing& sharing,
  const std::string& before)
{
  double seconds = 0.0;
  sharing.OnAll(
    [&] { job.Projection->SetInputData(SetUpParticles(job.Projection, job, particles)); });
  sharing.OnAll([&] { seconds = Update(job.Projection, job, messages, before); });
  return seconds;
}

vtkImageData* SeenImage(const Job& job)
{
  vtkImageData* image = job.Projection->GetImage();
  if (!image->GetPointData()->GetScalars())
  {
    throw std::runtime_error("no particle is seen, so no image was written");
  }
  return image;
}

std::string DrawProjection(const Job& job, const std::string& file, Picture& picture,
  ColorScale& colors, MessageCapture* messages)
{
  vtkImageData* image = job.Projection->GetImage();
  colors.SetName(job.Picture.ColorBy.empty() ? image->GetPointData()->GetScalars()->GetName()
                                             : job.Picture.ColorBy);
  colors.Include(image);
  const double* sight = job.Projection->GetDirection();
  const int axis = sight[0] != 0.0 ? 0 : sight[1] != 0.0 ? 1 : 2;
  return picture.Draw(
    file, image, image, colors, messages, image->GetDimensions()[axis] == 1 ? axis : -1);
}

void ProjectParticles(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  sharing.OnFirst(
    [&] {
      CheckOutputs(ListFiles(job.InputFiles(), messages), { job.Output, job.Picture.File });
    });
  const double seconds =
    Project(job, sharing.Read(job.Inputs.front(), job.Walls, messages), messages, sharing, "");
  sharing.OnFirst(
    [&]
    {
      TellWarnings(messages);
      vtkImageData* image = SeenImage(job);
      vtkDataArray* values = image->GetPointData()->GetScalars();
      const int* size = image->GetDimensions();
      if (!job.Quiet)
      {
        std::cout << "image       " << size[0] << " x " << size[1] << " x " << size[2]
                  << " pixels, " << Printable(values->GetName()) << " from "
                  << values->GetFiniteRange()[0] << " to " << values->GetFiniteRange()[1]
                  << "\nseconds     " << seconds << "\n";
      }
      WriteDataSet(job.Output, image, messages);
      if (!job.Picture.File.empty())
      {
        ColorScale colors(job.Picture);
        const auto picture = LoadExtra().NewPicture(job.Picture);
        WriteOutput(
          job.Picture.File, DrawProjection(job, job.Picture.File, *picture, colors, messages));
      }
    });
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHResample.h"

#include "vtkBoundingBox.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHPrint.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <algorithm>
#include <cmath>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

/**
 * Margin around the fluid's box, as a share of its longest side: the fluid ends somewhat beyond
 * its particles.
 */
constexpr double Margin = 0.03;

/** About how many points a volume has if its dimensions are not set. */
constexpr double UsualPoints = 1e6;

/** The range of a plane inside a box, along the plane's axes u and v; empty if the plane misses the box. */
struct Rectangle
{
  double U[3], V[3];
  vtkBoundingBox Range;

  Rectangle(const double box[6], const double origin[3], const double normal[3])
  {
    // For a normal along an axis, u and v are the other two axes, in their order.
    const double size[3] = { std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2]) };
    const auto axis = std::min_element(size, size + 3) - size;
    double unit[3] = { normal[0], normal[1], normal[2] };
    vtkMath::Normalize(unit);
    for (int a = 0; a < 3; ++a)
    {
      this->U[a] = (a == axis ? 1.0 : 0.0) - unit[axis] * unit[a];
    }
    vtkMath::Normalize(this->U);
    vtkMath::Cross(unit, this->U, this->V);
    const double* largest = std::max_element(
      this->V, this->V + 3, [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (*largest < 0.0)
    {
      std::transform(this->V, this->V + 3, this->V, [](double v) { return v == 0.0 ? 0.0 : -v; });
    }
    double corners[8][3], heights[8];
    for (int c = 0; c < 8; ++c)
    {
      for (int a = 0; a < 3; ++a)
      {
        corners[c][a] = box[2 * a + (c >> a & 1)] - origin[a];
      }
      heights[c] = vtkMath::Dot(corners[c], normal);
    }
    for (int edge = 0; edge < 24; ++edge)
    {
      const int c = edge / 3, d = c | 1 << edge % 3; // d is c if c is the edge's upper end
      const bool isCut = (heights[c] < 0.0) != (heights[d] < 0.0);
      const double part = isCut ? heights[c] / (heights[c] - heights[d]) : 0.0;
      double x[3];
      for (int a = 0; a < 3; ++a)
      {
        x[a] = corners[c][a] + part * (corners[d][a] - corners[c][a]);
      }
      if (isCut || heights[c] == 0.0)
      {
        this->Range.AddPoint(vtkMath::Dot(x, this->U), vtkMath::Dot(x, this->V), 0.0);
      }
    }
  }
};

/**
 * Makes a rectangle of quads that holds the part of a plane in the box (x0, x1, y0, y1, z0, z1),
 * with `resolution` points along the longer side. Empty if the plane misses the box.
 */
void MakeSlice(const double box[6], const double origin[3], const double normal[3], int resolution,
  vtkPolyData* slice)
{
  const Rectangle plane(box, origin, normal);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> quads;
  points->SetDataTypeToDouble();
  slice->SetPoints(points);
  if (!plane.Range.IsValid() || !(vtkMath::Norm(normal) > 0.0))
  {
    return;
  }
  const double* low = plane.Range.GetMinPoint();
  const double length[2] = { plane.Range.GetLength(0), plane.Range.GetLength(1) };
  const double longer = std::max(length[0], length[1]);
  const double spacing = longer > 0.0 ? longer / std::max(resolution - 1, 1) : 1.0;
  vtkIdType count[2];
  for (int a = 0; a < 2; ++a)
  {
    count[a] = std::max<vtkIdType>(2, static_cast<vtkIdType>(length[a] / spacing + 1.5));
  }
  points->SetNumberOfPoints(count[0] * count[1]);
  quads->AllocateExact((count[0] - 1) * (count[1] - 1), 4 * (count[0] - 1) * (count[1] - 1));
  for (vtkIdType point = 0; point < count[0] * count[1]; ++point)
  {
    const vtkIdType i = point % count[0], j = point / count[0];
    const double u = low[0] + spacing * static_cast<double>(i);
    const double v = low[1] + spacing * static_cast<double>(j);
    points->SetPoint(point, origin[0] + u * plane.U[0] + v * plane.V[0],
      origin[1] + u * plane.U[1] + v * plane.V[1], origin[2] + u * plane.U[2] + v * plane.V[2]);
    if (i + 1 < count[0] && j + 1 < count[1])
    {
      const vtkIdType corners[4] = { point, point + 1, point + count[0] + 1, point + count[0] };
      quads->InsertNextCell(4, corners);
    }
  }
  slice->SetPolys(quads);
}

/** Makes a line of `resolution` points, at least 2; arc_length is the distance from the first point. */
void MakeLine(const double from[3], const double to[3], int resolution, vtkPolyData* line)
{
  const vtkIdType count = std::max(resolution, 2);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkDoubleArray> along;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(count);
  along->SetName("arc_length");
  along->SetNumberOfValues(count);
  cells->InsertNextCell(static_cast<int>(count));
  for (vtkIdType i = 0; i < count; ++i)
  {
    const double part = static_cast<double>(i) / static_cast<double>(count - 1);
    points->SetPoint(i, from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]),
      from[2] + part * (to[2] - from[2]));
    along->SetValue(i, part * std::sqrt(vtkMath::Distance2BetweenPoints(from, to)));
    cells->InsertCellPoint(i);
  }
  line->SetPoints(points);
  line->SetLines(cells);
  line->GetPointData()->AddArray(along);
}

}

vtkStandardNewMacro(vtkSPHResample);

vtkSPHResample::vtkSPHResample()
{
  this->SetNumberOfInputPorts(1);
  this->NaNOutside = 1;
}

const char* vtkSPHResample::GetOutputClassName(const char*)
{
  return this->Shape == VOLUME ? "vtkImageData" : "vtkPolyData";
}

// Tells the extent of a volume; origin and spacing come with the data. If dimensions are not set, chooses
// some for which the cells in Bounds, or in the fluid's box, are about cubes; a flat box gets one layer of points.
int vtkSPHResample::RequestInformation(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  if (this->Shape != VOLUME)
  {
    info->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
    return 1;
  }
  int* d = this->UsedDimensions;
  std::copy_n(this->Dimensions, 3, d);
  double bounds[6];
  std::copy_n(this->Bounds, 6, bounds);
  const bool isGiven = std::min({ d[0], d[1], d[2] }) > 0;
  if (!isGiven && this->FitBounds)
  {
    const auto particles = this->TakeParticlesAhead(vtkDataObject::GetData(inputVector[0]));
    const bool isFound = (particles || this->IsShared()) && this->FindBounds(particles, bounds);
    std::fill_n(bounds, isFound ? 0 : 6, 0.0);
  }
  double product = 1.0;
  int axes = 0;
  for (int a = 0; a < 3; ++a)
  {
    const double length = bounds[2 * a + 1] - bounds[2 * a];
    product *= length > 0.0 ? length : 1.0;
    axes += length > 0.0 ? 1 : 0;
  }
  const double spacing = std::pow(product / UsualPoints, 1.0 / std::max(axes, 1));
  for (int a = 0; a < 3; ++a)
  {
    const double count = (bounds[2 * a + 1] - bounds[2 * a]) / spacing;
    const int fitting = count > 0.0 ? static_cast<int>(std::min(count, UsualPoints)) + 2 : 1;
    d[a] = d[a] > 0 ? d[a] : fitting;
  }
  info->Set(Pipeline::WHOLE_EXTENT(), 0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1);
  info->Set(vtkAlgorithm::CAN_PRODUCE_SUB_EXTENT(), 1);
  return 1;
}

// Finds the fluid's box with a margin, but without a margin along the constant axis of particles in
// a plane. Returns false if no particle is fluid.
bool vtkSPHResample::FindBounds(vtkPointSet* particles, double bounds[6])
{
  if (!this->FindFluidBounds(particles, bounds))
  {
    return false;
  }
  int flat[3], count = 0;
  for (int a = 0; a < 3; ++a)
  {
    flat[count] = a;
    count += bounds[2 * a] == bounds[2 * a + 1] ? 1 : 0;
  }
  this->FlatAxis = this->Dimension == DIMENSION_3 || count != 1 ? -1 : flat[0];
  const double longest =
    std::max({ bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4] });
  for (int a = 0; a < 3; ++a)
  {
    const double margin = a == this->FlatAxis ? 0.0 : Margin * longest;
    bounds[2 * a] -= margin;
    bounds[2 * a + 1] += margin;
  }
  return true;
}

// Makes the points that this process is asked for. The first process makes all points of a slice or
// line.
vtkSmartPointer<vtkDataSet> vtkSPHResample::MakePoints(const double b[6])
{
  vtkInformation* info = this->GetOutputInformation(0);
  const double middle[3] = { 0.5 * (b[0] + b[1]), 0.5 * (b[2] + b[3]), 0.5 * (b[4] + b[5]) };
  if (this->Shape == VOLUME)
  {
    auto image = vtkSmartPointer<vtkImageData>::New();
    const double* box = this->FitBounds ? b : this->Bounds;
    double spacing[3];
    for (int a = 0; a < 3; ++a)
    {
      const double length = box[2 * a + 1] - box[2 * a];
      spacing[a] = length > 0.0 ? length / std::max(this->UsedDimensions[a] - 1, 1) : 1.0;
    }
    image->SetOrigin(box[0], box[2], box[4]);
    image->SetSpacing(spacing);
    const int* d = this->UsedDimensions;
    int extent[6] = { 0, d[0] - 1, 0, d[1] - 1, 0, d[2] - 1 };
    info->Get(Pipeline::UPDATE_EXTENT(), extent);
    image->SetExtent(extent);
    return image;
  }
  auto made = vtkSmartPointer<vtkPolyData>::New();
  const int piece = this->IsShared() ? this->Controller->GetLocalProcessId()
                                     : info->Get(Pipeline::UPDATE_PIECE_NUMBER());
  if (piece <= 0 && this->Shape == SLICE)
  {
    // If the particles lie in a plane, the slice is this plane. Other slices would be lines.
    const bool isFlat = this->FlatAxis >= 0;
    const double along[3] = { this->FlatAxis == 0 ? 1.0 : 0.0, this->FlatAxis == 1 ? 1.0 : 0.0,
      this->FlatAxis == 2 ? 1.0 : 0.0 };
    MakeSlice(b, isFlat || this->FitBounds ? middle : this->Origin, isFlat ? along : this->Normal,
      this->Resolution, made);
  }
  else if (piece <= 0)
  {
    int longest = 0;
    for (int a = 1; a < 3; ++a)
    {
      longest = b[2 * a + 1] - b[2 * a] > b[2 * longest + 1] - b[2 * longest] ? a : longest;
    }
    double from[3], to[3];
    for (int a = 0; a < 3; ++a)
    {
      from[a] = !this->FitBounds ? this->Point1[a] : a == longest ? b[2 * a] : middle[a];
      to[a] = !this->FitBounds ? this->Point2[a] : a == longest ? b[2 * a + 1] : middle[a];
    }
    MakeLine(from, to, this->Resolution, made);
  }
  return made;
}

void vtkSPHResample::Process(vtkDataObject* data, vtkDataObject* output)
{
  this->Particles = vtkPointSet::SafeDownCast(data);
  double bounds[6];
  if (!this->Particles && !this->IsShared())
  {
    return;
  }
  if (!this->FindBounds(this->Particles, bounds))
  {
    this->Warn("No particle is fluid, so there is nothing to show.");
    return;
  }
  this->Superclass::Process(this->MakePoints(bounds), output);
  auto* slice =
    this->Shape == SLICE && this->OnlyFluid ? vtkPolyData::SafeDownCast(output) : nullptr;
  vtkDataArray* isValid =
    slice ? slice->GetPointData()->GetArray(this->ValidPointMaskArrayName.c_str()) : nullptr;
  if (!isValid)
  {
    return;
  }
  vtkNew<vtkCellArray> kept; // keeps the quads whose corners are all valid
  vtkIdType size;
  const vtkIdType* corners;
  for (vtkIdType cell = 0; cell < slice->GetNumberOfPolys(); ++cell)
  {
    slice->GetPolys()->GetCellAtId(cell, size, corners);
    if (std::all_of(corners, corners + size,
          [isValid](vtkIdType point) { return isValid->GetComponent(point, 0) != 0.0; }))
    {
      kept->InsertNextCell(size, corners);
    }
  }
  slice->SetPolys(kept);
}

void vtkSPHResample::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(
    FitBounds, Origin, Normal, Point1, Point2, Bounds, Resolution, Dimensions, OnlyFluid);
  const char* const shapes[] = { "slice", "line", "volume" };
  os << indent << "Shape: " << shapes[this->Shape] << "\n";
}
VTK_ABI_NAMESPACE_END

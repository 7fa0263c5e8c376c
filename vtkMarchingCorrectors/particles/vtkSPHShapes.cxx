// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHShapes.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>
#include <limits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/**
 * Finds the range of the plane in the box, along its axes u and v. Returns false if the plane
 * misses the box.
 */
struct Rectangle
{
  double U[3], V[3];
  double Low[2], High[2];

  Rectangle(const double box[6], const double origin[3], const double normal[3])
  {
    this->ChooseAxes(normal);
    std::fill_n(this->Low, 2, std::numeric_limits<double>::infinity());
    std::fill_n(this->High, 2, -std::numeric_limits<double>::infinity());
    for (int edge = 0; edge < 12; ++edge)
    {
      const int axis = edge / 4;
      double ends[2][3], height[2];
      for (int end = 0; end < 2; ++end)
      {
        const int sides[3] = { end, edge & 1, edge >> 1 & 1 };
        for (int a = 0; a < 3; ++a)
        {
          ends[end][(axis + a) % 3] = box[2 * ((axis + a) % 3) + sides[a]] - origin[(axis + a) % 3];
        }
        height[end] = vtkMath::Dot(ends[end], normal);
      }
      this->AddEdge(ends, height);
    }
  }

  bool IsEmpty() const { return this->Low[0] > this->High[0]; }

private:
  /** For a normal along an axis, u and v are the other two axes, in their order. */
  void ChooseAxes(const double normal[3])
  {
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
  }

  void AddEdge(const double ends[2][3], const double height[2])
  {
    for (int end = 0; end < 2; ++end)
    {
      if (height[end] == 0.0)
      {
        this->Add(ends[end]);
      }
    }
    if ((height[0] < 0.0) != (height[1] < 0.0))
    {
      const double part = height[0] / (height[0] - height[1]);
      double x[3];
      for (int a = 0; a < 3; ++a)
      {
        x[a] = ends[0][a] + part * (ends[1][a] - ends[0][a]);
      }
      this->Add(x);
    }
  }

  void Add(const double x[3])
  {
    const double at[2] = { vtkMath::Dot(x, this->U), vtkMath::Dot(x, this->V) };
    for (int a = 0; a < 2; ++a)
    {
      this->Low[a] = std::min(this->Low[a], at[a]);
      this->High[a] = std::max(this->High[a], at[a]);
    }
  }
};
}

void vtkSPHMakeSlice(const double box[6], const double origin[3], const double normal[3],
  int resolution, vtkPolyData* slice)
{
  const Rectangle plane(box, origin, normal);
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> quads;
  points->SetDataTypeToDouble();
  slice->SetPoints(points);
  if (plane.IsEmpty() || !(vtkMath::Norm(normal) > 0.0))
  {
    return;
  }
  const double length[2] = { plane.High[0] - plane.Low[0], plane.High[1] - plane.Low[1] };
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
    const double u = plane.Low[0] + spacing * static_cast<double>(i);
    const double v = plane.Low[1] + spacing * static_cast<double>(j);
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

void vtkSPHMakeLine(const double from[3], const double to[3], int resolution, vtkPolyData* line)
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

void vtkSPHCropSlice(vtkPolyData* slice, const char* mask)
{
  vtkDataArray* isValid = slice->GetPointData()->GetArray(mask);
  vtkNew<vtkCellArray> kept;
  vtkCellArray* quads = slice->GetPolys();
  vtkIdType size;
  const vtkIdType* corners;
  for (vtkIdType cell = 0; isValid && cell < quads->GetNumberOfCells(); ++cell)
  {
    quads->GetCellAtId(cell, size, corners);
    if (std::all_of(corners, corners + size,
          [isValid](vtkIdType point) { return isValid->GetComponent(point, 0) != 0.0; }))
    {
      kept->InsertNextCell(size, corners);
    }
  }
  if (isValid)
  {
    slice->SetPolys(kept);
  }
}
VTK_ABI_NAMESPACE_END

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Particle sets and checks shared by the filter's tests.
 */
#ifndef TestParticles_h
#define TestParticles_h

#include "vtkMarchingCorrectors.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <iostream>
#include <string>

#define CHECK(condition)                                                                           \
  do                                                                                               \
  {                                                                                                \
    if (!(condition))                                                                              \
    {                                                                                              \
      std::cerr << __FILE__ << ":" << __LINE__ << ": failed: " #condition << std::endl;            \
      ++failures;                                                                                  \
    }                                                                                              \
  } while (0)

namespace test
{
/// Counts events of the filter and its executive, which is where a failed update reports.
inline void CountEvents(vtkAlgorithm* filter, unsigned long event, int* count)
{
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback([](vtkObject*, unsigned long, void* n, void*) { ++*static_cast<int*>(n); });
  observer->SetClientData(count);
  filter->AddObserver(event, observer);
  filter->GetExecutive()->AddObserver(event, observer);
}

const double Spacing = 0.1;
const double SmoothingLength = 0.13;

template <typename ArrayT>
vtkSmartPointer<ArrayT> AddArray(vtkDataSet* data, const char* name, int components,
  const std::function<double(vtkIdType point, int component)>& value)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(data->GetNumberOfPoints());
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    for (int c = 0; c < components; ++c)
    {
      array->SetComponent(i, c, value(i, c));
    }
  }
  data->GetPointData()->AddArray(array);
  return array;
}

/**
 * 21^3 particles that fill the cube [-1, 1]^3, shifted a little off their lattice so that no two
 * neighborhoods are alike. Arrays: SmoothingLength, Volume, Radius (distance from the origin).
 */
inline vtkSmartPointer<vtkPolyData> MakeCube(int pointType = VTK_DOUBLE)
{
  vtkNew<vtkPoints> points;
  points->SetDataType(pointType);
  unsigned int seed = 1;
  const auto jitter = [&seed]()
  {
    seed = seed * 1664525u + 1013904223u;
    return (static_cast<double>(seed >> 8) / (1 << 24) - 0.5) * 0.2 * Spacing;
  };
  for (int k = -10; k <= 10; ++k)
  {
    for (int j = -10; j <= 10; ++j)
    {
      for (int i = -10; i <= 10; ++i)
      {
        const double x = i * Spacing + jitter();
        const double y = j * Spacing + jitter();
        points->InsertNextPoint(x, y, k * Spacing + jitter());
      }
    }
  }
  auto cube = vtkSmartPointer<vtkPolyData>::New();
  cube->SetPoints(points);
  AddArray<vtkDoubleArray>(
    cube, "SmoothingLength", 1, [](vtkIdType, int) { return SmoothingLength; });
  AddArray<vtkDoubleArray>(
    cube, "Volume", 1, [](vtkIdType, int) { return Spacing * Spacing * Spacing; });
  AddArray<vtkDoubleArray>(cube, "Radius", 1,
    [&](vtkIdType i, int)
    {
      double x[3];
      points->GetPoint(i, x);
      return std::sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    });
  return cube;
}

/** A filter set up to contour Radius = 0.6 of the cube: about a sphere. */
inline vtkSmartPointer<vtkMarchingCorrectors> MakeSphereFilter(vtkDataObject* input)
{
  auto filter = vtkSmartPointer<vtkMarchingCorrectors>::New();
  filter->SetInputDataObject(input);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Radius");
  filter->SetValue(0, 0.6);
  return filter;
}

/** The cubic spline as the textbooks have it, unit h, by brute force: no code shared with the core.
 */
inline double CubicSpline(double q)
{
  const double pi = 3.14159265358979323846;
  const double w = q < 1.0 ? 1.0 - 1.5 * q * q + 0.75 * q * q * q
    : q < 2.0              ? 0.25 * (2.0 - q) * (2.0 - q) * (2.0 - q)
                           : 0.0;
  return w / pi;
}

struct FieldValue
{
  double Shepard, Sum, Weight;
};

inline FieldValue EvaluateField(
  vtkPolyData* particles, vtkDataArray* scalar, double h, const double x[3])
{
  vtkDataArray* volume = particles->GetPointData()->GetArray("Volume");
  FieldValue f = { 0.0, 0.0, 0.0 };
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    double p[3];
    particles->GetPoint(i, p);
    const double dx = x[0] - p[0], dy = x[1] - p[1], dz = x[2] - p[2];
    const double r2 = dx * dx + dy * dy + dz * dz;
    if (r2 < 4.0 * h * h)
    {
      const double vw = volume->GetComponent(i, 0) * CubicSpline(std::sqrt(r2) / h) / (h * h * h);
      f.Weight += vw;
      f.Sum += vw * scalar->GetComponent(i, 0);
    }
  }
  f.Shepard = f.Weight > 0.0 ? f.Sum / f.Weight : 0.0;
  return f;
}

inline bool SameValues(vtkDataArray* a, vtkDataArray* b)
{
  if (!a || !b)
  {
    return a == b;
  }
  if (a->GetNumberOfTuples() != b->GetNumberOfTuples() ||
    a->GetNumberOfComponents() != b->GetNumberOfComponents())
  {
    return false;
  }
  for (vtkIdType i = 0; i < a->GetNumberOfTuples(); ++i)
  {
    for (int c = 0; c < a->GetNumberOfComponents(); ++c)
    {
      const double va = a->GetComponent(i, c), vb = b->GetComponent(i, c);
      if (std::memcmp(&va, &vb, sizeof(double)) != 0)
      {
        return false;
      }
    }
  }
  return true;
}

/** Bitwise: points, triangles and all numeric point arrays. */
inline bool SameSurface(vtkPolyData* a, vtkPolyData* b)
{
  if (a->GetNumberOfPoints() != b->GetNumberOfPoints() ||
    a->GetNumberOfCells() != b->GetNumberOfCells() ||
    a->GetPointData()->GetNumberOfArrays() != b->GetPointData()->GetNumberOfArrays())
  {
    return false;
  }
  if (a->GetNumberOfPoints() == 0)
  {
    return true;
  }
  bool same = SameValues(a->GetPoints()->GetData(), b->GetPoints()->GetData()) &&
    SameValues(a->GetPolys()->GetConnectivityArray(), b->GetPolys()->GetConnectivityArray());
  for (int i = 0; same && i < a->GetPointData()->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = a->GetPointData()->GetArray(i);
    same = !array || SameValues(array, b->GetPointData()->GetArray(array->GetName()));
  }
  return same;
}

/** A statistic that is not the same for each run of the same surface. */
inline bool IsCost(const char* name)
{
  const char* const costs[] = { "Seconds", "DeviceBytesPeak", "ParticlesInReach", "Bricks",
    "NodesEvaluated", "MarchRounds" };
  bool is = false;
  for (const char* cost : costs)
  {
    is = is || std::strcmp(cost, name) == 0;
  }
  return is;
}

/** Statistics of runs, but for what these cost: bitwise, and of the same names in the same order; says what
 * differs. */
inline bool SameStatistics(vtkFieldData* a, vtkFieldData* b)
{
  bool same = a->GetNumberOfArrays() == b->GetNumberOfArrays();
  for (int i = 0; same && i < a->GetNumberOfArrays(); ++i)
  {
    if (IsCost(a->GetAbstractArray(i)->GetName()))
    {
      continue;
    }
    auto* text = vtkStringArray::SafeDownCast(a->GetAbstractArray(i));
    auto* otherText = vtkStringArray::SafeDownCast(b->GetAbstractArray(i));
    same = !std::strcmp(a->GetAbstractArray(i)->GetName(), b->GetAbstractArray(i)->GetName()) &&
      SameValues(a->GetArray(i), b->GetArray(i)) && !text == !otherText &&
      (!text || text->GetValue(0) == otherText->GetValue(0));
    if (!same)
    {
      std::cerr << "statistics differ: " << a->GetAbstractArray(i)->GetName() << std::endl;
    }
  }
  return same;
}
}

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHTemporalPair.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSMPTools.h"
#include "vtkSPHReals.h"

#include <type_traits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
const vtkIdType Grain = 8192; // particles that are worth a thread

/** Makes an array of the wider type of two, with value(tuple, component), in parallel. */
template <typename ValueT>
vtkSmartPointer<vtkDataArray> MakeArray(
  vtkDataArray* a, vtkDataArray* b, vtkIdType count, const ValueT& value)
{
  const bool isFloat = a->GetDataType() == VTK_FLOAT && b->GetDataType() == VTK_FLOAT;
  auto array = vtkSmartPointer<vtkDataArray>::Take(
    vtkDataArray::CreateDataArray(isFloat ? VTK_FLOAT : VTK_DOUBLE));
  const int components = a->GetNumberOfComponents();
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  array->SetName(a->GetName());
  array->CopyComponentNames(a);
  const auto fill = [&](auto* typed)
  {
    auto* const to = typed->GetPointer(0);
    using T = std::decay_t<decltype(*to)>;
    vtkSMPTools::For(0, count, Grain,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          for (int c = 0; c < components; ++c)
          {
            to[i * components + c] = static_cast<T>(value(i, c));
          }
        }
      });
  };
  if (isFloat)
  {
    fill(static_cast<vtkFloatArray*>(array.Get()));
  }
  else
  {
    fill(static_cast<vtkDoubleArray*>(array.Get()));
  }
  return array;
}

}

void vtkSPHTemporalPair::Interpolate(double time, vtkPolyData* output) const
{
  const double s = (time - this->Steps[0].Time) / (this->Steps[1].Time - this->Steps[0].Time);
  const bool early = s < 0.5;
  const Step &near = this->Steps[early ? 0 : 1], &far = this->Steps[early ? 1 : 0];
  const double share = early ? s : 1.0 - s; // share of the way to the other step
  vtkSPHTemporalCopy(near.Particles, output);
  output->GetFieldData()->RemoveArray("TimeValue"); // the step's own time
  if (!near.Ids)
  {
    return; // one step has no particles, and the other nothing to interpolate with
  }
  this->InterpolatePositions(near, far, share, time, output);
  this->InterpolateArrays(near, far, share, output);
}

// Positions are made in double, from the nearer step, so that a particle at rest stays where it is.
void vtkSPHTemporalPair::InterpolatePositions(
  const Step& near, const Step& far, double share, double time, vtkPolyData* output) const
{
  const double toFar = this->TimeScale * (far.Time - near.Time); // below 0 in the later half
  const double toTime = this->TimeScale * (time - near.Time);
  const auto x0 = vtkSPHAsReal(near.Particles->GetPoints()->GetData()),
             x1 = vtkSPHAsReal(far.Particles->GetPoints()->GetData());
  const bool curved = this->FollowsVelocities;
  const auto v0 = curved ? vtkSPHAsReal(near.Velocities) : x0,
             v1 = curved ? vtkSPHAsReal(far.Velocities) : x1;
  const vtkSPHReals from(x0), to(x1), begun(v0), ended(v1);
  // Hermite's cubic polynomials, for the far position and for both tangents.
  const double ofFar = share * share * (3.0 - 2.0 * share),
               ofBegun = share * (1.0 - share) * (1.0 - share),
               ofEnded = share * share * (share - 1.0);
  const auto position = [&](vtkIdType i, int c)
  {
    const vtkIdType j = near.Partners[static_cast<size_t>(i)];
    const double x = from(i, c);
    if (j < 0)
    {
      return curved ? x + toTime * begun(i, c) : x;
    }
    const double way = to(j, c) - x;
    return curved ? x + ofFar * way + toFar * (ofBegun * begun(i, c) + ofEnded * ended(j, c))
                  : x + share * way;
  };
  vtkNew<vtkPoints> points;
  points->SetData(MakeArray(x0, x1, near.Particles->GetNumberOfPoints(), position));
  output->SetPoints(points);
}

// The output already has the nearer step's data.
void vtkSPHTemporalPair::InterpolateArrays(
  const Step& near, const Step& far, double share, vtkPolyData* output) const
{
  vtkPointData* own = near.Particles->GetPointData();
  for (int k = 0; k < own->GetNumberOfArrays(); ++k)
  {
    vtkAbstractArray* array = own->GetAbstractArray(k);
    if (!this->IsInBoth(array))
    {
      output->GetPointData()->RemoveArray(array->GetName());
      continue;
    }
    vtkDataArray* other = far.Particles->GetPointData()->GetArray(array->GetName());
    if (!vtkSPHIsReal(array) || array == near.Ids)
    {
      continue;
    }
    const auto a = vtkSPHAsReal(vtkDataArray::SafeDownCast(array)), b = vtkSPHAsReal(other);
    const vtkSPHReals from(a), to(b);
    output->GetPointData()->AddArray(MakeArray(a, b, near.Particles->GetNumberOfPoints(),
      [&](vtkIdType i, int c)
      {
        const vtkIdType j = near.Partners[static_cast<size_t>(i)];
        const double value = from(i, c);
        return j < 0 ? value : value + share * (to(j, c) - value);
      }));
  }
}
VTK_ABI_NAMESPACE_END

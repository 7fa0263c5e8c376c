// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHSamples.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkSMPTools.h"
#include "vtkSPHParticles.h"

#include <algorithm>

namespace
{
/** Values that one thread copies at a time. */
constexpr vtkIdType CopyGrain = 1 << 16;

void Copy(const double* from, vtkIdType first, vtkIdType tuples, vtkDataArray* to)
{
  if (!from || !to)
  {
    return;
  }
  const vtkIdType components = to->GetNumberOfComponents();
  const vtkIdType at = first * components, count = tuples * components;
  if (auto* floats = vtkFloatArray::FastDownCast(to))
  {
    float* out = floats->GetPointer(at);
    vtkSMPTools::For(0, count, CopyGrain,
      [from, out](vtkIdType begin, vtkIdType end)
      {
        std::transform(from + begin, from + end, out + begin,
          [](double value) { return static_cast<float>(value); });
      });
  }
  else
  {
    std::copy(from, from + count, static_cast<vtkDoubleArray*>(to)->GetPointer(at));
  }
}
}

vtkSPHSamples::vtkSPHSamples(const vtkSPHParticles& particles, const mcor_options& options,
  const std::string& maskName, vtkIdType count, double null)
  : NotFinite(particles.Interpolated.size(), -1)
  , Count(count)
  , Null(null)
{
  const bool gradients = options.gradients != 0;
  for (const vtkSPHAttribute& from : particles.Interpolated)
  {
    this->Arrays.push_back(
      this->Make(from.Name, from.Components, from.Array->GetDataType() == VTK_FLOAT, gradients));
    Pair& made = this->Arrays.back();
    for (vtkDataArray* array : { made.Values.GetPointer(), made.Gradient.GetPointer() })
    {
      if (array && null != 0.0)
      {
        array->Fill(null);
      }
    }
    made.Values->CopyComponentNames(from.Array);
  }
  this->Weight = this->Make("WeightSum", 1, options.precision == MCOR_FLOAT32, gradients);
  this->Mask->SetName(maskName.c_str());
  this->Mask->SetNumberOfTuples(count);
  this->Mask->FillValue(0);
}

vtkSPHSamples::Pair vtkSPHSamples::Make(
  const std::string& name, int components, bool asFloat, bool gradient) const
{
  const auto make = [&](const std::string& itsName, int itsComponents)
  {
    auto array = vtkSmartPointer<vtkDataArray>::Take(
      vtkDataArray::CreateDataArray(asFloat ? VTK_FLOAT : VTK_DOUBLE));
    array->SetName(itsName.c_str());
    array->SetNumberOfComponents(itsComponents);
    array->SetNumberOfTuples(this->Count);
    array->Fill(0.0);
    return array;
  };
  Pair pair;
  pair.Values = make(name, components);
  if (gradient)
  {
    pair.Gradient = make(name + "_Gradient", 3 * components);
  }
  return pair;
}

void vtkSPHSamples::Put(vtkIdType first, const mcor_samples& samples)
{
  for (size_t a = 0; a < this->Arrays.size(); ++a)
  {
    this->NotFinite[a] = samples.attribute_not_finite[a];
    Copy(samples.values[a], first, samples.count, this->Arrays[a].Values);
    Copy(samples.gradients ? samples.gradients[a] : nullptr, first, samples.count,
      this->Arrays[a].Gradient);
    this->PutNull(first, samples, this->Arrays[a].Values);
    this->PutNull(first, samples, this->Arrays[a].Gradient);
  }
  Copy(samples.weight_sum, first, samples.count, this->Weight.Values);
  Copy(samples.weight_gradient, first, samples.count, this->Weight.Gradient);
  std::copy(samples.valid, samples.valid + samples.count, this->Mask->GetPointer(first));
}

void vtkSPHSamples::PutNull(vtkIdType first, const mcor_samples& samples, vtkDataArray* array) const
{
  for (vtkIdType i = 0; array && this->Null != 0.0 && i < samples.count; ++i)
  {
    for (int c = 0; !samples.valid[i] && c < array->GetNumberOfComponents(); ++c)
    {
      array->SetComponent(first + i, c, this->Null);
    }
  }
}

void vtkSPHSamples::AddTo(vtkFieldData* data) const
{
  const auto add = [data](const Pair& pair)
  {
    data->AddArray(pair.Values);
    if (pair.Gradient)
    {
      data->AddArray(pair.Gradient);
    }
  };
  for (size_t a = 0; a < this->Arrays.size(); ++a)
  {
    if (this->NotFinite[a] < 0)
    {
      add(this->Arrays[a]);
    }
  }
  add(this->Weight);
  data->AddArray(this->Mask);
}

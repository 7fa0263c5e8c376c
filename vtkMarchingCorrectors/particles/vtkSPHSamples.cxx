// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHSamples.h"

#include "vtkSMPTools.h"
#include "vtkSPHParticles.h"

#include <algorithm>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** Tuples that one thread copies at a time. */
constexpr vtkIdType CopyGrain = 1 << 14;

/** Copies values, replaced by `null` where `valid` is 0. */
template <typename ValueT>
void Copy(const double* from, const std::uint8_t* valid, double null, vtkIdType tuples,
  int components, ValueT* to)
{
  vtkSMPTools::For(0, tuples, CopyGrain,
    [=](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin * components; i < end * components; ++i)
      {
        to[i] = static_cast<ValueT>(valid && !valid[i / components] ? null : from[i]);
      }
    });
}
}

vtkSPHSamples::vtkSPHSamples(const vtkSPHParticles& particles, const mcor_options& options,
  const std::string& maskName, vtkIdType count, double null)
  : NotFinite(particles.Interpolated.size(), -1)
  , Count(count)
  , Null(null)
{
  const bool gradients = (options.outputs & MCOR_OUT_GRADIENTS) != 0;
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
  const auto copy =
    [&](const double* from, const std::uint8_t* valid, const vtkSmartPointer<vtkDataArray>& to)
  {
    const int components = to ? to->GetNumberOfComponents() : 0;
    void* out = to ? to->GetVoidPointer(first * components) : nullptr;
    if (to && to->GetDataType() == VTK_FLOAT)
    {
      Copy(from, valid, this->Null, samples.count, components, static_cast<float*>(out));
    }
    else if (to)
    {
      Copy(from, valid, this->Null, samples.count, components, static_cast<double*>(out));
    }
  };
  for (size_t a = 0; a < this->Arrays.size(); ++a)
  {
    this->NotFinite[a] = samples.attribute_not_finite[a];
    if (samples.values[a])
    {
      copy(samples.values[a], samples.valid, this->Arrays[a].Values);
      copy(samples.gradients ? samples.gradients[a] : nullptr, samples.valid,
        this->Arrays[a].Gradient);
    }
  }
  copy(samples.weight_sum, nullptr, this->Weight.Values);
  copy(samples.weight_gradient, nullptr, this->Weight.Gradient);
  std::copy(samples.valid, samples.valid + samples.count, this->Mask->GetPointer(first));
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
VTK_ABI_NAMESPACE_END

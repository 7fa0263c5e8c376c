// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "WallShare.h"

#include "CommandLineOptions.h"
#include "SurfaceRun.h"

#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHProbe.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace
{
/// The places of the particles that are not fluid.
vtkSmartPointer<vtkPolyData> SolidPoints(const CommandLineOptions& options, vtkPointSet* particles)
{
  vtkDataArray* kind = particles->GetPointData()->GetArray(options.FluidArray.c_str());
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (vtkIdType i = 0; kind && i < particles->GetNumberOfPoints(); ++i)
  {
    if (kind->GetComponent(i, 0) != options.FluidValue)
    {
      points->InsertNextPoint(particles->GetPoint(i));
    }
  }
  auto solids = vtkSmartPointer<vtkPolyData>::New();
  solids->SetPoints(points);
  return solids;
}

/// The weight sum of the particles at points.
vtkSmartPointer<vtkDataArray> WeightAt(
  const CommandLineOptions& options, vtkPointSet* particles, vtkPolyData* points)
{
  vtkNew<vtkSPHProbe> probe;
  probe->SetInputData(points);
  probe->SetSourceData(SetUpParticles(probe, options, particles));
  probe->InterpolateAttributesOff();
  probe->Update();
  const std::string error = probe->GetErrorMessage();
  auto* output = vtkDataSet::SafeDownCast(probe->GetOutputDataObject(0));
  vtkDataArray* weight = output ? output->GetPointData()->GetArray("Weight") : nullptr;
  if (!error.empty() || !weight)
  {
    throw std::runtime_error(error.empty() ? "The share of the walls was not measured." : error);
  }
  return weight;
}
}

//------------------------------------------------------------------------------
double MeasureWallShare(const CommandLineOptions& options, vtkPointSet* particles)
{
  const vtkSmartPointer<vtkPolyData> solids = SolidPoints(options, particles);
  if (solids->GetNumberOfPoints() == 0)
  {
    return 0.5;
  }
  CommandLineOptions fluid = options;
  fluid.Derive.clear();
  fluid.Solids = "ignore";
  CommandLineOptions all = fluid;
  all.FluidArray.clear();
  const vtkSmartPointer<vtkDataArray> ofFluid = WeightAt(fluid, particles, solids);
  const vtkSmartPointer<vtkDataArray> ofAll = WeightAt(all, particles, solids);
  std::vector<std::pair<double, double>> shares; // and how much each one counts
  double sum = 0.0;
  for (vtkIdType i = 0; i < solids->GetNumberOfPoints(); ++i)
  {
    const double weight = ofFluid->GetComponent(i, 0), total = ofAll->GetComponent(i, 0);
    if (weight > 0.0 && total > 0.0)
    {
      shares.emplace_back(1.0 - weight / total, weight);
      sum += weight;
    }
  }
  std::sort(shares.begin(), shares.end());
  double counted = 0.0;
  for (const auto& [share, weight] : shares)
  {
    counted += weight;
    if (counted >= 0.5 * sum)
    {
      return std::min(std::max(share, 0.01), 0.99);
    }
  }
  return 0.5;
}

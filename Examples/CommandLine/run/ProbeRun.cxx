// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ProbeRun.h"

#include "CommandLineOptions.h"
#include "DataSetFile.h"
#include "MessageCapture.h"
#include "OptionValue.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "SafeText.h"
#include "SurfaceRun.h"

#include "vtkCharArray.h"
#include "vtkDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHProbe.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <stdexcept>

namespace
{

void CheckFiles(const CommandLineOptions& options)
{
  try
  {
    CheckProbeFiles(options);
  }
  catch (const std::invalid_argument& error)
  {
    throw UsageError(error.what());
  }
}

vtkIdType CountValid(vtkDataSet* data)
{
  auto* mask = vtkCharArray::SafeDownCast(data->GetPointData()->GetArray("vtkValidPointMask"));
  const char* begin = mask->GetPointer(0);
  return std::count(begin, begin + mask->GetNumberOfValues(), 1);
}

}

//------------------------------------------------------------------------------
void CheckProbeFiles(const CommandLineOptions& options)
{
  CheckOutputs({ options.Inputs.front(), options.Probe }, { options.Output });
}

//------------------------------------------------------------------------------
void SetUpProbe(
  vtkSPHProbe* probe, const CommandLineOptions& options, vtkDataSet* points, vtkPointSet* particles)
{
  probe->SetInputData(points);
  probe->SetSourceData(SetUpParticles(probe, options, particles));
  probe->SetInterpolateAttributes(options.Attributes);
  probe->SetShepardNormalization(options.Field == "shepard");
  probe->SetWeightThreshold(options.NodeThreshold);
  probe->SetComputeGradients(options.Gradients);
}

//------------------------------------------------------------------------------
double RunProbe(vtkSPHProbe* probe, const CommandLineOptions& options, MessageCapture* messages)
{
  std::string nothing;
  ShowProgress(probe, options, &nothing);
  messages->Clear();
  const auto start = std::chrono::steady_clock::now();
  probe->Update();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  if (ShowsProgress(options))
  {
    std::fputs("\r\033[K", stderr);
  }
  const std::string error = probe->GetErrorMessage();
  if (!error.empty() || !messages->GetErrors().empty())
  {
    throw std::runtime_error(error.empty() ? messages->GetErrors().front() : error);
  }
  return elapsed.count();
}

//------------------------------------------------------------------------------
void ReportProbe(
  vtkSPHProbe* probe, const CommandLineOptions& options, double seconds, MessageCapture* messages)
{
  for (const std::string& warning : messages->GetWarnings())
  {
    Say("warning: " + warning);
  }
  auto* output = vtkDataSet::SafeDownCast(probe->GetOutput());
  if (!options.Quiet)
  {
    std::cout << "points      " << output->GetNumberOfPoints() << ", " << CountValid(output)
              << " of them valid\nseconds     " << seconds << "\n";
  }
}

//------------------------------------------------------------------------------
void ProbePoints(const CommandLineOptions& options, MessageCapture* messages)
{
  CheckFiles(options);
  vtkSmartPointer<vtkDataSet> points = ReadDataSet(options.Probe, messages);
  CheckDataSetFile(options.Output, points);
  vtkSmartPointer<vtkPointSet> particles = ReadParticles(options.Inputs.front(), messages);
  vtkNew<vtkSPHProbe> probe;
  SetUpProbe(probe, options, points, particles);
  ReportProbe(probe, options, RunProbe(probe, options, messages), messages);
  WriteDataSet(options.Output, vtkDataSet::SafeDownCast(probe->GetOutput()), messages);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankRun.h"

#include "CommandLineOptions.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ProbeRun.h"
#include "RankOutput.h"
#include "RankParticles.h"
#include "RankProbe.h"
#include "RankSession.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "SurfaceFile.h"
#include "SurfaceRun.h"

#include "vtkFieldData.h"
#include "vtkMPIController.h"
#include "vtkMarchingCorrectors.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>

namespace
{

void CheckUse(const CommandLineOptions& options, const RankSession& session)
{
  if (IsFilm(options) || !options.PictureFile.empty() || options.Repeat > 1)
  {
    throw std::runtime_error("several processes share a surface or a probe, but no film, "
                             "--screenshot or --repeat; run these without mpirun");
  }
  if (session.IsFirst() && !options.Probe.empty())
  {
    CheckProbeFiles(options);
  }
  else if (session.IsFirst())
  {
    std::vector<std::string> outputs = { options.Output };
    if (!options.StatisticsFile.empty())
    {
      outputs.push_back(options.StatisticsFile);
    }
    CheckOutputs(options.Inputs, outputs);
  }
  if (IsInPieces(options.Output))
  {
    CheckOutputs(options.Inputs, { PieceName(options.Output, session.GetRank()) });
  }
}

void WriteResult(const CommandLineOptions& options, RankSession& session, vtkPolyData* surface,
  MessageCapture* messages)
{
  if (IsInPieces(options.Output))
  {
    session.Together(
      [&] { WriteSurface(PieceName(options.Output, session.GetRank()), surface, messages); });
    session.Together(
      [&]
      {
        if (session.IsFirst())
        {
          WriteOutput(options.Output, ListPieces(options.Output, session.GetCount(), surface));
        }
      });
    return;
  }
  const vtkSmartPointer<vtkPolyData> whole = MergeOnFirst(session.GetController(), surface);
  session.Together(
    [&]
    {
      if (session.IsFirst())
      {
        WriteSurface(options.Output, whole, messages);
      }
    });
}

void Report(
  const CommandLineOptions& options, const Run& run, const std::vector<std::string>& warnings)
{
  if (!options.Quiet)
  {
    std::cout << DescribeRun(run.Statistics) << DescribeSeconds(run.Statistics) << std::flush;
  }
  for (const std::string& warning : warnings)
  {
    Say("warning: " + warning);
  }
}

void ShareSurface(CommandLineOptions options, RankSession& session, MessageCapture* messages)
{
  vtkNew<vtkMarchingCorrectors> filter;
  std::unique_ptr<Run> run;
  const vtkSmartPointer<vtkPointSet> particles =
    ReadParticlesTogether(session, options.Inputs.front(), messages);
  ResolvePeriod(options, session, particles);
  session.Together([&] { SetUpFilter(filter, options, particles); });
  session.Together([&] { run.reset(new Run(Extract(filter, options, messages))); });
  vtkDataArray* triangles = run->Statistics->GetArray("Triangles");
  const std::vector<std::string> warnings = triangles && triangles->GetComponent(0, 0) > 0
    ? messages->GetWarnings()
    : Warnings(run->Surface, run->Statistics, messages);
  if (session.IsFirst())
  {
    Report(options, *run, warnings);
  }
  const double peakResidentBytes = PeakResidentBytes();
  WriteResult(options, session, run->Surface, messages);
  session.Together(
    [&]
    {
      if (session.IsFirst() && !options.StatisticsFile.empty())
      {
        std::cout.flush();
        WriteOutput(options.StatisticsFile,
          StatisticsAsJson(
            options, { run->Statistics.Get() }, { run->WallSeconds }, warnings, peakResidentBytes));
      }
    });
}
}

//------------------------------------------------------------------------------
bool RunTogether(const CommandLineOptions& options, MessageCapture* messages)
{
  RankSession session;
  try
  {
    session.Together([&] { CheckUse(options, session); });
    options.Probe.empty() ? ShareSurface(options, session, messages)
                          : ShareProbe(options, session, messages);
  }
  catch (const std::exception& error)
  {
    if (session.IsFirst())
    {
      Say(error.what());
    }
    return false;
  }
  return true;
}

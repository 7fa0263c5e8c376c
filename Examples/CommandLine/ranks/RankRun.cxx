// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankRun.h"

#include "ColorScale.h"
#include "ComponentRun.h"
#include "Film.h"
#include "GaugeRun.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "ProbeRun.h"
#include "RankOutput.h"
#include "RankParticles.h"
#include "RankProbe.h"
#include "RankSession.h"
#include "RankSteps.h"
#include "RunStatistics.h"
#include "SafeText.h"
#include "SurfaceFile.h"
#include "SurfaceRun.h"

#include "vtkFieldData.h"
#include "vtkMPIController.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <stdexcept>

namespace
{

void CheckUse(const Job& job, const RankSession& session, MessageCapture* messages)
{
  if (!job.Picture.File.empty() || job.Repeat > 1)
  {
    throw std::runtime_error("several processes share a surface, a film, a probe or gauges, but no "
                             "--screenshot or --repeat; run these without mpirun");
  }
  if (job.IsGauge() || job.IsFilm())
  {
    return; // these look for themselves
  }
  if (job.IsProbe())
  {
    if (session.IsFirst())
    {
      CheckProbeFiles(job, messages);
    }
    return;
  }
  std::vector<std::string> outputs;
  for (int rank = 0; IsInPieces(job.Output) && rank < session.GetCount(); ++rank)
  {
    if (session.IsFirst() || rank == session.GetRank())
    {
      outputs.push_back(PieceName(job.Output, rank));
    }
  }
  if (session.IsFirst())
  {
    outputs.insert(outputs.end(), { job.Output, job.StatisticsFile, job.ComponentFile });
  }
  CheckOutputs(ListFiles(job.InputFiles(), messages), outputs);
}

/// Puts what this process writes beside its places.
void WriteSurface(const Job& job, const RankSession& session, vtkPolyData* own, vtkPolyData* whole,
  const ColorScale& colors, MessageCapture* messages, OutputFiles& files)
{
  if (IsInPieces(job.Output))
  {
    const std::string piece = PieceName(job.Output, session.GetRank());
    files.Write(piece, SurfaceBytes(piece, own, colors, messages));
  }
  if (!session.IsFirst())
  {
    return;
  }
  files.Write(job.Output,
    whole ? SurfaceBytes(job.Output, whole, colors, messages)
          : ListPieces(job.Output, session.GetCount(), own));
}

void Report(const Job& job, const Run& run, const std::vector<std::string>& warnings)
{
  if (!job.Quiet)
  {
    std::cout << DescribeRun(run.Statistics) << DescribeSeconds(run.Statistics) << std::flush;
  }
  for (const std::string& warning : warnings)
  {
    Say("warning: " + warning);
  }
}

/// The filters share their runs for as long as it lives; they were made before MPI began.
class Shared
{
public:
  Shared(const Job& job, const RankSession& session)
    : Sharing(job)
  {
    this->Set(session.GetController());
  }
  ~Shared() { this->Set(nullptr); }
  Shared(const Shared&) = delete;
  void operator=(const Shared&) = delete;

private:
  void Set(vtkMultiProcessController* controller) const
  {
    for (vtkSPHAlgorithm* filter : this->Sharing.All())
    {
      filter->SetController(controller);
    }
  }

  const Job& Sharing;
};

void ShareSurface(Job& job, RankSession& session, MessageCapture* messages)
{
  Run run;
  const vtkSmartPointer<vtkPointSet> particles =
    ReadParticlesDistributed(session, { job.Inputs.front() }, job.Walls, messages);
  ResolvePeriod(job, session, particles);
  session.RunOnAll([&] { SetUpSurface(job, particles); });
  session.RunOnAll([&] { run = Extract(job, messages); });
  std::vector<std::string> warnings = Warnings(run, messages);
  const double peakResidentBytes = PeakResidentBytes();
  ComponentTable pieces(job);
  session.RunOnAll([&] { pieces.Add(run, particles, messages); });
  vtkSmartPointer<vtkPolyData> whole;
  if (!IsInPieces(job.Output))
  {
    whole = MergeOnFirst(session.GetController(), run.Surface);
  }
  ColorScale colors(job.Picture);
  OutputFiles files;
  session.RunOnAll(
    [&]
    {
      if (whole)
      {
        colors.Include(whole);
        const std::string lost =
          LostArrays(job.Output, whole, colors, ArraysWithoutPlace(job, particles));
        warnings.insert(warnings.end(), lost.empty() ? 0 : 1, lost);
      }
      WriteSurface(job, session, run.Surface, whole, colors, messages, files);
      if (session.IsFirst() && !job.ComponentFile.empty())
      {
        files.Write(job.ComponentFile, pieces.Text());
      }
      if (session.IsFirst() && !job.StatisticsFile.empty())
      {
        files.Write(job.StatisticsFile,
          StatisticsAsJson(
            job, { run.Statistics }, { run.WallSeconds }, warnings, peakResidentBytes));
      }
    });
  if (session.IsFirst())
  {
    Report(job, run, warnings);
  }
  session.RunOnAll([&] { files.Commit(); }); // only where all have written all
}
}

bool RunDistributed(Job& job, MessageCapture* messages)
{
  RankSession session;
  const Shared shared(job, session);
  try
  {
    session.RunOnAll([&] { CheckUse(job, session, messages); });
    if (job.IsGauge())
    {
      return MakeGaugeTable(job, messages, ShareSteps(job, session, messages));
    }
    if (job.IsFilm())
    {
      return MakeFilm(job, messages, ShareSteps(job, session, messages));
    }
    job.IsProbe() ? ShareProbe(job, session, messages) : ShareSurface(job, session, messages);
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

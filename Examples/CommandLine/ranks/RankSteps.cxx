// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankSteps.h"

#include "Job.h"
#include "RankOutput.h"
#include "RankParticles.h"
#include "RankSession.h"

#include "vtkMPIController.h"

namespace
{

/// A step that is stored as that of a single surface; between two, it is the first process's.
vtkSmartPointer<vtkPointSet> ReadStep(RankSession& session, MessageCapture* messages,
  ParticleTimes& times, double time, std::vector<std::string>& warnings)
{
  if (times.IsStored(time))
  {
    return ReadParticlesDistributed(
      session, times.ListFiles(time), times.ListWalls(time), messages, true);
  }
  return ShareParticles(session, [&] { return times.At(time, warnings); }, true);
}

}

StepSharing ShareSteps(Job& job, RankSession& session, MessageCapture* messages)
{
  StepSharing sharing;
  sharing.IsFirst = session.IsFirst();
  sharing.OnAll = [&session](const std::function<void()>& work) { session.RunOnAll(work); };
  sharing.Read = [&job, &session, messages, periodic = job.Periodic, detect = job.DetectPeriod](
                   ParticleTimes& times, double time, std::vector<std::string>& warnings)
  {
    const vtkSmartPointer<vtkPointSet> particles =
      ReadStep(session, messages, times, time, warnings);
    job.Periodic = periodic; // of each step anew
    job.DetectPeriod = detect;
    ResolvePeriod(job, session, particles);
    return particles;
  };
  sharing.Merge = [&session](vtkPolyData* part)
  { return MergeOnFirst(session.GetController(), part); };
  return sharing;
}

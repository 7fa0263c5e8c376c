// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankGauge.h"

#include "GaugeRun.h"
#include "Job.h"
#include "RankParticles.h"
#include "RankSession.h"

#include "vtkPointSet.h"

//------------------------------------------------------------------------------
bool ShareGauges(Job& job, RankSession& session, MessageCapture* messages)
{
  const std::vector<double> periodic = job.Periodic;
  const bool detect = job.DetectPeriod;
  GaugeSharing sharing;
  sharing.IsFirst = session.IsFirst();
  sharing.OnAll = [&](const std::function<void()>& work) { session.RunOnAll(work); };
  sharing.Read = [&](const std::vector<std::string>& files)
  {
    const vtkSmartPointer<vtkPointSet> particles =
      ReadParticlesDistributed(session, files, job.Walls, messages);
    job.Periodic = periodic; // of each step anew
    job.DetectPeriod = detect;
    ResolvePeriod(job, session, particles);
    return particles;
  };
  return MakeGaugeTable(job, messages, sharing);
}

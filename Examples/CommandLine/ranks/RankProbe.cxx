// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankProbe.h"

#include "DataSetFile.h"
#include "Job.h"
#include "ParticleFile.h"
#include "ProbeRun.h"
#include "RankParticles.h"
#include "RankSession.h"

#include "vtkMPIController.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHProbe.h"

void ShareProbe(Job& job, RankSession& session, MessageCapture* messages)
{
  vtkSmartPointer<vtkDataSet> points;
  session.RunOnAll(
    [&]
    {
      if (session.IsFirst())
      {
        points = ReadPoints(job, messages);
      }
    });
  const vtkSmartPointer<vtkPointSet> particles =
    ReadParticlesDistributed(session, { job.Inputs.front() }, job.Walls, messages);
  ResolvePeriod(job, session, particles);
  double seconds = 0.0;
  session.RunOnAll(
    [&]
    {
      const vtkSmartPointer<vtkDataSet> made =
        job.ProbeFile.empty() ? MakePoints(job, particles) : nullptr;
      points = points || !session.IsFirst() ? points : made;
      points = points ? points : vtkSmartPointer<vtkDataSet>(vtkSmartPointer<vtkPolyData>::New());
      SetUpProbe(job, points, particles);
    });
  session.RunOnAll([&] { seconds = RunProbe(job, messages); });
  session.RunOnAll(
    [&]
    {
      if (session.IsFirst())
      {
        ReportProbe(job, seconds, messages);
        WriteDataSet(job.Output, vtkDataSet::SafeDownCast(job.Probe->GetOutput()), messages);
      }
    });
}

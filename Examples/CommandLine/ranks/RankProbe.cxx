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

namespace
{

/// Of the particles of all processes.
void FindBounds(const RankSession& session, vtkPointSet* particles, double bounds[6])
{
  double lowest[6], own[6]; // and the highest, negative
  particles->GetBounds(own);
  for (int i = 0; i < 6; ++i)
  {
    own[i] *= i % 2 ? -1.0 : 1.0;
    own[i] = particles->GetNumberOfPoints() > 0 ? own[i] : VTK_DOUBLE_MAX;
  }
  session.GetController()->AllReduce(own, lowest, 6, vtkCommunicator::MIN_OP);
  for (int i = 0; i < 6; ++i)
  {
    bounds[i] = lowest[i] * (i % 2 ? -1.0 : 1.0);
  }
}

}

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
  double bounds[6];
  FindBounds(session, particles, bounds);
  double seconds = 0.0;
  session.RunOnAll(
    [&]
    {
      if (!points && session.IsFirst())
      {
        points = MakePoints(job, bounds);
      }
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

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankProbe.h"

#include "CommandLineOptions.h"
#include "DataSetFile.h"
#include "ParticleFile.h"
#include "ProbeRun.h"
#include "RankParticles.h"
#include "RankSession.h"

#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHProbe.h"

//------------------------------------------------------------------------------
void ShareProbe(CommandLineOptions options, RankSession& session, MessageCapture* messages)
{
  vtkSmartPointer<vtkDataSet> points = vtkSmartPointer<vtkPolyData>::New();
  session.Together(
    [&]
    {
      if (session.IsFirst())
      {
        points = ReadDataSet(options.Probe, messages);
        CheckDataSetFile(options.Output, points);
      }
    });
  const vtkSmartPointer<vtkPointSet> particles =
    ReadParticlesTogether(session, options.Inputs.front(), messages);
  ResolvePeriod(options, session, particles);
  vtkNew<vtkSPHProbe> probe;
  double seconds = 0.0;
  session.Together([&] { SetUpProbe(probe, options, points, particles); });
  session.Together([&] { seconds = RunProbe(probe, options, messages); });
  session.Together(
    [&]
    {
      if (session.IsFirst())
      {
        ReportProbe(probe, options, seconds, messages);
        WriteDataSet(options.Output, vtkDataSet::SafeDownCast(probe->GetOutput()), messages);
      }
    });
}

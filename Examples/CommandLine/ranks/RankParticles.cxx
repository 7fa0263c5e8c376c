// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankParticles.h"

#include "Job.h"
#include "ParticleFile.h"
#include "PeriodOfData.h"
#include "RankSession.h"
#include "Walls.h"

#include "vtkMPIController.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHPeriod.h"

#include <stdexcept>

namespace
{

/// Processes without particles get the arrays, without values, that the first one with some has: what a
/// name in the options is must not depend on who asks.
vtkSmartPointer<vtkPointSet> GiveArrays(
  const RankSession& session, vtkPointSet* particles, bool mayBeEmpty)
{
  vtkMPIController* controller = session.GetController();
  const int own = particles->GetNumberOfPoints() > 0 ? session.GetRank() : session.GetCount();
  int from = own;
  controller->AllReduce(&own, &from, 1, vtkCommunicator::MIN_OP);
  if (from == session.GetCount() && mayBeEmpty)
  {
    return particles;
  }
  if (from == session.GetCount())
  {
    throw std::runtime_error("the input holds no points");
  }
  vtkNew<vtkPolyData> form;
  if (from == session.GetRank())
  {
    // With one particle: of none, VTK does not send the arrays.
    vtkNew<vtkPoints> points;
    vtkPointData* arrays = form->GetPointData();
    points->InsertNextPoint(particles->GetPoint(0));
    form->SetPoints(points);
    arrays->CopyAllOn();
    arrays->CopyAllocate(particles->GetPointData(), 1);
    arrays->CopyData(particles->GetPointData(), vtkIdType(0), vtkIdType(0));
  }
  controller->Broadcast(form, from);
  if (particles->GetNumberOfPoints() > 0)
  {
    return particles;
  }
  vtkNew<vtkPoints> none;
  form->SetPoints(none);
  form->GetPointData()->SetNumberOfTuples(0);
  return form.Get();
}

}

vtkSmartPointer<vtkPointSet> ReadParticlesDistributed(RankSession& session,
  const std::vector<std::string>& files, const std::vector<std::string>& walls,
  MessageCapture* messages, bool mayBeEmpty)
{
  if (files.size() > 1 || !walls.empty())
  {
    return ShareParticles(
      session,
      [&] {
        return AddWalls(ReadParticles(files, messages, mayBeEmpty), ReadWalls(walls, messages));
      },
      mayBeEmpty);
  }
  vtkSmartPointer<vtkPointSet> particles;
  session.RunOnAll(
    [&] {
      particles = ReadParticlesPart(files.front(), session.GetRank(), session.GetCount(), messages);
    });
  return GiveArrays(session, particles, mayBeEmpty);
}

vtkSmartPointer<vtkPointSet> ShareParticles(RankSession& session,
  const std::function<vtkSmartPointer<vtkPointSet>()>& make, bool mayBeEmpty)
{
  vtkSmartPointer<vtkPointSet> particles = vtkSmartPointer<vtkPolyData>::New();
  session.RunOnAll(
    [&]
    {
      if (session.IsFirst())
      {
        particles = make();
      }
    });
  return GiveArrays(session, particles, mayBeEmpty);
}

void ResolvePeriod(Job& job, RankSession& session, vtkPointSet* particles)
{
  if (job.DetectPeriod)
  {
    std::string problem;
    const vtkSPHPeriod found =
      vtkSPHFindPeriodDistributed(session.GetController(), particles->GetFieldData(), problem);
    session.RunOnAll([&] { job.Periodic = CheckedPeriod(found, problem); });
    job.DetectPeriod = false;
  }
  if (job.Periodic.size() == 3)
  {
    job.Periodic =
      vtkSPHBoundsOfPeriodDistributed(session.GetController(), job.Periodic, particles);
  }
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankParticles.h"

#include "CommandLineOptions.h"
#include "ParticleFile.h"
#include "RankSession.h"

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
vtkSmartPointer<vtkPointSet> GiveArrays(const RankSession& session, vtkPointSet* particles)
{
  vtkMPIController* controller = session.GetController();
  const int own = particles->GetNumberOfPoints() > 0 ? session.GetRank() : session.GetCount();
  int from = own;
  controller->AllReduce(&own, &from, 1, vtkCommunicator::MIN_OP);
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

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> ReadParticlesTogether(
  RankSession& session, const std::string& file, MessageCapture* messages)
{
  vtkSmartPointer<vtkPointSet> particles;
  session.Together(
    [&] { particles = ReadParticlesPart(file, session.GetRank(), session.GetCount(), messages); });
  return GiveArrays(session, particles);
}

//------------------------------------------------------------------------------
void ResolvePeriod(CommandLineOptions& options, const RankSession& session, vtkPointSet* particles)
{
  if (options.Periodic.size() != 3)
  {
    return;
  }
  double ends[6], all[6];
  particles->GetBounds(ends);
  const bool isEmpty = particles->GetNumberOfPoints() == 0;
  for (int side = 0; side < 6; ++side)
  {
    ends[side] = isEmpty ? 1e300 : side % 2 == 0 ? ends[side] : -ends[side];
  }
  session.GetController()->AllReduce(ends, all, 6, vtkCommunicator::MIN_OP);
  for (int side = 1; side < 6; side += 2)
  {
    all[side] = -all[side];
  }
  options.Periodic = vtkSPHBoundsOfPeriod(options.Periodic, all);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankSession_h
#define RankSession_h

#include "Sharing.h"

#include "vtkMPIController.h"
#include "vtkNew.h"
#include "vtkSPHRanksWait.h"

/// MPI, from begin to end, and the processes of mpirun that share a job. One per process. Pieces of
/// a file are read by all of them, a single one by the first. A surface is written as one piece
/// each for a .pvtp file, else the first one writes the whole.
class RankSession : public Sharing
{
public:
  RankSession(Job& job, MessageCapture* messages);
  ~RankSession() override;

  int GetRank() const override { return this->Controller->GetLocalProcessId(); }
  int GetCount() const override { return this->Controller->GetNumberOfProcesses(); }
  void OnAll(const std::function<void()>& work) override;
  Particles Read() override;
  Particles Read(ParticleTimes& times, double time, std::vector<std::string>& warnings) override;
  /// Puts the parts in the order of GlobalPointIds and GlobalCellIds, and drops these arrays.
  vtkSmartPointer<vtkPolyData> Merge(vtkPolyData* part) override
  {
    return vtkSPHMergeSurface(this->Controller, part);
  }
  vtkSmartPointer<vtkPolyData> Append(vtkPolyData* particles) override;

private:
  /// The part of particles that each process reads of one file, or that the first one makes;
  /// `mayBeEmpty`: all together.
  Particles Part(const std::string& file, bool mayBeEmpty);
  Particles Share(const std::function<Particles()>& make, bool mayBeEmpty);

  /// Processes without particles get the arrays, without values, that those of the others have:
  /// what a name in the options is must not depend on who asks. The period is that of all.
  Particles Complete(vtkPointSet* particles, bool mayBeEmpty);

  vtkNew<vtkMPIController> Controller;
  const std::vector<double> Periodic; ///< as the job had it
  const bool DetectPeriod;
};

#endif

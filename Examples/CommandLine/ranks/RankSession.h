// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankSession_h
#define RankSession_h

#include "vtkNew.h"

#include <functional>
#include <string>

class vtkMPIController;

/// MPI, from begin to end. One per process.
class RankSession
{
public:
  RankSession();
  ~RankSession();

  int GetRank() const;
  int GetCount() const;
  bool IsFirst() const { return this->GetRank() == 0; }
  vtkMPIController* GetController() const { return this->Controller; }

  /// All ranks do this work, which may differ. Where it throws on some of them, all throw
  /// std::runtime_error with the sentence of the first one.
  void RunOnAll(const std::function<void()>& work);

private:
  RankSession(const RankSession&) = delete;
  void operator=(const RankSession&) = delete;

  vtkNew<vtkMPIController> Controller;
};

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankSession.h"

#include "Sentences.h"

#include "vtkMPIController.h"
#include "vtkSPHRanksWait.h"

#include <stdexcept>

RankSession::RankSession()
{
  int count = 0;
  char** none = nullptr;
  this->Controller->Initialize(&count, &none, 0);
  vtkMultiProcessController::SetGlobalController(this->Controller);
}

RankSession::~RankSession()
{
  vtkMultiProcessController::SetGlobalController(nullptr);
  this->Controller->Finalize();
}

int RankSession::GetRank() const
{
  return this->Controller->GetLocalProcessId();
}

int RankSession::GetCount() const
{
  return this->Controller->GetNumberOfProcesses();
}

void RankSession::RunOnAll(const std::function<void()>& work)
{
  std::string sentence = FailureOf(work);
  const int self = sentence.empty() ? this->GetCount() : this->GetRank();
  int failed = self;
  vtkSPHAwaitRanks(this->Controller);
  this->Controller->AllReduce(&self, &failed, 1, vtkCommunicator::MIN_OP);
  if (failed == this->GetCount())
  {
    return;
  }
  vtkIdType size = static_cast<vtkIdType>(sentence.size());
  this->Controller->Broadcast(&size, 1, failed);
  sentence.resize(static_cast<std::size_t>(size));
  this->Controller->Broadcast(&sentence[0], size, failed);
  throw std::runtime_error(sentence);
}

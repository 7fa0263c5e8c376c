// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankParticles_h
#define RankParticles_h

#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class MessageCapture;
class RankSession;
class vtkPointSet;
struct Job;

/// Each process's part of a file, with the same arrays in all of them; a single file, several that are parts of one
/// set, and all where there are walls, are the first one's.
/// Throws std::runtime_error on all of them alike.
vtkSmartPointer<vtkPointSet> ReadParticlesDistributed(
  RankSession& session, const std::vector<std::string>& files,
  const std::vector<std::string>& walls, MessageCapture* messages, bool mayBeEmpty = false);

/// The same of particles that the first process makes.
vtkSmartPointer<vtkPointSet> ShareParticles(RankSession& session,
  const std::function<vtkSmartPointer<vtkPointSet>()>& make, bool mayBeEmpty = false);

/// --periodic with lengths alone asks where all particles are; auto, whose field data tell of a period.
void ResolvePeriod(Job& job, RankSession& session, vtkPointSet* particles);

#endif

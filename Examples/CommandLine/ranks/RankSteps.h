// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankSteps_h
#define RankSteps_h

#include "StepSharing.h"

class MessageCapture;
class RankSession;
struct Job;

/// Steps that all processes make together, and the first one writes. The arguments must outlive it.
StepSharing ShareSteps(Job& job, RankSession& session, MessageCapture* messages);

#endif

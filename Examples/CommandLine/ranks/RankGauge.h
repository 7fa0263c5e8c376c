// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankGauge_h
#define RankGauge_h

class MessageCapture;
class RankSession;
struct Job;

/// Gauges that all processes measure; the first one writes. False if a step failed, of which all was said. Throws
/// std::runtime_error on all of them alike.
bool ShareGauges(Job& job, RankSession& session, MessageCapture* messages);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankProbe_h
#define RankProbe_h

class MessageCapture;
class RankSession;
struct Job;

/// A probe that all processes share; the first one reads the points and writes the result. Throws
/// std::runtime_error on all of them alike.
void ShareProbe(Job& job, RankSession& session, MessageCapture* messages);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ProbeRun_h
#define ProbeRun_h

class MessageCapture;
class Sharing;
struct Job;

/// Evaluates the field at the points of a file, of a slice or of a line, and writes their data set with the
/// arrays. Throws UsageError or std::runtime_error with one sentence.
void ProbePoints(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif

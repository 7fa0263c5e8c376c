// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ProbeRun_h
#define ProbeRun_h

class MessageCapture;
struct CommandLineOptions;

/// Evaluates the field at the points of a file and writes their data set with the arrays. Throws
/// UsageError or std::runtime_error with one sentence.
void ProbePoints(const CommandLineOptions& options, MessageCapture* messages);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankRun_h
#define RankRun_h

struct CommandLineOptions;
class MessageCapture;

/// The surface or the probe of particles that processes of mpirun share: pieces of a file are read by all
/// of them, a single one by the first. A surface is written as one piece each for a .pvtp file, else the
/// first one writes the whole. False if it failed; the first process has said why.
bool RunTogether(const CommandLineOptions& options, MessageCapture* messages);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankRun_h
#define RankRun_h

struct Job;
class MessageCapture;

/// The surface, film, probe or gauges of particles that processes of mpirun share: pieces of a file are read by all
/// of them, a single one by the first. A surface is written as one piece each for a .pvtp file, else the
/// first one writes the whole: all write beside the places of their files, which are taken only where none
/// of them failed. False if it failed; the first process has said why.
bool RunDistributed(Job& job, MessageCapture* messages);

#endif

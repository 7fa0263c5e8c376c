// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ProjectionRun_h
#define ProjectionRun_h

class MessageCapture;
class Sharing;
struct Job;

/// Projects the particles, and writes the image. Throws UsageError or std::runtime_error with one sentence.
void ProjectParticles(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif

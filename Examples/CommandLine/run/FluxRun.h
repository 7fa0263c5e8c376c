// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FluxRun_h
#define FluxRun_h

class MessageCapture;
class Sharing;
struct Job;

/// Measures what flows through sections at each time of the input, and what has flowed since the first one, and writes
/// the table. False if a step failed, of which all was said; the table has the others. Throws UsageError or
/// std::runtime_error with one sentence.
bool MakeFluxTable(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif

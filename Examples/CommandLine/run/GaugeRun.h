// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef GaugeRun_h
#define GaugeRun_h

#include "GaugeLine.h"
#include <string>
#include <vector>

class MessageCapture;
class Sharing;
struct Job;

/// Gauges of the options, in their order. Throws UsageError or std::runtime_error with one sentence.
std::vector<GaugeLine> ListGauges(const Job& job);

/// Adds gauges to the job's filter.
void AddGauges(const Job& job, const std::vector<GaugeLine>& gauges);

/// Measures the free surface along lines at each time of the input, and writes the table, or, of a grid
/// of lines, an image. False if a step failed, of which all was said; the table has the others. Throws
/// UsageError or std::runtime_error with one sentence.
bool MakeGaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing);

#endif

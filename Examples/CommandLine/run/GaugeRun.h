// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef GaugeRun_h
#define GaugeRun_h

class MessageCapture;
struct Job;

/// Measures the free surface along lines at each step of the input, and writes the table, or, of a grid
/// of lines, an image. False if a step failed, of which all was said; the table has the others. Throws
/// UsageError or std::runtime_error with one sentence.
bool MeasureGauges(const Job& job, MessageCapture* messages);

#endif

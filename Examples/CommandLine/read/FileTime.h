// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FileTime_h
#define FileTime_h

#include <string>

class MessageCapture;

/// Whether the field data at the beginning of a VTK file tell of its time (TimeValue, TIME, time).
/// Points and their arrays are not read.
bool ReadTime(const std::string& file, MessageCapture* messages, double& time);

#endif

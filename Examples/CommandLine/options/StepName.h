// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef StepName_h
#define StepName_h

#include <cstddef>
#include <string>

/// Names of a film's files with the number of the step in them: frame_%04d.png.

/// Whether the name has one such place, %d or %0Nd, and no other percent sign.
bool HasStepNumber(const std::string& name);

/// The last number in a file's name, without its folder: 120 of WaterBody_120.vtp. False if there is none.
bool FindStepNumber(const std::string& file, std::size_t& number);

/// frame_0007.png
std::string NameOfStep(const std::string& name, std::size_t step);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#ifndef PeriodOfData_h
#define PeriodOfData_h

// The period that particles' field data tell of.

#include <string>
#include <vector>

class vtkDataObject;
struct vtkSPHPeriod;

/// Gives the field data that may tell of a period, and no other.
void PassPeriod(vtkDataObject* from, vtkDataObject* to);

/// The period that was found, if there is no problem. Throws std::runtime_error where nothing was.
std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem);

/// The period for "--periodic auto". Throws std::runtime_error where there is none.
std::vector<double> DetectPeriod(vtkDataObject* particles);

/// A hint where --periodic is not given and there is a period; else "".
std::string HintOfPeriod(vtkDataObject* particles);

#endif

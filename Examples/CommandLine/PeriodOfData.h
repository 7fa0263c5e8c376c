// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#ifndef PeriodOfData_h
#define PeriodOfData_h

// The period that particles' field data tell of.

#include <string>
#include <vector>

class vtkDataObject;

struct PeriodOfData
{
  std::vector<double> Period; ///< three lengths or six bounds, like --periodic; empty: none is told
  std::string Array;          ///< that tells of it
};

/// Of an array PeriodicBounds, of BoxSize (GADGET, SWIFT), or of box where boundaryType says that it
/// repeats (SPH-EXA); whatever the case. One that is no period tells of none.
PeriodOfData FindPeriod(vtkDataObject* particles);

/// Gives the field data that may tell of a period, and no other.
void PassPeriod(vtkDataObject* from, vtkDataObject* to);

/// The period for "--periodic auto". Throws std::runtime_error where there is none.
std::vector<double> DetectPeriod(vtkDataObject* particles);

/// What to say where --periodic is not given and there is a period; else "".
std::string HintOfPeriod(vtkDataObject* particles);

#endif

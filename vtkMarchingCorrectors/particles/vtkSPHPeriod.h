// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: the period that particles' field data tell of.
 */
#ifndef vtkSPHPeriod_h
#define vtkSPHPeriod_h

#include "vtkMarchingCorrectorsModule.h"

#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkFieldData;
class vtkMultiProcessController;
class vtkPointSet;

struct vtkSPHPeriod
{
  std::vector<double> Period; ///< three lengths or six bounds; empty: none is told
  std::string Array;          ///< that tells of it
};

/**
 * As mcor_find_period finds it.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSPHPeriod vtkSPHFindPeriod(vtkFieldData* data);

/** Whether an array of this name has a part in that. */
VTKMARCHINGCORRECTORS_EXPORT bool vtkSPHTellsOfPeriod(const char* name);

/** Six bounds, also of lengths alone: where the particles, of this extent, lie in them. */
VTKMARCHINGCORRECTORS_EXPORT std::vector<double> vtkSPHBoundsOfPeriod(
  const std::vector<double>& period, const double extent[6]);

/**
 * The same where many processes hold the particles: of the first of them whose field data tell of a period.
 * `problem` becomes a sentence where those of another one tell of another period. Collective.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSPHPeriod vtkSPHFindPeriodDistributed(
  vtkMultiProcessController* controller, vtkFieldData* data, std::string& problem);

/** The bounds over all processes' particles; a process may have none. Collective. */
VTKMARCHINGCORRECTORS_EXPORT std::vector<double> vtkSPHBoundsOfPeriodDistributed(
  vtkMultiProcessController* controller, const std::vector<double>& period, vtkPointSet* particles);
VTK_ABI_NAMESPACE_END

#endif

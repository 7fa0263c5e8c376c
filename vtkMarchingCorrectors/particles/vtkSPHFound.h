// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: if the user has chosen no arrays or no period, finds the particles'
 * arrays by their names, and the period in the particles' field data.
 */
#ifndef vtkSPHFound_h
#define vtkSPHFound_h

#include "vtkMarchingCorrectorsModule.h"

#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkFieldData;
class vtkMultiProcessController;
class vtkPointSet;

/** Names of arrays, or words for a velocity from several arrays; empty: none found. FluidValue: marks fluid in the array Fluid. */
struct vtkSPHFound
{
  std::string SmoothingLength, Volume, Mass, Density, Velocity, Fluid;
  double FluidValue = 0.0;
};

VTKMARCHINGCORRECTORS_EXPORT vtkSPHFound vtkSPHFindArrays(vtkPointSet* particles);

/** The period that field data tell. */
struct vtkSPHPeriod
{
  std::vector<double> Period; ///< three lengths or six bounds; empty: no period is told
  std::string Array;          ///< the array that tells the period, or else a tilted cell
  bool IsTilted() const { return this->Period.empty() && !this->Array.empty(); }
};

/** Finds the period in field data, see mcor_find_period. */
VTKMARCHINGCORRECTORS_EXPORT vtkSPHPeriod vtkSPHFindPeriod(vtkFieldData* data);

/** Whether an array of this name may tell a period. */
VTKMARCHINGCORRECTORS_EXPORT bool vtkSPHTellsOfPeriod(const char* name);

/** Whether a table's column of this name tells particles or their kinds apart, see mcor_tells_apart. */
VTKMARCHINGCORRECTORS_EXPORT bool vtkSPHTellsApart(const char* name);
/** Returns how usual a name is for a column of positions, see mcor_name_priority. */
VTKMARCHINGCORRECTORS_EXPORT int vtkSPHPositionPriority(const char* name);

/** Returns the six bounds of a period. period: these bounds, or three lengths, which mcor_place_period() places by the extent. */
VTKMARCHINGCORRECTORS_EXPORT std::vector<double> vtkSPHBoundsOfPeriod(
  const std::vector<double>& period, const double extent[6]);

/**
 * Finds the period in the field data of the first process that has a period or a tilted cell.
 * `problem` becomes a sentence if another process has a different one. Collective.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSPHPeriod vtkSPHFindPeriodDistributed(
  vtkMultiProcessController* controller, vtkFieldData* data, std::string& problem);

/** Does what vtkSPHBoundsOfPeriod() does, with the extent of all processes' particles. Collective. */
VTKMARCHINGCORRECTORS_EXPORT std::vector<double> vtkSPHBoundsOfPeriodDistributed(
  vtkMultiProcessController* controller, const std::vector<double>& period, vtkPointSet* particles);
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what a run found and used, in words for a panel, and what a run may take.
 */
#ifndef vtkMarchingCorrectorsSummary_h
#define vtkMarchingCorrectorsSummary_h

#include "mcor.h"

#include <string>

class vtkMarchingCorrectorsInput;

/**
 * From this number of cells in the fluid on, a run is said to be a huge one.
 */
constexpr double vtkMarchingCorrectorsHugeCells = 1e9;

/**
 * The least smoothing length of the fluid, as the input has it; 1 where it is estimated in the run.
 * Infinite without fluid.
 */
double vtkMarchingCorrectorsLeastLength(const mcor_input& input);

/**
 * About how many cubes (in a plane squares) of the virtual grid the fluid, in the box if there is one, fills:
 * a particle takes (h / 1.3)^3. 0 where the smoothing length is estimated in the run and the cube size does not
 * follow from it. least: of vtkMarchingCorrectorsLeastLength, over all processes that share the run.
 */
double vtkMarchingCorrectorsEstimateCells(
  const mcor_input& input, const mcor_options& options, double least);

/** "0.0236", "0.02 to 0.045 (array h)": at most six digits. */
std::string vtkMarchingCorrectorsDescribeSmoothingLength(
  const mcor_input& input, const mcor_statistics& statistics);

/** Of the surface; empty where there is none. */
std::string vtkMarchingCorrectorsDescribeMeasures(const mcor_statistics& statistics);

/** "array Mass / array Density", "computed from the positions". */
std::string vtkMarchingCorrectorsDescribeVolume(const mcor_input& input);

/** "1, 2.5". */
std::string vtkMarchingCorrectorsDescribeIsoValues(const mcor_options& options);

#endif

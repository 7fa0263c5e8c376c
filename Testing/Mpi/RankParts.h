// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Ways to strew particles over ranks, and what these make of them beside what one process makes.
 */
#ifndef RankParts_h
#define RankParts_h

#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class vtkDataArray;
class vtkMPIController;
class vtkMultiProcessController;
class vtkPolyData;

constexpr int PartCount = 6;

const char* PartName(int part);

/// Reads the particles of a .vtp file.
vtkSmartPointer<vtkPolyData> ReadParticles(const std::string& file);

/// Returns a rank's share of the particles.
vtkSmartPointer<vtkPolyData> TakePart(vtkPolyData* particles, int part, int rank, int count);

/// Compares the points of a part, except those that `given` marks as another rank's, with those of the
/// whole that have their numbers: bit for bit the same, with all arrays. Counts how often each is seen.
/// Returns one sentence; empty if nothing differs.
std::string ComparePoints(vtkPolyData* part, vtkDataArray* numbers, vtkPolyData* given,
  vtkPolyData* whole, std::vector<int>& seen);

/// Compares what all ranks have with rank 0's `whole`, which others leave null: the same points under
/// the same numbers, and the same triangles and lines, each of them once.
/// Returns, on rank 0, one sentence; empty if nothing differs.
std::string CompareWithWhole(
  vtkMultiProcessController* controller, vtkPolyData* part, vtkPolyData* whole);

/// Begins MPI, and sums up over all ranks how often the test failed. Returns the program's exit code.
int RunRanks(int argc, char* argv[], const std::function<int(vtkMPIController*)>& test);

#endif

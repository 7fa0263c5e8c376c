// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef RankOutput_h
#define RankOutput_h

#include "vtkSmartPointer.h"

class vtkMultiProcessController;
class vtkPolyData;

/// On rank 0 the surface of all ranks, its points and triangles in the order of "GlobalPointIds" and
/// "GlobalCellIds", without these arrays; null elsewhere.
vtkSmartPointer<vtkPolyData> MergeOnFirst(vtkMultiProcessController* controller, vtkPolyData* part);

#endif

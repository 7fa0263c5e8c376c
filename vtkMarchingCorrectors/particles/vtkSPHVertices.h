// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: particles among the cells of a mesh.
 */
#ifndef vtkSPHVertices_h
#define vtkSPHVertices_h

#include "vtkMarchingCorrectorsModule.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;

/**
 * Where a data set has vertex cells and other cells, the points of the vertices, as poly data: other points are nodes
 * of a mesh. Arrays of the cells go to the points of the vertices, unless the points have an array of that name; also
 * where there are vertices alone, one for each point. Else the data set itself.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkPointSet> vtkSPHTakeVertices(vtkPointSet* data);
VTK_ABI_NAMESPACE_END

#endif

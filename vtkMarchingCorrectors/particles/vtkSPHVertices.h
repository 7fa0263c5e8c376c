// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the project: particles among the cells of a mesh. */
#ifndef vtkSPHVertices_h
#define vtkSPHVertices_h

#include "vtkMarchingCorrectorsModule.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkDataObject;

/** Whether there are vertices among the cells of the data set, or of one of its blocks. */
VTKMARCHINGCORRECTORS_EXPORT bool vtkSPHHaveVertices(vtkDataObject* data);

/**
 * The particles of a data set, or of each of its blocks. Where there are vertices, here or
 * elsewhere, points that no vertex uses are nodes of a mesh, if there are other cells. Arrays of
 * the cells go to the points of the vertices, unless the points have an array of that name; also
 * where there are vertices alone, one for each point. The class stays, and cells are vertices. The
 * data set itself where that changes nothing.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkDataObject> vtkSPHTakeVertices(
  vtkDataObject* data, bool haveVertices);
VTK_ABI_NAMESPACE_END

#endif

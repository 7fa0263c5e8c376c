// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the points of a slice and of a line through a box, and cutting a slice
 * down to the fluid.
 */
#ifndef vtkSPHShapes_h
#define vtkSPHShapes_h

#include "vtkType.h" // for VTK_ABI_NAMESPACE_BEGIN

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

/**
 * Makes a rectangle of quads in a plane, around its part in the box (x0, x1, y0, y1, z0, z1),
 * with `resolution` points along the longer side. Empty if the plane misses the box.
 */
void vtkSPHMakeSlice(const double box[6], const double origin[3], const double normal[3],
  int resolution, vtkPolyData* slice);

/** Makes a line of so many points; arc_length is their distance from the first one. */
void vtkSPHMakeLine(const double from[3], const double to[3], int resolution, vtkPolyData* line);

/** Removes the quads that have a corner where the point array of this name is 0. */
void vtkSPHCropSlice(vtkPolyData* slice, const char* mask);
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the points of a slice and a line through a box, and what is left of a slice in the fluid.
 */
#ifndef vtkSPHShapes_h
#define vtkSPHShapes_h

#include "vtkType.h" // For VTK_ABI_NAMESPACE_BEGIN

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

/**
 * Makes quads of a rectangle of the plane, around its part in the box (x0, x1, y0, y1, z0, z1), with
 * `resolution` points along the longer side. Empty where the plane misses the box.
 */
void vtkSPHMakeSlice(const double box[6], const double origin[3], const double normal[3],
  int resolution, vtkPolyData* slice);

/** A line of so many points, with their distance from the first one as arc_length. */
void vtkSPHMakeLine(const double from[3], const double to[3], int resolution, vtkPolyData* line);

/** Takes away the quads that have a corner where the point array of this name is 0. */
void vtkSPHCropSlice(vtkPolyData* slice, const char* mask);
VTK_ABI_NAMESPACE_END

#endif

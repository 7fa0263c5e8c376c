// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: area and volume of a whole surface.
 */
#ifndef vtkSPHMeasures_h
#define vtkSPHMeasures_h

struct mcor_surface;
class vtkFieldData;

/**
 * "Area", and of a closed surface "Volume", that of what it encloses, without cavities. Of the surface
 * before its arrays are taken over.
 */
void vtkSPHAddMeasures(vtkFieldData* run, const mcor_surface& surface);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SurfacePicture_h
#define SurfacePicture_h

#include <string>

class MessageCapture;
class vtkPointSet;
class vtkPolyData;

/// Renders the surface inside the outline of the particles and writes it as PNG. Throws
/// std::runtime_error with one sentence, also where this VTK renders through an X server and there
/// is none: VTK itself would abort.
void WritePicture(
  const std::string& file, vtkPolyData* surface, vtkPointSet* particles, MessageCapture* messages);

#endif

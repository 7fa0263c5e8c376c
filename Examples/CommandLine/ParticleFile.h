// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleFile_h
#define ParticleFile_h

#include "vtkSmartPointer.h"

#include <string>

class MessageCapture;
class vtkPointSet;
class vtkPolyData;

/// Reads a .vtp, .vtu or legacy .vtk file. Throws std::runtime_error with one sentence if it cannot
/// be read, is damaged, or holds no points.
vtkSmartPointer<vtkPointSet> ReadParticles(const std::string& file, MessageCapture* messages);

/// Throws std::runtime_error with one sentence where a file of this name could not be written: said
/// before the work is done rather than after it.
void CheckWritable(const std::string& file);

/// Writes a .vtp file, completely or not at all. Throws std::runtime_error with one sentence.
void WriteSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages);

/// Writes a text file, completely or not at all. Throws std::runtime_error with one sentence.
void WriteText(const std::string& file, const std::string& text);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SurfaceFile_h
#define SurfaceFile_h

#include <string>

class MessageCapture;
class vtkPolyData;

/// Whether the ending of the name is that of a format which WriteSurface knows.
bool IsSurfaceFile(const std::string& file);

/// ".vtp": the endings of these formats, for sentences and the help.
std::string SurfaceFileEndings();

/// Writes a surface, completely or not at all. Throws std::runtime_error with one sentence.
void WriteSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages);

#endif

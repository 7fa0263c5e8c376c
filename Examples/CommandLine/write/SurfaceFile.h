// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef SurfaceFile_h
#define SurfaceFile_h

#include <string>

class MessageCapture;
class vtkPolyData;

/// Whether the ending of the name is that of a format which WriteSurface knows.
bool IsSurfaceFile(const std::string& file);

/// ".vtp, .stl, ... or .obj": the endings of these formats, for sentences and the help.
std::string SurfaceFileEndings();

/// Writes a surface in the format of its ending, completely or not at all. .stl, .ply and .obj have
/// triangles and normals, and no other arrays. Throws std::runtime_error with one sentence.
void WriteSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages);

/// The same for a step of a film, always as .vtp. It bears a mark.
void WriteFilmSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages);

/// Whether it has this mark, so that another film may replace it.
bool IsFilmSurface(const std::string& file);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef DataFile_h
#define DataFile_h

#include "vtkType.h"

#include <string>
#include <vector>

class ColorScale;
class vtkAbstractArray;
class vtkDataSet;
class vtkPolyData;
class vtkTable;

/// Throws std::runtime_error with one sentence if no format with this ending holds data sets of this
/// class.
void CheckDataSetFile(const std::string& file, vtkDataSet* data);

/// Returns the bytes of a data set in the format of the file's ending. Throws std::runtime_error.
std::string DataSetBytes(const std::string& file, vtkDataSet* data);

/// Writes a data set, completely or not at all. Throws std::runtime_error with one sentence.
void WriteDataSet(const std::string& file, vtkDataSet* data);

/// Whether SurfaceBytes() knows a format with the ending of this name.
bool IsSurfaceFile(const std::string& file);

/// Returns the endings of the formats that SurfaceBytes() knows, ".vtp, .stl, ... or .csv", for
/// sentences and the help.
std::string SurfaceFileEndings();

/// Returns the bytes of a surface in the format of the file's ending. .stl and .obj have triangles
/// and normals, .obj also lines; .ply has colours and all arrays of numbers; .csv has the points of
/// lines with all arrays. Throws std::runtime_error with one sentence.
std::string SurfaceBytes(const std::string& file, vtkPolyData* surface, const ColorScale& colors);

/// Adds a mark to the bytes of an XML file. The mark says that the file is a step of a film, so that
/// another film may replace the file.
std::string MarkedStep(std::string bytes);

/// Whether the file has the mark of MarkedStep().
bool IsFilmStep(const std::string& file);

/// Returns whether files in this format hold arrays of any name.
bool HoldsArrays(const std::string& file);

/// Returns a sentence about the arrays that a file in this format cannot hold; empty if it can hold
/// all. more: names of arrays that were not interpolated to the surface, because of this format.
std::string LostArrays(
  const std::string& file, vtkPolyData* surface, const std::vector<std::string>& more);

/// Returns the name of a piece: OUT_3.vtp beside OUT.pvtp.
std::string PieceName(const std::string& file, int rank);

/// Returns the text of the .pvtp file, which lists one piece per process; `piece` is one of the pieces, which have the same arrays.
std::string ListPieces(const std::string& file, int count, vtkPolyData* piece);

/// Returns a text as a field of CSV (RFC 4180) that no spreadsheet takes as a formula.
std::string TableField(const std::string& text);

/// Returns a value as text from which it is read back exactly; NaN is an empty field.
std::string TableField(vtkAbstractArray* array, vtkIdType tuple, int component = 0);

/// Appends a line for each row. If the text is empty, first appends a line with the columns' names.
void AppendTable(std::string& text, vtkTable* table);

#endif

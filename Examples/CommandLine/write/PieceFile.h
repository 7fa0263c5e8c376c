// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef PieceFile_h
#define PieceFile_h

#include <string>

class vtkPolyData;

/// Whether this is a .pvtp file, which lists one piece per process.
bool IsInPieces(const std::string& file);

/// OUT_3.vtp beside OUT.pvtp.
std::string PieceName(const std::string& file, int rank);

/// The text of the .pvtp file; `piece` is one of the pieces, which have the same arrays.
std::string ListPieces(const std::string& file, int count, vtkPolyData* piece);

#endif

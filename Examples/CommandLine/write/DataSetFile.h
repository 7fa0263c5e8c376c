// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef DataSetFile_h
#define DataSetFile_h

#include <string>

class MessageCapture;
class vtkDataSet;

/// Throws std::runtime_error with one sentence if the ending of the name is not that of a format
/// which holds data sets of this class.
void CheckDataSetFile(const std::string& file, vtkDataSet* data);

/// The bytes of a data set in the format of the file's ending. Throws std::runtime_error.
std::string DataSetBytes(const std::string& file, vtkDataSet* data, MessageCapture* messages);

/// Writes a data set, completely or not at all. Throws std::runtime_error with one sentence.
void WriteDataSet(const std::string& file, vtkDataSet* data, MessageCapture* messages);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"

#include "Failures.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkGenericDataObjectWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkSPHArrays.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"
#include "vtkXMLDataObjectWriter.h"

#include <cmath>
#include <functional>
#include <initializer_list>
#include <vector>

namespace
{

using Work = std::function<void()>;

/// VTK's writers put names into XML as they are. Gives arrays and their components names that are fit
/// for XML, and returns functions that restore the former names.
std::vector<Work> FitNamesForXml(vtkDataSet* data)
{
  std::vector<Work> undo;
  const auto fit = [&undo](const char* name, const std::function<void(const char*)>& set)
  {
    const std::string before = name ? name : "", fitting = EscapedForXml(before);
    if (fitting != before)
    {
      set(fitting.c_str());
      undo.emplace_back([before, set] { set(before.c_str()); });
    }
  };
  for (vtkFieldData* arrays : std::initializer_list<vtkFieldData*>{
         data->GetPointData(), data->GetCellData(), data->GetFieldData() })
  {
    for (vtkAbstractArray* array : vtkSPHListArrays(arrays))
    {
      array->SetName(array->GetName() ? array->GetName() : ""); // VTK would write an address
      fit(array->GetName(), [array](const char* name) { array->SetName(name); });
      for (int c = 0; array->HasAComponentName() && c < array->GetNumberOfComponents(); ++c)
      {
        fit(array->GetComponentName(c),
          [array, c](const char* name) { array->SetComponentName(c, name); });
      }
    }
  }
  return undo;
}

/// The formats that are written, each with the class of the data sets that it holds. Each format also
/// holds derived classes.
const std::vector<FileFormat<const char*>> Formats = { { ".vti", "vtkImageData" },
  { ".vtr", "vtkRectilinearGrid" }, { ".vts", "vtkStructuredGrid" }, { ".vtp", "vtkPolyData" },
  { ".vtu", "vtkUnstructuredGrid" }, { ".vtk", "vtkDataSet" } };

}

void CheckDataSetFile(const std::string& file, vtkDataSet* data)
{
  bool isGood = false;
  std::vector<std::string> endings;
  for (const auto& [ending, className] : Formats)
  {
    endings.insert(endings.end(), data->IsA(className) ? 1 : 0, ending);
    isGood = isGood || (data->IsA(className) && EndsWith(file, ending));
  }
  Require(isGood,
    "the output is the data set of the points, a " + std::string(data->GetClassName()) +
      ", for a " + Joined(endings, " or ") + " file, not '" + file + "'");
}

std::string DataSetBytes(const std::string& file, vtkDataSet* data)
{
  const Activity writing(file + " could not be written", "memory may have run out");
  Messages() = {};
  std::string bytes; // in memory, because the writer of VTK 9.1 crashes on a full disk
  bool isGood = false;
  if (EndsWith(file, ".vtk"))
  {
    vtkNew<vtkGenericDataObjectWriter> writer;
    writer->SetInputData(data);
    writer->SetFileTypeToBinary();
    writer->WriteToOutputStringOn();
    isGood = writer->Write() != 0;
    bytes = writer->GetOutputStdString();
  }
  else
  {
    const std::vector<Work> undo = FitNamesForXml(data);
    const auto writer =
      vtk::TakeSmartPointer(vtkXMLDataObjectWriter::NewWriter(data->GetDataObjectType()));
    writer->SetInputDataObject(data);
    writer->SetDataModeToBinary(); // ParaView 5.11 of Debian 12 cannot read appended data
    writer->WriteToOutputStringOn();
    writer->SetCompressorTypeToLZ4(); // takes a third of the time of zlib, VTK's default
    writer->SetBlockSize(1 << 19);
    isGood = writer->Write() != 0;
    bytes = writer->GetOutputString();
    for (const Work& each : undo)
    {
      each();
    }
  }
  RequireToWrite(isGood && Messages().Errors.empty(), file, Messages().FirstError());
  return bytes;
}

void WriteDataSet(const std::string& file, vtkDataSet* data)
{
  WriteOutput(file, DataSetBytes(file, data));
}

std::string TableField(const std::string& text)
{
  const bool isFormula = !text.empty() && std::string("=+-@").find(text[0]) != std::string::npos;
  const std::string plain = (isFormula ? "'" : "") + text;
  return plain.find_first_of(",\"\n\r") == std::string::npos
    ? plain
    : '"' + Joined(ItemsOf(plain, '"'), "\"\"") + '"';
}

std::string TableField(vtkAbstractArray* array, vtkIdType tuple, int component)
{
  if (auto* texts = vtkStringArray::SafeDownCast(array))
  {
    return TableField(texts->GetValue(tuple));
  }
  auto* numbers = vtkDataArray::SafeDownCast(array);
  if (array->GetDataTypeSize() == 8 && array->GetDataType() != VTK_DOUBLE) // exact beyond 2^53
  {
    const vtkVariant value =
      array->GetVariantValue(tuple * array->GetNumberOfComponents() + component);
    return numbers->GetDataTypeMin() < 0.0 ? DigitsOf(value.ToLongLong())
                                           : DigitsOf(value.ToUnsignedLongLong());
  }
  const double number = numbers->GetComponent(tuple, component) + 0.0; // no -0
  return std::isnan(number) ? "" : DigitsOf(number);
}

void AppendTable(std::string& text, vtkTable* table)
{
  const vtkIdType header = -1;
  for (vtkIdType row = text.empty() ? header : 0; row < table->GetNumberOfRows(); ++row)
  {
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
    {
      text += (c ? "," : "") +
        (row == header ? TableField(table->GetColumnName(c))
                       : TableField(table->GetColumn(c), row));
    }
    text += "\n";
  }
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataSetFile.h"

#include "Ending.h"
#include "FileFormat.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "SafeText.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkGenericDataObjectWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkXMLImageDataWriter.h"
#include "vtkXMLPolyDataWriter.h"
#include "vtkXMLRectilinearGridWriter.h"
#include "vtkXMLStructuredGridWriter.h"
#include "vtkXMLUnstructuredGridWriter.h"

#include <functional>
#include <stdexcept>
#include <vector>

namespace
{

/// VTK's writers put names into XML as they are.
void EscapeNames(vtkFieldData* arrays)
{
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    array->SetName(EscapedForXml(array->GetName() ? array->GetName() : "").c_str());
  }
}

/// In memory and not appended: see SurfaceFile.cxx.
template <typename WriterT>
bool WriteXml(vtkDataSet* data, std::string& bytes)
{
  vtkNew<WriterT> writer;
  EscapeNames(data->GetPointData());
  EscapeNames(data->GetCellData());
  writer->SetInputData(data);
  writer->SetDataModeToBinary();
  writer->WriteToOutputStringOn();
  const bool good = writer->Write() != 0;
  bytes = writer->GetOutputString();
  return good;
}

bool WriteLegacy(vtkDataSet* data, std::string& bytes)
{
  vtkNew<vtkGenericDataObjectWriter> writer;
  writer->SetInputData(data);
  writer->SetFileTypeToBinary();
  writer->WriteToOutputStringOn();
  const bool good = writer->Write() != 0;
  bytes = writer->GetOutputStdString();
  return good;
}

struct Writer
{
  const char* ClassName; ///< and those derived from it
  bool (*Write)(vtkDataSet*, std::string& bytes);
};

/// Every format that is written; all that is known of one stands here.
const std::vector<FileFormat<Writer>> Formats = {
  { ".vti", { "vtkImageData", WriteXml<vtkXMLImageDataWriter> } },
  { ".vtr", { "vtkRectilinearGrid", WriteXml<vtkXMLRectilinearGridWriter> } },
  { ".vts", { "vtkStructuredGrid", WriteXml<vtkXMLStructuredGridWriter> } },
  { ".vtp", { "vtkPolyData", WriteXml<vtkXMLPolyDataWriter> } },
  { ".vtu", { "vtkUnstructuredGrid", WriteXml<vtkXMLUnstructuredGridWriter> } },
  { ".vtk", { "vtkDataSet", WriteLegacy } },
};

}

void CheckDataSetFile(const std::string& file, vtkDataSet* data)
{
  const FileFormat<Writer>* format = FindFormat(Formats, file);
  if (format && data->IsA(format->Process.ClassName))
  {
    return;
  }
  std::string endings;
  for (const FileFormat<Writer>& other : Formats)
  {
    if (data->IsA(other.Process.ClassName))
    {
      endings += (endings.empty() ? "" : " or ") + std::string(other.Ending);
    }
  }
  throw std::runtime_error("the output is the data set of the points, a " +
    std::string(data->GetClassName()) + ", for a " + endings + " file, not '" + file + "'");
}

void WriteDataSet(const std::string& file, vtkDataSet* data, MessageCapture* messages)
{
  const Activity writing(file + " could not be written", "memory may have run out");
  messages->Clear();
  std::string bytes;
  if (!FindFormat(Formats, file)->Process.Write(data, bytes) || !messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " could not be written" +
      (messages->GetErrors().empty() ? "" : ": " + messages->GetErrors().front()));
  }
  WriteOutput(file, bytes);
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"

#include "Ending.h"
#include "FileName.h"
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
#include <initializer_list>
#include <stdexcept>
#include <vector>

namespace
{

/// VTK's writers put names into XML as they are: arrays and their components have names fit for it,
/// as long as this lives.
class NamesForXml
{
public:
  explicit NamesForXml(vtkDataSet* data)
  {
    for (vtkFieldData* arrays : std::initializer_list<vtkFieldData*>{
           data->GetPointData(), data->GetCellData(), data->GetFieldData() })
    {
      for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
      {
        this->Escape(arrays->GetAbstractArray(i));
      }
    }
  }

  ~NamesForXml()
  {
    for (const Name& name : this->Names)
    {
      name.Set(name.Before);
    }
  }

  NamesForXml(const NamesForXml&) = delete;
  void operator=(const NamesForXml&) = delete;

private:
  struct Name
  {
    std::string Before;
    std::function<void(const std::string&)> Set;
  };

  void Escape(vtkAbstractArray* array)
  {
    if (!array->GetName())
    {
      array->SetName(""); // where VTK would make one of an address
    }
    this->Replace(
      array->GetName(), [array](const std::string& name) { array->SetName(name.c_str()); });
    for (int c = 0; array->HasAComponentName() && c < array->GetNumberOfComponents(); ++c)
    {
      this->Replace(array->GetComponentName(c),
        [array, c](const std::string& name) { array->SetComponentName(c, name.c_str()); });
    }
  }

  void Replace(const char* name, const std::function<void(const std::string&)>& set)
  {
    const std::string before = name ? name : "", fit = EscapedForXml(before);
    if (fit != before)
    {
      set(fit);
      this->Names.push_back({ before, set });
    }
  }

  std::vector<Name> Names;
};

/// Writes to memory, because the writer of VTK 9.1 crashes on a full disk. Does not append data,
/// VTK's default, which ParaView 5.11 of Debian 12 cannot read. Returns false if VTK gave up.
template <typename WriterT>
bool WriteXml(vtkDataSet* data, std::string& bytes)
{
  const NamesForXml names(data);
  vtkNew<WriterT> writer;
  writer->SetInputData(data);
  writer->SetDataModeToBinary();
  writer->WriteToOutputStringOn();
  writer->SetCompressorTypeToLZ4(); // which takes a third of the time of zlib, VTK's default
  writer->SetBlockSize(1 << 19);
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

/// Every format that is written, with all that is known of it.
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

std::string DataSetBytes(const std::string& file, vtkDataSet* data, MessageCapture* messages)
{
  const Activity writing(file + " could not be written", "memory may have run out");
  messages->Clear();
  std::string bytes;
  if (!FindFormat(Formats, file)->Process.Write(data, bytes) || !messages->GetErrors().empty())
  {
    FailToWrite(file, messages->GetErrors().empty() ? "" : messages->GetErrors().front());
  }
  return bytes;
}

void WriteDataSet(const std::string& file, vtkDataSet* data, MessageCapture* messages)
{
  WriteOutput(file, DataSetBytes(file, data, messages));
}

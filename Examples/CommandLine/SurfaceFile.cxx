// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceFile.h"

#include "FileFormat.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "Supervisor.h"

#include "vtkAbstractArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataWriter.h"

#include <functional>
#include <stdexcept>
#include <vector>

namespace
{

std::string EscapedForXml(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '"' ? "&quot;" : c == '&' ? "&amp;" : c == '<' ? "&lt;" : std::string(1, c);
  }
  return escaped;
}

/// Gives the point arrays other names; attributes stay what they are.
void ReplaceNames(
  vtkPolyData* surface, const std::function<std::string(const std::string&)>& replace)
{
  vtkPointData* arrays = surface->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    array->SetName(replace(array->GetName() ? array->GetName() : "").c_str());
  }
}

/// In memory: on a full disk the writer of VTK 9.1 crashes.
bool WriteXml(vtkPolyData* surface, std::string& bytes)
{
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(surface);
  // Not appended, VTK's default: ParaView 5.11 as Debian 12 has it cannot read that.
  writer->SetDataModeToBinary();
  writer->WriteToOutputStringOn();
  // VTK's writer puts names into XML as they are.
  std::vector<std::string> names;
  ReplaceNames(surface,
    [&](const std::string& name)
    {
      names.push_back(name);
      return EscapedForXml(name);
    });
  const bool good = writer->Write() != 0;
  std::size_t next = 0;
  ReplaceNames(surface, [&](const std::string&) { return names[next++]; });
  bytes = writer->GetOutputString();
  return good;
}

/// Every format that is written; all that is known of one stands here.
using Writer = std::function<bool(vtkPolyData*, std::string& bytes)>;
const std::vector<FileFormat<Writer>> Formats = { { ".vtp", WriteXml } };

}

//------------------------------------------------------------------------------
bool IsSurfaceFile(const std::string& file)
{
  return FindFormat(Formats, file) != nullptr;
}

//------------------------------------------------------------------------------
std::string SurfaceFileEndings()
{
  return ListEndings(Formats);
}

//------------------------------------------------------------------------------
void WriteSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages)
{
  const Activity writing(file + " could not be written", "memory may have run out");
  messages->Clear();
  std::string bytes;
  if (!FindFormat(Formats, file)->Process(surface, bytes) || !messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " could not be written" +
      (messages->GetErrors().empty() ? "" : ": " + messages->GetErrors().front()));
  }
  WriteOutput(file, bytes);
}

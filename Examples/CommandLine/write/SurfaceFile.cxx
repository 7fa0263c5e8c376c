// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceFile.h"

#include "FileFormat.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "SafeText.h"
#include "ScratchFile.h"
#include "Supervisor.h"

#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkOBJWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSTLWriter.h"
#include "vtkXMLPolyDataWriter.h"

#include <cstdint>
#include <fstream>
#include <functional>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace
{

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
  // VTK's default takes three times as long, which is most of a small run, for no smaller file.
  writer->SetCompressionLevel(1);
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

/// For writers that know files alone.
template <typename WriterT>
bool WriteByFile(WriterT* writer, vtkPolyData* surface, std::string& bytes)
{
  const ScratchFile file;
  writer->SetInputData(surface);
  writer->SetFileName(file.GetName().c_str());
  const bool good = writer->Write() != 0;
  bytes = file.Read();
  return good;
}

/// Triangles with normals of their own.
bool WriteStl(vtkPolyData* surface, std::string& bytes)
{
  vtkNew<vtkSTLWriter> writer;
  writer->SetFileTypeToBinary();
  return WriteByFile(writer.Get(), surface, bytes);
}

bool WriteObj(vtkPolyData* surface, std::string& bytes)
{
  vtkNew<vtkOBJWriter> writer;
  return WriteByFile(writer.Get(), surface, bytes);
}

template <typename T>
void Append(std::string& bytes, T value)
{
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Not by VTK's writer, which leaves the normals out.
bool WritePly(vtkPolyData* surface, std::string& bytes)
{
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  const std::uint16_t one = 1;
  const bool isLittle = *reinterpret_cast<const unsigned char*>(&one) == 1;
  std::ostringstream head;
  head << "ply\nformat binary_" << (isLittle ? "little" : "big")
       << "_endian 1.0\ncomment by marching-correctors\nelement vertex "
       << surface->GetNumberOfPoints();
  for (const char* name : { "x", "y", "z", "nx", "ny", "nz" })
  {
    head << (normals || name[0] != 'n' ? std::string("\nproperty float ") + name : "");
  }
  head << "\nelement face " << surface->GetNumberOfPolys()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes = head.str();
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      Append(bytes, static_cast<float>(surface->GetPoint(i)[c]));
    }
    for (int c = 0; normals && c < 3; ++c)
    {
      Append(bytes, static_cast<float>(normals->GetComponent(i, c)));
    }
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < surface->GetNumberOfPolys(); ++i)
  {
    surface->GetPolys()->GetCellAtId(i, corners);
    Append(bytes, static_cast<std::uint8_t>(3));
    for (vtkIdType k = 0; k < 3; ++k)
    {
      Append(bytes, static_cast<std::int32_t>(corners->GetId(k)));
    }
  }
  return true;
}

/// Every format that is written; all that is known of one stands here.
using Writer = std::function<bool(vtkPolyData*, std::string& bytes)>;
const std::vector<FileFormat<Writer>> Formats = { { ".vtp", WriteXml }, { ".stl", WriteStl },
  { ".ply", WritePly }, { ".obj", WriteObj } };

const char* const FilmMark = "<!-- a step of a film by marching-correctors -->";

/// The bytes of the file. Throws std::runtime_error with one sentence.
std::string BytesOf(const std::string& file, vtkPolyData* surface, MessageCapture* messages)
{
  messages->Clear();
  std::string bytes;
  if (!FindFormat(Formats, file)->Process(surface, bytes) || !messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " could not be written" +
      (messages->GetErrors().empty() ? "" : ": " + messages->GetErrors().front()));
  }
  return bytes;
}

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
  WriteOutput(file, BytesOf(file, surface, messages));
}

//------------------------------------------------------------------------------
void WriteFilmSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages)
{
  const Activity writing(file + " could not be written", "memory may have run out");
  std::string bytes = BytesOf(file, surface, messages);
  bytes.insert(bytes.find("?>") + 2, std::string("\n") + FilmMark);
  WriteOutput(file, bytes);
}

//------------------------------------------------------------------------------
bool IsFilmSurface(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  std::string head(256, '\0');
  stream.read(&head[0], static_cast<std::streamsize>(head.size()));
  return head.find(FilmMark) != std::string::npos;
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "MessageCapture.h"

#include "vtkDataObject.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLPolyDataWriter.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#if defined(__unix__)
#include <dlfcn.h>
#endif

namespace
{

namespace fs = std::filesystem;

/// Damage that VTK's readers pass over in silence: an appended data section that ends too early is
/// read as far as it goes, and the rest of the arrays keeps whatever memory held.
bool EndsLikeXmlFile(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  std::string tail(256, '\0');
  stream.seekg(0, std::ios::end);
  const std::streamoff size = stream.tellg();
  const std::streamoff start = size > 256 ? size - 256 : 0;
  stream.seekg(start);
  stream.read(&tail[0], size - start);
  tail.resize(static_cast<std::size_t>(stream.gcount()));
  return tail.find("</VTKFile>") != std::string::npos;
}

/// Expat puts off the parsing of what may be an incomplete token, since 2.6 and in the security
/// updates of older ones. VTK's parser, where it does not know this yet (ParaView 5.11 of Debian
/// 12), then overlooks the place where XML ends and appended data begin, and cannot read such
/// files.
class PromptParser : public vtkXMLDataParser
{
public:
  static PromptParser* New();
  vtkTypeMacro(PromptParser, vtkXMLDataParser);

protected:
  int CreateParser() override
  {
    const int result = this->Superclass::CreateParser();
#if defined(__unix__)
    using SwitchType = unsigned char (*)(void*, unsigned char);
    const auto setDeferral =
      reinterpret_cast<SwitchType>(dlsym(RTLD_DEFAULT, "XML_SetReparseDeferralEnabled"));
    if (result && setDeferral)
    {
      setDeferral(this->Parser, 0);
    }
#endif
    return result;
  }
};
vtkStandardNewMacro(PromptParser);

template <typename ReaderT>
class PromptReader : public ReaderT
{
public:
  static PromptReader* New() { VTK_STANDARD_NEW_BODY(PromptReader); }

protected:
  void CreateXMLParser() override
  {
    if (this->XMLParser)
    {
      this->XMLParser->Delete();
    }
    this->XMLParser = PromptParser::New();
  }
};

vtkSmartPointer<vtkDataObject> ReadXml(vtkXMLReader* reader, const std::string& file)
{
  if (!EndsLikeXmlFile(file))
  {
    throw std::runtime_error(file + " is not a complete VTK XML file: its end is missing");
  }
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutputDataObject(0);
}

vtkSmartPointer<vtkDataObject> ReadLegacy(const std::string& file)
{
  vtkNew<vtkGenericDataObjectReader> reader;
  reader->SetFileName(file.c_str());
  // By default only the first array of each kind is read.
  reader->ReadAllScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllFieldsOn();
  reader->Update();
  return reader->GetOutput();
}

vtkSmartPointer<vtkDataObject> ReadAny(const std::string& file)
{
  const std::string extension = fs::path(file).extension().string();
  if (extension == ".vtp")
  {
    vtkNew<PromptReader<vtkXMLPolyDataReader>> reader;
    return ReadXml(reader, file);
  }
  if (extension == ".vtu")
  {
    vtkNew<PromptReader<vtkXMLUnstructuredGridReader>> reader;
    return ReadXml(reader, file);
  }
  if (extension == ".vtk")
  {
    return ReadLegacy(file);
  }
  throw std::runtime_error(file + " is not a .vtp, .vtu or .vtk file");
}

}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPointSet> ReadParticles(const std::string& file, MessageCapture* messages)
{
  std::error_code error;
  if (fs::is_directory(file, error))
  {
    throw std::runtime_error(file + " cannot be read: it is a directory");
  }
  if (!std::ifstream(file, std::ios::binary))
  {
    throw std::runtime_error(file + " cannot be read: " + std::strerror(errno));
  }
  messages->Clear();
  vtkSmartPointer<vtkDataObject> data = ReadAny(file);
  // VTK goes on after errors, with arrays of zeros; such data would give a wrong surface.
  if (!messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " cannot be read: " + messages->GetErrors().front());
  }
  vtkPointSet* points = vtkPointSet::SafeDownCast(data);
  if (!points)
  {
    throw std::runtime_error(file + " holds " +
      (data ? std::string("a ") + data->GetClassName() : std::string("no VTK data")) +
      ", not particles (poly data or an unstructured grid)");
  }
  if (points->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error(file + " holds no points");
  }
  if (vtkPolyData* polyData = vtkPolyData::SafeDownCast(points))
  {
    polyData->SetVerts(nullptr); // one per particle, for nothing
  }
  return points;
}

//------------------------------------------------------------------------------
void CheckWritable(const std::string& file)
{
  std::error_code error;
  if (fs::is_directory(file, error))
  {
    throw std::runtime_error(file + " could not be written: it is a directory");
  }
  // The same name as in WriteText: no other file is touched, and none is left.
  const std::string part = file + ".part";
  if (!std::ofstream(part, std::ios::binary))
  {
    throw std::runtime_error(file + " could not be written: " + std::strerror(errno));
  }
  std::remove(part.c_str());
}

//------------------------------------------------------------------------------
void WriteSurface(const std::string& file, vtkPolyData* surface, MessageCapture* messages)
{
  messages->Clear();
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(surface);
  // Not appended, VTK's default: ParaView 5.11 as Debian 12 has it cannot read that.
  writer->SetDataModeToBinary();
  // Not straight to the file: on a full disk the writer of VTK 9.1 crashes.
  writer->WriteToOutputStringOn();
  if (!writer->Write() || !messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " could not be written" +
      (messages->GetErrors().empty() ? "" : ": " + messages->GetErrors().front()));
  }
  WriteText(file, writer->GetOutputString());
}

//------------------------------------------------------------------------------
void WriteText(const std::string& file, const std::string& text)
{
  // Under another name first: no half-written file is ever seen under the one asked for.
  const std::string part = file + ".part";
  std::ofstream stream(part, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream || std::rename(part.c_str(), file.c_str()) != 0)
  {
    const std::string why = std::strerror(errno);
    std::remove(part.c_str());
    throw std::runtime_error(file + " could not be written: " + why);
  }
}

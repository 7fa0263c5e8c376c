// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "CollectionFile.h"
#include "Ending.h"
#include "Extra.h"
#include "FileName.h"
#include "Formats.h"
#include "MessageCapture.h"
#include "SafeText.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataObject.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHVertices.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLRectilinearGridReader.h"
#include "vtkXMLStructuredGridReader.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <new>
#include <stdexcept>
#include <vector>

#include <dlfcn.h>

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
    using SwitchType = unsigned char (*)(void*, unsigned char);
    const auto setDeferral =
      reinterpret_cast<SwitchType>(dlsym(RTLD_DEFAULT, "XML_SetReparseDeferralEnabled"));
    if (result && setDeferral)
    {
      setDeferral(this->Parser, 0);
    }
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

vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t step)
{
  return LoadExtra().ReadHdf(file, step);
}

vtkSmartPointer<vtkDataObject> ReadSurface(const std::string& file)
{
  return LoadExtra().ReadSurface(file);
}

template <typename ReaderT>
vtkSmartPointer<vtkDataObject> ReadXmlWith(const std::string& file)
{
  vtkNew<PromptReader<ReaderT>> reader;
  return ReadXml(reader, file);
}

/// Every format that is read, with all that is known of it. A format without a function is a list
/// of files that hold parts of the particles.
using Reader =
  std::function<vtkSmartPointer<vtkDataObject>(const std::string& file, std::size_t step)>;

/// A reader of files that hold one step.
template <vtkSmartPointer<vtkDataObject> (*read)(const std::string&)>
vtkSmartPointer<vtkDataObject> ReadOne(const std::string& file, std::size_t)
{
  return read(file);
}

const std::vector<FileFormat<Reader>> Formats = {
  { ".vtp", ReadOne<ReadXmlWith<vtkXMLPolyDataReader>> },
  { ".vtu", ReadOne<ReadXmlWith<vtkXMLUnstructuredGridReader>> },
  { ".pvtp", {} },
  { ".pvtu", {} },
  { ".vtkhdf", ReadHdf },
  { ".vtk", ReadOne<ReadLegacy> },
  { ".csv", ReadOne<ReadCsv> },
  { ".tsv", ReadOne<ReadCsv> },
  { ".txt", ReadColumns },
  { ".dat", ReadColumns },
  { ".xyz", ReadXyz },
  { ".extxyz", ReadXyz },
  { ".lammpstrj", ReadLammps },
  { ".dump", ReadLammps },
};

/// Formats of data sets of any class.
const std::vector<FileFormat<Reader>> DataFormats = {
  { ".vti", ReadOne<ReadXmlWith<vtkXMLImageDataReader>> },
  { ".vtr", ReadOne<ReadXmlWith<vtkXMLRectilinearGridReader>> },
  { ".vts", ReadOne<ReadXmlWith<vtkXMLStructuredGridReader>> },
  { ".vtp", ReadOne<ReadXmlWith<vtkXMLPolyDataReader>> },
  { ".vtu", ReadOne<ReadXmlWith<vtkXMLUnstructuredGridReader>> },
  { ".vtk", ReadOne<ReadLegacy> },
  { ".csv", ReadOne<ReadCsv> },
  { ".stl", ReadOne<ReadSurface> },
  { ".ply", ReadOne<ReadSurface> },
  { ".obj", ReadOne<ReadSurface> },
};

const FileFormat<Reader> Gadget = { "", ReadOne<ReadGadget> };

/// Finds a format by the ending, or, for particles, by the beginning of the file; nullptr if there
/// is none.
const FileFormat<Reader>* FormatOf(
  const std::vector<FileFormat<Reader>>& formats, const std::string& file)
{
  return &formats == &Formats && IsGadget(file) ? &Gadget : FindFormat(formats, file);
}

/// The greatest number of points or particles.
const vtkIdType MostPoints = VTK_INT_MAX;

/// VTK's readers seek in the file, so it must be a regular one.
void CheckReadable(
  const std::string& file, const std::vector<FileFormat<Reader>>& formats = Formats)
{
  std::error_code error;
  if (fs::is_directory(file, error))
  {
    FailToRead(file, "it is a directory");
  }
  if (fs::exists(file, error) && !fs::is_regular_file(file, error))
  {
    FailToRead(file, "it is not a regular file");
  }
  if (!std::ifstream(file, std::ios::binary))
  {
    FailToRead(file, std::strerror(errno));
  }
  if (!FormatOf(formats, file))
  {
    throw std::runtime_error(file + " is not a " + ListEndings(formats) + " file");
  }
}

/// VTK's reader at work. Its exceptions are those of the standard library where it asks for memory
/// by sizes that a damaged file gave it. After errors VTK goes on, with arrays of zeros; such data
/// would give a wrong surface.
vtkSmartPointer<vtkDataObject> ReadWithCare(const std::string& file, MessageCapture* messages,
  const std::vector<FileFormat<Reader>>& formats = Formats, std::size_t step = 0)
{
  CheckReadable(file, formats);
  messages->Clear();
  const Activity reading("the reader of VTK failed on " + file, "the file may be damaged");
  const Silence silence;
  CheckDeclaredSizes(file);
  try
  {
    const vtkSmartPointer<vtkDataObject> data = FormatOf(formats, file)->Process(file, step);
    if (!messages->GetErrors().empty())
    {
      FailToRead(file, messages->GetErrors().front());
    }
    return data;
  }
  catch (const std::bad_alloc&)
  {
  }
  catch (const std::length_error&)
  {
  }
  FailToRead(file, "it needs more memory than is available; it may be damaged");
}

/// Makes names fit for sentences and for the surface's file; a legacy file can hold bytes that
/// these cannot.
void MakePrintable(vtkAbstractArray* array)
{
  array->SetName(Printable(array->GetName() ? array->GetName() : "").c_str());
  for (int i = 0; array->HasAComponentName() && i < array->GetNumberOfComponents(); ++i)
  {
    if (const char* name = array->GetComponentName(i))
    {
      array->SetComponentName(i, Printable(name).c_str());
    }
  }
}

/// The arrays of one kind, of this many elements. Throws std::runtime_error.
void CheckArrays(const std::string& file, vtkFieldData* arrays, vtkIdType count, const char* kind)
{
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    MakePrintable(array);
    if (array->GetNumberOfTuples() != count)
    {
      FailToRead(file,
        std::string("its array '") + array->GetName() + "' has " +
          std::to_string(array->GetNumberOfTuples()) + " entries for " + std::to_string(count) +
          kind);
    }
  }
}

/// The points' arrays alone, all that is used of the data: no cells (one per particle, for
/// nothing), and nothing that was not checked.
vtkSmartPointer<vtkPointSet> TakeParticles(
  const std::string& file, vtkPointSet* all, bool haveVertices)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  CheckArrays(file, all->GetPointData(), all->GetNumberOfPoints(), " points");
  CheckArrays(file, all->GetCellData(), all->GetNumberOfCells(), " cells");
  const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(all, haveVertices);
  auto* data = vtkPointSet::SafeDownCast(taken);
  const vtkIdType others = all->GetNumberOfPoints() - data->GetNumberOfPoints();
  static bool isSaid = false; // of a film's steps once
  if (others > 0 && !isSaid)
  {
    isSaid = true;
    Say("note: " + std::to_string(others) + " of " + std::to_string(all->GetNumberOfPoints()) +
      " points of " + file + " are nodes of a mesh and no particles, as no vertex cell uses them");
  }
  particles->SetPoints(data->GetPoints());
  vtkPointData* arrays = data->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    particles->GetPointData()->AddArray(arrays->GetAbstractArray(i));
  }
  PassPeriod(data, particles);
  return particles;
}

vtkSmartPointer<vtkPointSet> NoParticles()
{
  auto none = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  none->SetPoints(points);
  return none;
}

/// NAME#N is step N of the file NAME, unless a file has that name.
void TakeStep(std::string& file, std::size_t& step)
{
  std::error_code error;
  const std::size_t at = file.rfind('#');
  const bool isNumber = at != std::string::npos && at + 1 < file.size() && file.size() - at < 12 &&
    file.find_first_not_of("0123456789", at + 1) == std::string::npos;
  if (isNumber && !fs::exists(file, error))
  {
    step = std::strtoull(file.c_str() + at + 1, nullptr, 10);
    file.resize(at);
  }
}

/// Adds what a file holds, unless it has no points. Throws std::runtime_error.
void ReadSet(std::string file, ParticleSets& sets, MessageCapture* messages)
{
  std::size_t step = 0;
  TakeStep(file, step);
  const vtkSmartPointer<vtkDataObject> data = ReadWithCare(file, messages, Formats, step);
  vtkPointSet* points = vtkPointSet::SafeDownCast(data);
  if (!points)
  {
    throw std::runtime_error(file + " holds " +
      (data ? std::string("a ") + data->GetClassName() : std::string("no VTK data")) +
      ", not particles (poly data or an unstructured grid)");
  }
  if (points->GetNumberOfPoints() > 0)
  {
    const bool haveVertices = vtkSPHHaveVertices(points);
    sets.HaveVertices = sets.HaveVertices || haveVertices;
    sets.Files.push_back(file);
    sets.Sets.emplace_back(points);
    if (haveVertices)
    {
      sets.Sets.back() = TakeParticles(file, points, true); // so much less to keep
    }
  }
}

bool IsList(const std::string& file)
{
  const auto* format = FindFormat(Formats, file);
  return format && !format->Process;
}

/// The pieces of a list of them, or the file itself.
std::vector<std::string> ListParts(const std::string& file, MessageCapture* messages)
{
  if (!IsList(file))
  {
    return IsGadget(file) ? ListGadget(file) : std::vector<std::string>{ file };
  }
  CheckReadable(file);
  const std::vector<std::string> parts = ReadPieces(file, messages);
  for (const std::string& part : parts)
  {
    if (IsList(part))
    {
      FailToRead(file, "its piece " + part + " is a list itself");
    }
  }
  return parts;
}

}

std::string ParticleFileEndings()
{
  return ListEndings(Formats);
}

vtkSmartPointer<vtkPointSet> ReadParticles(const std::string& file, MessageCapture* messages)
{
  return ReadParticles(std::vector<std::string>{ file }, messages);
}

vtkSmartPointer<vtkPointSet> ReadParticles(
  const std::vector<std::string>& files, MessageCapture* messages, bool mayBeEmpty)
{
  ParticleSets sets;
  for (const std::string& file : files)
  {
    for (const std::string& part : ListParts(file, messages))
    {
      ReadSet(part, sets, messages);
    }
  }
  if (sets.Sets.empty() && !mayBeEmpty)
  {
    throw std::runtime_error(files.front() + " holds no points");
  }
  sets.IsList = files.size() > 1 || IsList(files.front());
  return JoinSets(sets);
}

std::vector<double> ListTimes(const std::string& file)
{
  const auto ends = [&file](const char* ending) { return EndsWith(file, ending); };
  if (IsGadget(file))
  {
    return { TimeOfGadget(file) };
  }
  if (ends(".vtkhdf"))
  {
    const Activity reading("the reader of VTK failed on " + file, "the file may be damaged");
    const Silence silence;
    return LoadExtra().ListHdfTimes(file);
  }
  return ends(".xyz") || ends(".extxyz") || ends(".lammpstrj") || ends(".dump") || ends(".txt") ||
      ends(".dat")
    ? ListTimesInText(file)
    : std::vector<double>();
}

vtkSmartPointer<vtkPointSet> ReadWalls(
  const std::vector<std::string>& files, MessageCapture* messages)
{
  return files.empty() ? nullptr : ReadParticles(files, messages);
}

std::vector<std::string> ListFiles(const std::vector<std::string>& files, MessageCapture* messages)
{
  std::vector<std::string> all = files;
  for (const std::string& file : files)
  {
    try
    {
      const std::vector<std::string> parts =
        IsList(file) ? ListParts(file, messages) : std::vector<std::string>();
      all.insert(all.end(), parts.begin(), parts.end());
    }
    catch (const std::runtime_error&)
    {
      // It is said where it is read.
    }
  }
  return all;
}

ParticleSets ReadParticlesPart(
  const std::string& file, int rank, int count, MessageCapture* messages)
{
  const std::vector<std::string> all = ListParts(file, messages);
  ParticleSets sets;
  for (auto i = static_cast<std::size_t>(rank); i < all.size();
       i += static_cast<std::size_t>(count))
  {
    ReadSet(all[i], sets, messages);
  }
  sets.IsList = IsList(file);
  return sets;
}

vtkSmartPointer<vtkPointSet> JoinSets(const ParticleSets& sets)
{
  std::vector<vtkSmartPointer<vtkPointSet>> parts;
  for (std::size_t i = 0; i < sets.Sets.size(); ++i)
  {
    const vtkSmartPointer<vtkPointSet> part =
      TakeParticles(sets.Files[i], sets.Sets[i], sets.HaveVertices);
    if (part->GetNumberOfPoints() > 0)
    {
      parts.push_back(part);
    }
  }
  return parts.empty()                ? NoParticles()
    : sets.IsList || parts.size() > 1 ? JoinParts(parts)
                                      : parts.front();
}

vtkSmartPointer<vtkDataSet> ReadDataSet(const std::string& file, MessageCapture* messages)
{
  const vtkSmartPointer<vtkDataObject> data = ReadWithCare(file, messages, DataFormats);
  vtkDataSet* set = vtkDataSet::SafeDownCast(data);
  if (set && set->GetNumberOfPoints() > MostPoints)
  {
    throw std::runtime_error(file + " has " + std::to_string(set->GetNumberOfPoints()) +
      " points; at most " + std::to_string(MostPoints) + " can be probed at once");
  }
  if (!set || set->GetNumberOfPoints() == 0)
  {
    throw std::runtime_error(file + " holds no points");
  }
  CheckArrays(file, set->GetPointData(), set->GetNumberOfPoints(), " points");
  CheckArrays(file, set->GetCellData(), set->GetNumberOfCells(), " cells");
  return set;
}

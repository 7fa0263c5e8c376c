// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ParticleFile.h"

#include "Extra.h"
#include "Failures.h"
#include "Formats.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHFound.h"
#include "vtkSPHSay.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <new>
#include <set>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace
{

namespace fs = std::filesystem;

/// The files that the run reads, by device and inode. CheckRegularFile() adds them.
std::set<std::pair<dev_t, ino_t>>& Sources()
{
  static std::set<std::pair<dev_t, ino_t>> sources;
  return sources;
}

/// The functions that read a format.
struct Kind
{
  vtkSmartPointer<vtkDataObject> (*Read)(const std::string& file, std::size_t step);
  /// Lists the times of a file's steps; null if files of this format hold one step and no time.
  std::vector<double> (*ListTimes)(const std::string& file) = nullptr;
  /// Lists the files that hold parts of the particles; null if the file itself holds all particles.
  std::vector<std::string> (*ListParts)(const std::string& file) = nullptr;
};
using Formats = std::vector<FileFormat<Kind>>;

using File = const std::string&;
using Data = vtkSmartPointer<vtkDataObject>;

Data ReadHdf(File file, std::size_t step)
{
  return LoadExtra().ReadHdf(file, step);
}

Data ReadSurface(File file, std::size_t)
{
  return LoadExtra().ReadSurface(file);
}

std::vector<double> ListTimesOfHdf(File file)
{
  std::vector<double> times;
  ReadWithCare(file, [&file, &times] { times = LoadExtra().ListHdfTimes(file); });
  return times;
}

/// Returns the time of the list itself or, if it has none, of its first piece; all pieces have the
/// same time.
std::vector<double> ListTimesOfPieces(const std::string& file)
{
  const std::vector<double> times = ListTimesOfVtk(file);
  return times.empty() ? ListTimesOfVtk(ReadPieces(file).front()) : times;
}

const Formats ParticleFormats = {
  { ".vtp", { ReadXml, ListTimesOfVtk } },
  { ".vtu", { ReadXml, ListTimesOfVtk } },
  { ".pvtp", { nullptr, ListTimesOfPieces, ReadPieces } },
  { ".pvtu", { nullptr, ListTimesOfPieces, ReadPieces } },
  { ".vtkhdf", { ReadHdf, ListTimesOfHdf } },
  { ".vtk", { ReadLegacy, ListTimesOfVtk } },
  { ".csv", { ReadText } },
  { ".tsv", { ReadText } },
  { ".txt", { ReadText, ListTimesInText } },
  { ".dat", { ReadText, ListTimesInText } },
  { ".xyz", { ReadText, ListTimesInText } },
  { ".extxyz", { ReadText, ListTimesInText } },
  { ".lammpstrj", { ReadText, ListTimesInText } },
  { ".dump", { ReadText, ListTimesInText } },
  { ".ply", { ReadPly } },
};

/// Formats of data sets of any class.
const Formats DataFormats = {
  { ".vti", { ReadXml } },
  { ".vtr", { ReadXml } },
  { ".vts", { ReadXml } },
  { ".vtp", { ReadXml } },
  { ".vtu", { ReadXml } },
  { ".vtk", { ReadLegacy } },
  { ".csv", { ReadText } },
  { ".stl", { ReadSurface } },
  { ".ply", { ReadSurface } },
  { ".obj", { ReadSurface } },
};

/// The format of files that are recognized by their first bytes, not by their names.
const Kind Gadget = { ReadGadget, ListTimesOfGadget, ListGadget };

/// Finds the functions that read a file; null if no format fits.
const Kind* KindOf(const Formats& formats, const std::string& file)
{
  if (&formats == &ParticleFormats && IsGadget(file))
  {
    return &Gadget;
  }
  const FileFormat<Kind>* format = FindFormat(formats, file);
  return format ? &format->Process : nullptr;
}

/// Checks that arrays have `count` values. Makes their names fit for sentences and for the
/// surface's file, because names in a legacy file may hold any bytes. kind: what has the values, in words.
void CheckArrays(File file, vtkFieldData* arrays, vtkIdType count, const char* kind)
{
  for (vtkAbstractArray* array : vtkSPHListArrays(arrays))
  {
    array->SetName(Printable(array->GetName() ? array->GetName() : "").c_str());
    for (int c = 0; array->HasAComponentName() && c < array->GetNumberOfComponents(); ++c)
    {
      if (const char* name = array->GetComponentName(c))
      {
        array->SetComponentName(c, Printable(name).c_str());
      }
    }
    RequireToRead(array->GetNumberOfTuples() == count, file,
      std::string("its array '") + array->GetName() + "' has " +
        std::to_string(array->GetNumberOfTuples()) + " entries for " + std::to_string(count) +
        kind);
  }
}

Data Read(File file, const Formats& formats, std::size_t step = 0)
{
  CheckRegularFile(file);
  const Kind* kind = KindOf(formats, file);
  Require(kind, file + " is not a " + ListEndings(formats) + " file");
  RequireToRead(step == 0 || kind->Read == ReadHdf || kind->Read == ReadText, file,
    "it has no step " + std::to_string(step));
  Data data;
  ReadWithCare(file, [kind, &data, &file, step] { data = kind->Read(file, step); });
  auto* set = vtkDataSet::SafeDownCast(data);
  if (set && set->GetNumberOfPoints() > 0)
  {
    CheckArrays(file, set->GetPointData(), set->GetNumberOfPoints(), " points");
    CheckArrays(file, set->GetCellData(), set->GetNumberOfCells(), " cells");
  }
  return data;
}

/// Returns the array. If --only chooses words in it, returns numbers in place of texts, see ChosenWords().
vtkSmartPointer<vtkAbstractArray> AsNumbers(const std::string& file, vtkAbstractArray* array)
{
  const auto chosen = ChosenWords().find(array->GetName());
  if (chosen == ChosenWords().end())
  {
    return array;
  }
  const std::vector<std::string>& words = chosen->second;
  auto* texts = vtkStringArray::SafeDownCast(array);
  RequireToRead(texts, file,
    "--only " + chosen->first + "=" + words.front() +
      " chooses a text, and the array has numbers; give a number or a range");
  vtkNew<vtkIntArray> numbers;
  numbers->SetName(array->GetName());
  for (vtkIdType i = 0; i < texts->GetNumberOfValues(); ++i)
  {
    const auto found = std::find(words.begin(), words.end(), std::string(texts->GetValue(i)));
    numbers->InsertNextValue(
      found == words.end() ? 0 : 1 + static_cast<int>(found - words.begin()));
  }
  return numbers.Get();
}

/// Prints a note, unless it is empty or `isSaid`: of a film, the note of the first step.
void NoteOnce(bool& isSaid, const std::string& note)
{
  if (!note.empty() && !isSaid)
  {
    isSaid = true;
    Say("note: " + note);
  }
}

/// Returns the points, their arrays, and the field data that tell a period, without the cells. haveVertices: if the
/// file has a mesh, only the points of vertices are returned, and a note about the other points is printed.
vtkSmartPointer<vtkPolyData> TakeParticles(File file, vtkPointSet* all, bool haveVertices)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(all, haveVertices);
  auto* data = vtkPointSet::SafeDownCast(taken);
  const vtkIdType others = all->GetNumberOfPoints() - data->GetNumberOfPoints();
  static bool isSaid = false;
  NoteOnce(isSaid,
    others == 0 ? ""
                : vtkSPHSay(MCOR_SAY(MESH_NODES), static_cast<long long>(others),
                    static_cast<long long>(all->GetNumberOfPoints()), " of ", file.c_str()));
  particles->SetPoints(data->GetPoints());
  for (vtkAbstractArray* array : vtkSPHListArrays(data->GetPointData()))
  {
    particles->GetPointData()->AddArray(array);
  }
  for (vtkAbstractArray* array : vtkSPHListArrays(data->GetFieldData()))
  {
    if (vtkDataArray::SafeDownCast(array) && vtkSPHTellsOfPeriod(array->GetName()))
    {
      particles->GetFieldData()->AddArray(array);
    }
  }
  return particles;
}

/// Leaves out particles that are copies of another part's particles.
void DropCopies(vtkPolyData* part)
{
  vtkUnsignedCharArray* marks = part->GetPointGhostArray();
  if (!marks)
  {
    return;
  }
  vtkNew<vtkIdList> kept;
  for (vtkIdType i = 0; i < part->GetNumberOfPoints(); ++i)
  {
    if (!(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
    {
      kept->InsertNextId(i);
    }
  }
  vtkNew<vtkPointData> arrays;
  vtkSPHTakeTuples(part->GetPointData(), kept, arrays);
  part->SetPoints(vtkSPHTakePoints(part->GetPoints(), kept));
  part->GetPointData()->ShallowCopy(arrays);
}

/// Splits NAME#N, which means step N of the file NAME, into NAME and N; but not if a file is called NAME#N.
std::pair<std::string, std::size_t> StepOf(const std::string& name)
{
  std::error_code error;
  const std::size_t at = name.rfind('#');
  const bool isNumber = at != std::string::npos && at + 1 < name.size() && name.size() - at < 12 &&
    name.find_first_not_of("0123456789", at + 1) == std::string::npos;
  return isNumber && !fs::exists(name, error)
    ? std::make_pair(name.substr(0, at), std::strtoull(name.c_str() + at + 1, nullptr, 10))
    : std::make_pair(name, 0ull);
}

/// Returns the files that a list of pieces names, or all files of a GADGET snapshot; for any other file, the file itself.
std::vector<std::string> ListParts(const std::string& name)
{
  const auto [file, step] = StepOf(name);
  const Kind* kind = KindOf(ParticleFormats, file);
  if (!kind || !kind->ListParts)
  {
    return { name };
  }
  RequireToRead(step == 0, file, "it has no step " + std::to_string(step));
  const std::vector<std::string> parts = kind->ListParts(file);
  for (const std::string& part : parts)
  {
    const FileFormat<Kind>* format = FindFormat(ParticleFormats, StepOf(part).first);
    RequireToRead(
      !format || !format->Process.ListParts, file, "its piece " + part + " is a list itself");
  }
  return parts;
}

}

std::map<std::string, std::vector<std::string>>& ChosenWords()
{
  static std::map<std::string, std::vector<std::string>> words;
  return words;
}

void CheckRegularFile(const std::string& file)
{
  struct stat status = {};
  const bool isReadable = stat(file.c_str(), &status) == 0 && access(file.c_str(), R_OK) == 0;
  const std::string problem = std::strerror(errno);
  RequireToRead(!S_ISDIR(status.st_mode), file, "it is a directory");
  RequireToRead(status.st_mode == 0 || S_ISREG(status.st_mode), file, "it is not a regular file");
  RequireToRead(isReadable, file, problem);
  Sources().emplace(status.st_dev, status.st_ino);
}

void ReadWithCare(const std::string& file, const std::function<void()>& read)
{
  Messages() = {};
  const Activity reading("reading " + file + " failed", "the file may be damaged", true);
  try
  {
    read();
    RequireToRead(Messages().Errors.empty(), file, Messages().FirstError());
    return;
  }
  catch (const std::bad_alloc&)
  {
  }
  catch (const std::length_error&)
  {
  }
  FailToRead(file, "it needs more memory than is available; it may be damaged");
}

std::string ParticleFileEndings()
{
  return ListEndings(ParticleFormats);
}

vtkSmartPointer<vtkPointSet> ReadParticles(
  const std::vector<std::string>& files, bool mayBeEmpty, bool isSilent)
{
  const ParticleSets sets = ReadSets(files);
  Require(!sets.Sets.empty() || mayBeEmpty, files.front() + " holds no points");
  return JoinSets(sets, isSilent);
}

std::vector<double> ListTimes(const std::string& name)
{
  const auto [file, step] = StepOf(name);
  const Kind* kind = KindOf(ParticleFormats, file);
  const std::vector<double> times =
    kind && kind->ListTimes ? kind->ListTimes(file) : std::vector<double>();
  return file == name     ? times
    : step < times.size() ? std::vector<double>{ times[step] }
                          : std::vector<double>();
}

double StoredTimeStep(const std::vector<std::string>& files)
{
  std::set<double> found;
  for (const std::string& file : files)
  {
    const Kind* kind = KindOf(ParticleFormats, file);
    const bool isOfVtk = kind && kind->ListTimes == ListTimesOfVtk;
    const std::vector<double> step = isOfVtk ? NumberInVtk(file, { "dt" }) : std::vector<double>();
    found.insert(step.empty() ? 0.0 : step.front());
  }
  return found.size() == 1 ? std::max(*found.begin(), 0.0) : 0.0;
}

vtkSmartPointer<vtkPointSet> ReadWalls(const std::vector<std::string>& files)
{
  return files.empty() ? nullptr : ReadParticles(files, false, true);
}

void OpenSources(const std::vector<std::string>& files)
{
  for (const std::string& file : files)
  {
    FailureOf(
      [&file]
      {
        CheckRegularFile(StepOf(file).first);
        for (const std::string& part : ListParts(file))
        {
          FailureOf([&part] { CheckRegularFile(StepOf(part).first); });
        }
      });
  }
}

bool IsSource(const struct stat& file)
{
  return Sources().count({ file.st_dev, file.st_ino }) > 0;
}

ParticleSets ReadSets(const std::vector<std::string>& files, int rank, int count)
{
  ParticleSets sets;
  std::vector<std::string> all;
  for (const std::string& file : files)
  {
    const std::vector<std::string> parts = ListParts(file);
    all.insert(all.end(), parts.begin(), parts.end());
  }
  sets.AreParts = files.size() > 1 || all != files;
  const auto endOf = [&all, count](int ranks)
  {
    const auto n = static_cast<std::size_t>(count);
    return (static_cast<std::size_t>(ranks) * all.size() + n - 1) / n;
  };
  for (std::size_t i = endOf(rank); i < endOf(rank + 1); ++i)
  {
    const auto [file, step] = StepOf(all[i]);
    const Data data = Read(file, ParticleFormats, step);
    vtkSmartPointer<vtkPointSet> points = vtkPointSet::SafeDownCast(data);
    const std::string what = data ? std::string("a ") + data->GetClassName() : "no VTK data";
    Require(points, vtkSPHSay(MCOR_SAY(NO_PARTICLES_IN), file.c_str(), what.c_str()));
    if (points->GetNumberOfPoints() > 0)
    {
      if (vtkSPHHaveVertices(points))
      {
        sets.HaveVertices = true;
        points = TakeParticles(file, points, true); // cells need not be kept
      }
      sets.Sets.emplace_back(file, points);
    }
  }
  return sets;
}

vtkSmartPointer<vtkPointSet> JoinSets(const ParticleSets& sets, bool isSilent)
{
  vtkNew<vtkMultiBlockDataSet> blocks;
  for (const auto& [file, points] : sets.Sets)
  {
    const vtkSmartPointer<vtkPolyData> part = TakeParticles(file, points, sets.HaveVertices);
    if (part->GetNumberOfPoints() == 0)
    {
      continue;
    }
    for (vtkAbstractArray* array : vtkSPHListArrays(part->GetPointData()))
    {
      part->GetPointData()->AddArray(AsNumbers(file, array));
    }
    if (!sets.AreParts)
    {
      return part;
    }
    DropCopies(part);
    blocks->SetBlock(blocks->GetNumberOfBlocks(), part);
  }
  const vtkSmartPointer<vtkPointSet> joined = vtkSPHJoinBlocks(blocks);
  static bool isSaid = false;
  NoteOnce(isSaid, isSilent ? "" : vtkSPHDescribeLost(blocks, joined));
  if (blocks->GetNumberOfBlocks() > 0)
  {
    joined->SetFieldData(blocks->GetBlock(0)->GetFieldData());
  }
  return joined;
}

vtkSmartPointer<vtkDataSet> ReadDataSet(const std::string& file)
{
  const vtkSmartPointer<vtkDataObject> data = Read(file, DataFormats);
  vtkDataSet* set = vtkDataSet::SafeDownCast(data);
  const vtkIdType count = set ? set->GetNumberOfPoints() : 0;
  Require(count > 0, file + " holds no points");
  Require(count <= VTK_INT_MAX,
    file + " has " + std::to_string(count) + " points; at most " + std::to_string(VTK_INT_MAX) +
      " can be probed at once");
  return set;
}

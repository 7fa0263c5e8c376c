// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RunStatistics.h"

#include "Job.h"
#include "SafeText.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkStringArray.h"
#include "vtkVersion.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include <sys/resource.h>

namespace
{

/// JSON, as VTK's own library for it is private in some builds. Members are keys, empty in a list,
/// and texts.
using Members = std::vector<std::pair<std::string, std::string>>;

/// Reads back as the same number; JSON has neither NaN nor infinity.
std::string Json(double number)
{
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof(digits), number);
  return std::isfinite(number) ? std::string(digits, result.ptr) : "null";
}

/// An object, or a list, a member a line.
std::string Json(const Members& members, const char* brackets = "{}")
{
  std::string text;
  for (const auto& [key, value] : members)
  {
    text += (text.empty() ? "\n" : ",\n") + (key.empty() ? "" : QuotedForJson(key) + ": ") + value;
  }
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 3)
  {
    text.insert(at + 1, "  "); // no value has a line break of its own
  }
  return brackets[0] + text + (text.empty() ? "" : "\n") + brackets[1];
}

std::string JsonList(const std::vector<std::string>& texts)
{
  Members members;
  for (const std::string& text : texts)
  {
    members.emplace_back("", QuotedForJson(text));
  }
  return Json(members, "[]");
}

const char* const ArrayNames[] = { "Scalar", "SmoothingLengthArray", "VolumeArray", "MassArray",
  "DensityArray" };
const char* const ParameterNames[] = {
  "SmoothingLengthIsSupportRadius",
  "EstimateSmoothingLength",
  "ParticleVolume",
  "Mass",
  "Density",
  "IsoValues",
  "Field",
  "CubeSizeMode",
  "Capping",
#define BOUNDS(member, scope, property) property,
#define OPTION(member, usual, legal, words, scope, property) property,
#include "mcor_options.def"
};
const char* const StatisticNames[] = {
#define STATISTIC(how, when, member, name) name,
#include "mcor_statistics.def"
  "SmoothingLengthRange", "ScalarRange", "Points", "Triangles", "Lines", "Pieces", "RankParticles",
  "RankCopies", "RankBytesSent", "RankWork", "RankNodesEvaluated", "RankTriangles", "RankSeconds"
};

double Number(vtkFieldData* run, const char* name, vtkIdType index = 0)
{
  vtkDataArray* array = run->GetArray(name);
  const int components = array ? array->GetNumberOfComponents() : 1;
  return array && index < array->GetNumberOfValues()
    ? array->GetComponent(index / components, static_cast<int>(index % components))
    : 0.0;
}

std::string Text(vtkFieldData* run, const char* name)
{
  vtkStringArray* array = vtkStringArray::SafeDownCast(run->GetAbstractArray(name));
  return array && array->GetNumberOfValues() > 0 ? std::string(array->GetValue(0)) : "";
}

/// Counts in full, everything else with six digits.
std::string Format(double value)
{
  std::ostringstream stream;
  const bool whole = value == static_cast<double>(static_cast<long long>(value));
  stream << std::setprecision(whole ? 15 : 6) << value;
  return stream.str();
}

std::string Format(vtkFieldData* run, const char* name, vtkIdType index = 0)
{
  return Format(Number(run, name, index));
}

/// Describes a quantity: its array, or the value for all particles; empty if there is neither.
std::string DescribeQuantity(vtkFieldData* run, const char* name)
{
  const std::string array = Text(run, (std::string(name) + "Array").c_str());
  return !array.empty() || !run->GetArray(name) ? array : Format(run, name);
}

std::string DescribeVolume(vtkFieldData* run)
{
  const std::string volume = Text(run, "VolumeArray");
  const std::string mass = DescribeQuantity(run, "Mass");
  const std::string density = DescribeQuantity(run, "Density");
  if (!volume.empty())
  {
    return "array " + volume;
  }
  if (run->HasArray("ParticleVolume"))
  {
    return Format(run, "ParticleVolume");
  }
  if (!mass.empty() && !density.empty())
  {
    return mass + " / " + density;
  }
  return mass.empty() ? "computed" : "computed from " + mass;
}

std::string DescribeParticles(vtkFieldData* run)
{
  const double low = Number(run, "SmoothingLengthRange", 0);
  const double high = Number(run, "SmoothingLengthRange", 1);
  const std::string array = Text(run, "SmoothingLengthArray");
  return Format(run, "FluidParticles") + " fluid, " + Format(run, "SolidParticles") +
    " solid; smoothing length " + Format(low) + (low < high ? " .. " + Format(high) : "") +
    (array.empty() ? "" : " (array " + array + ")") + "; volume: " + DescribeVolume(run);
}

std::string DescribeField(vtkFieldData* run)
{
  const std::string scalar = Text(run, "Scalar");
  std::string line = scalar.empty() ? "weight sum" : scalar;
  vtkDataArray* values = run->GetArray("IsoValues");
  for (vtkIdType i = 0; values && i < values->GetNumberOfValues(); ++i)
  {
    line += (i ? ", " : " = ") + Format(run, "IsoValues", i);
  }
  if (!scalar.empty())
  {
    line += "; range " + Format(run, "ScalarRange", 0) + " .. " + Format(run, "ScalarRange", 1) +
      "; field " + Text(run, "Field");
  }
  return line + "; kernel " + Text(run, "Kernel") + "; cube size " + Format(run, "CubeSize");
}

std::string DescribeMeasures(vtkFieldData* run)
{
  const bool hasPieces = run->HasArray("Pieces");
  return (run->HasArray("Length") ? "; length " + Format(run, "Length") : "") +
    (hasPieces ? "; " + Format(run, "Pieces") +
          (Number(run, "Pieces") == 1.0 ? " piece" : " pieces") + " of"
        : run->HasArray("Area") ? ";"
                                : "") +
    (run->HasArray("Area") ? " area " + Format(run, "Area") : "") +
    (run->HasArray("Volume") ? ", volume " + Format(run, "Volume") : "");
}

std::string DescribeCorrection(vtkFieldData* run)
{
  if (Number(run, "Preview") != 0.0)
  {
    return "none (preview)";
  }
  return "vertices moved by: mean " + Format(run, "CorrectionMean") + ", max " +
    Format(run, "CorrectionMax") + ", deviation " + Format(run, "CorrectionStandardDeviation") +
    "; iterations: mean " + Format(run, "IterationsMean") + ", max " +
    Format(run, "IterationsMax") + "; largest remaining error " + Format(run, "ResidualMax");
}

/// There may be more triangles than before: what a cut leaves of one is one or two.
std::string DescribeTrimming(vtkFieldData* run)
{
  const double caps = run->HasArray("CapTriangles") ? Number(run, "CapTriangles") : 0.0;
  std::string text;
  if (!run->HasArray("Lines") &&
    Number(run, "Triangles") - caps != Number(run, "TrianglesBeforeTrimming"))
  {
    text = Format(run, "TrianglesBeforeTrimming") + " before trimming, which cuts some in two";
  }
  if (caps > 0.0)
  {
    text += (text.empty() ? "" : "; ") + Format(run, "CapTriangles") +
      (run->HasArray("Lines") ? " parts of them in caps" : " of them in caps");
  }
  return text.empty() ? "" : " (" + text + ")";
}

/// "SeedCellsNotIntersected" -> "seed_cells_not_intersected", "search grid" -> "search_grid"
std::string Key(const std::string& name)
{
  std::string key;
  for (const char c : name)
  {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isupper(byte) && !key.empty())
    {
      key += '_';
    }
    key += std::isalnum(byte) ? static_cast<char>(std::tolower(byte)) : '_';
  }
  return key;
}

std::string Json(vtkFieldData* run, const char* name)
{
  vtkDataArray* numbers = run->GetArray(name);
  if (!numbers)
  {
    return QuotedForJson(Text(run, name));
  }
  std::string values;
  for (vtkIdType i = 0; i < numbers->GetNumberOfValues(); ++i)
  {
    values += (i ? ", " : "") + Json(Number(run, name, i));
  }
  const bool isOne = numbers->GetNumberOfValues() == 1 && std::string(name) != "IsoValues";
  return isOne ? values : "[" + values + "]";
}

template <std::size_t N>
std::string JsonGroup(vtkFieldData* run, const char* const (&names)[N])
{
  Members members;
  for (const char* name : names)
  {
    if (*name && run->GetAbstractArray(name))
    {
      members.emplace_back(Key(name), Json(run, name));
    }
  }
  return Json(members);
}

std::string JsonSeconds(vtkFieldData* run)
{
  vtkDataArray* seconds = run->GetArray("Seconds");
  Members members;
  for (int i = 0; seconds && i < seconds->GetNumberOfComponents(); ++i)
  {
    members.emplace_back(Key(seconds->GetComponentName(i)), Json(seconds->GetComponent(0, i)));
  }
  return Json(members);
}

/// Device, arrays and parameters of a run.
Members ListSetting(const Job& job, vtkFieldData* run)
{
  Members setting = { { "device", Json(run, "Device") }, { "platform", Json(run, "Platform") },
    { "arrays", JsonGroup(run, ArrayNames) }, { "parameters", JsonGroup(run, ParameterNames) } };
  vtkMarchingCorrectors* filter = job.Surface;
  if (*filter->GetFluidArrayName())
  {
    static const char* const solids[] = { "weight", "ignore", "wall",
      "auto" }; // by the filter's numbers
    Members fluid = { { "array", QuotedForJson(filter->GetFluidArrayName()) },
      { "value", Json(filter->GetFluidValue()) },
      { "solids", QuotedForJson(solids[filter->GetSolids()]) } };
    if (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL ||
      (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_AUTO && !filter->GetFreeSurface()))
    {
      vtkDataArray* used = run->GetArray("WallShare");
      fluid.emplace_back(
        "wall_share", Json(used ? used->GetComponent(0, 0) : filter->GetWallShare()));
    }
    setting.emplace_back("fluid", Json(fluid));
  }
  return setting;
}

/// The program and its files.
Members ListFiles(const Job& job)
{
  Members files = { { "program", QuotedForJson("marching-correctors " MCOR_PROGRAM_VERSION) },
    { "vtk", QuotedForJson(vtkVersion::GetVTKVersion()) },
    job.IsFilm() ? std::make_pair("inputs", JsonList(job.Inputs))
                 : std::make_pair("input", QuotedForJson(job.Inputs.front())) };
  if (!job.Walls.empty())
  {
    files.emplace_back("walls", JsonList(job.Walls));
  }
  files.emplace_back("output", QuotedForJson(job.Output));
  return files;
}
}

std::string DescribeSeconds(vtkFieldData* run)
{
  vtkDataArray* seconds = run->GetArray("Seconds");
  if (!seconds)
  {
    return "";
  }
  std::ostringstream line;
  line << "seconds     " << std::fixed << std::setprecision(3);
  for (int i = 0; i < seconds->GetNumberOfComponents(); ++i)
  {
    line << (i ? ", " : "") << seconds->GetComponentName(i) << " " << seconds->GetComponent(0, i);
  }
  return line.str() + "\n";
}

std::string DescribeRun(vtkFieldData* run)
{
  if (!run->GetArray("Seconds"))
  {
    return "";
  }
  std::ostringstream text;
  text << "particles   " << DescribeParticles(run) << "\n"
       << "contour     " << DescribeField(run) << "\n"
       << "device      " << Text(run, "Device") << " (" << Text(run, "Platform") << ")\n"
       << "cells       " << Format(run, "VirtualCells") << " of the virtual grid, "
       << Format(run, "SeedCells") << " seeds (" << Format(run, "SeedCellsNotIntersected")
       << " without surface), " << Format(run, "CellsUsed") << " with surface\n"
       << "correction  " << DescribeCorrection(run) << "\n"
       << (run->GetArray("Lines") ? "lines       " : "surface     ") << Format(run, "Points")
       << " points, " << Format(run, run->GetArray("Lines") ? "Lines" : "Triangles")
       << (run->GetArray("Lines") ? " lines" : " triangles") << DescribeTrimming(run)
       << DescribeMeasures(run) << "\n";
  return text.str();
}

std::string StatisticsAsJson(const Job& job, const std::vector<vtkSmartPointer<vtkFieldData>>& runs,
  const std::vector<double>& wallSeconds, const std::vector<std::string>& warnings,
  double peakResidentBytes)
{
  vtkFieldData* last = runs.back();
  Members members = ListFiles(job), each;
  const Members setting = ListSetting(job, last);
  members.insert(members.end(), setting.begin(), setting.end());
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    each.emplace_back("",
      Json(Members{ { "seconds", JsonSeconds(runs[i]) },
        { "statistics", JsonGroup(runs[i], StatisticNames) },
        { "wall_seconds", Json(wallSeconds[i]) } }));
  }
  for (const auto& [key, value] :
    Members{ { "statistics", JsonGroup(last, StatisticNames) }, { "seconds", JsonSeconds(last) },
      { "wall_seconds", Json(wallSeconds.back()) }, { "runs", Json(each, "[]") },
      { "warnings", JsonList(warnings) }, { "peak_resident_bytes", Json(peakResidentBytes) } })
  {
    members.emplace_back(key, value);
  }
  return Json(members) + "\n";
}

std::string StepAsJson(const FilmStep& step, vtkFieldData* run, double wallSeconds)
{
  Members members = { { "time", Json(step.Time) }, { "inputs", JsonList(step.Inputs) } };
  if (!run)
  {
    members.emplace_back("error", QuotedForJson(step.Error));
    return Json(members);
  }
  members.emplace_back("output", QuotedForJson(step.Output));
  members.emplace_back("seconds", JsonSeconds(run));
  members.emplace_back("statistics", JsonGroup(run, StatisticNames));
  members.emplace_back("wall_seconds", Json(wallSeconds));
  members.emplace_back("peak_resident_bytes", Json(PeakResidentBytes()));
  return Json(members);
}

std::string FilmAsJson(const Job& job, const std::vector<FilmStep>& steps, vtkFieldData* run)
{
  Members members = ListFiles(job), each;
  const Members setting = run ? ListSetting(job, run) : Members();
  members.insert(members.end(), setting.begin(), setting.end());
  for (const FilmStep& step : steps)
  {
    each.emplace_back("", step.Statistics);
  }
  members.emplace_back("steps", Json(each, "[]"));
  members.emplace_back("peak_resident_bytes", Json(PeakResidentBytes()));
  return Json(members) + "\n";
}

double PeakResidentBytes()
{
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  return static_cast<double>(usage.ru_maxrss);
#else
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
#endif
}

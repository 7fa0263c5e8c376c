// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Runs.h"

#include "Job.h"
#include "Text.h"

#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkFieldData.h"
#include "vtkStringArray.h"
#include "vtkVersion.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include <sys/resource.h>

namespace
{

/// The members of an object or a list of JSON: key and value, as text; a list has empty keys. VTK's own library for
/// JSON is private in some builds.
using Members = std::vector<std::pair<std::string, std::string>>;

/// Writes a number so that it is read back exactly; NaN and infinity, which JSON lacks, become null.
std::string Json(double number)
{
  return std::isfinite(number) ? DigitsOf(number) : "null";
}

/// Writes an object or a list, with one member on each line.
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

std::string JsonList(const std::vector<std::string>& values)
{
  Members members;
  for (const std::string& value : values)
  {
    members.emplace_back("", value);
  }
  return Json(members, "[]");
}

std::string JsonTexts(std::vector<std::string> texts)
{
  std::transform(texts.begin(), texts.end(), texts.begin(), QuotedForJson);
  return JsonList(texts);
}

Members operator+(Members members, const Members& more)
{
  members.insert(members.end(), more.begin(), more.end());
  return members;
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
  "RankCopies", "RankBytesSent", "RankWork", "RankNodesEvaluated", "RankTriangles", "RankSeconds",
  "RankNeighbors"
};

std::string Text(vtkFieldData* run, const std::string& name)
{
  vtkStringArray* array = vtkStringArray::SafeDownCast(run->GetAbstractArray(name.c_str()));
  return array && array->GetNumberOfValues() > 0 ? std::string(array->GetValue(0)) : "";
}

/// Returns the text that Fill() puts in the place of a name.
std::string Value(vtkFieldData* run, const std::string& name)
{
  const std::string text = Text(run, name), array = Text(run, name + "Array");
  const std::size_t colon = name.find(':');
  const std::vector<double> numbers = NumbersOf(run, name.substr(0, colon));
  std::vector<std::string> found;
  for (std::size_t i = 0; i < numbers.size(); ++i)
  {
    if (colon == std::string::npos || name.substr(colon + 1) == std::to_string(i))
    {
      const bool isWhole = numbers[i] == static_cast<double>(static_cast<long long>(numbers[i]));
      found.push_back(DigitsOf(numbers[i], isWhole ? 15 : 6));
    }
  }
  return !text.empty() ? text : array.empty() ? Joined(found) : array;
}

/// Returns seed_cells_not_intersected for "SeedCellsNotIntersected", search_grid for "search grid".
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

std::string Json(vtkFieldData* run, const std::string& name)
{
  if (!run->GetArray(name.c_str()))
  {
    return QuotedForJson(Text(run, name));
  }
  std::vector<std::string> values;
  for (const double number : NumbersOf(run, name))
  {
    values.push_back(Json(number));
  }
  return values.size() == 1 && name != "IsoValues" ? values[0] : "[" + Joined(values) + "]";
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

/// Lists the program and its files; and, if there is a run, its device, arrays and parameters.
Members ListSetting(const Job& job, vtkFieldData* run)
{
  Members setting = { { "program", QuotedForJson("marching-correctors " MCOR_PROGRAM_VERSION) },
    { "vtk", QuotedForJson(vtkVersion::GetVTKVersion()) },
    job.IsFilm() ? std::make_pair("inputs", JsonTexts(job.Inputs))
                 : std::make_pair("input", QuotedForJson(job.Inputs.front())) };
  if (!job.Walls.empty())
  {
    setting.emplace_back("walls", JsonTexts(job.Walls));
  }
  setting.emplace_back("output", QuotedForJson(job.Output));
  if (!run)
  {
    return setting;
  }
  setting = setting +
    Members{ { "device", Json(run, "Device") }, { "platform", Json(run, "Platform") },
      { "arrays", JsonGroup(run, ArrayNames) }, { "parameters", JsonGroup(run, ParameterNames) } };
  vtkMarchingCorrectors* filter = job.Surface;
  if (*filter->GetFluidArrayName())
  {
    static const char* const solids[] = { "weight", "ignore", "wall",
      "auto" }; // in the order of the filter's numbers
    Members fluid = { { "array", QuotedForJson(filter->GetFluidArrayName()) },
      { "value", Json(filter->GetFluidValue()) },
      { "solids", QuotedForJson(solids[filter->GetSolids()]) } };
    if (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL ||
      (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_AUTO && !filter->GetFreeSurface()))
    {
      fluid.emplace_back("wall_share", Json(NumberOf(run, "WallShare", filter->GetWallShare())));
    }
    setting.emplace_back("fluid", Json(fluid));
  }
  return setting;
}
}

std::vector<double> NumbersOf(vtkFieldData* run, const std::string& name)
{
  std::vector<double> numbers;
  if (vtkDataArray* array = run->GetArray(name.c_str()))
  {
    const auto values = vtk::DataArrayValueRange(array);
    numbers.assign(values.begin(), values.end());
  }
  return numbers;
}

double NumberOf(vtkFieldData* run, const std::string& name, double none)
{
  const std::vector<double> numbers = NumbersOf(run, name);
  return numbers.empty() ? none : numbers.front();
}

std::string Fill(vtkFieldData* run, const std::string& form)
{
  std::string text;
  std::size_t begin = 0; // where the text of an alternative begins
  bool isComplete = true;
  for (std::size_t i = 0; i < form.size(); ++i)
  {
    const char c = form[i];
    if (c == '{')
    {
      const std::size_t name = i + 1;
      i = form.find('}', i);
      const std::string value = Value(run, form.substr(name, i - name));
      isComplete = isComplete && !value.empty();
      text += value;
    }
    else if (c == '[' || c == '|' || c == ']')
    {
      text.resize(c == '[' || isComplete ? text.size() : begin);
      i = c == '|' && isComplete ? form.find(']', i) : i;
      begin = text.size();
      isComplete = true;
    }
    else
    {
      text += c;
    }
  }
  return text;
}

std::string DescribeSeconds(vtkFieldData* run, bool atLength)
{
  vtkDataArray* seconds = run->GetArray("Seconds");
  if (!seconds)
  {
    return "";
  }
  std::ostringstream line;
  line << "seconds     " << std::fixed << std::setprecision(3);
  const int last = seconds->GetNumberOfComponents() - 1; // the total
  for (int i = atLength ? 0 : last; i <= last; ++i)
  {
    line << (atLength && i > 0 ? ", " : "")
         << (atLength ? seconds->GetComponentName(i) + std::string(" ") : "")
         << seconds->GetComponent(0, i);
  }
  return line.str() + "\n";
}

std::string DescribeRun(vtkFieldData* run, bool atLength)
{
  if (!run->GetArray("Seconds"))
  {
    return "";
  }
  const std::vector<double> lengths = NumbersOf(run, "SmoothingLengthRange");
  const bool areMany = lengths.size() == 2 && lengths[0] < lengths[1];
  const bool isPreview = NumberOf(run, "Preview") != 0.0;
  const double caps = NumberOf(run, "CapTriangles");
  const bool hasLines = run->HasArray("Lines");
  std::string trimming; // may add triangles: a cut leaves one or two triangles of one
  if (!hasLines && NumberOf(run, "Triangles") - caps != NumberOf(run, "TrianglesBeforeTrimming"))
  {
    trimming = "{TrianglesBeforeTrimming} before trimming, which cuts some in two";
  }
  if (caps > 0.0)
  {
    trimming += std::string(trimming.empty() ? "" : "; ") + "{CapTriangles} " +
      (hasLines ? "parts of them in caps" : "of them in caps");
  }
  trimming = trimming.empty() ? "" : " (" + trimming + ")";
  const std::string volume =
    "[array {VolumeArray}|{ParticleVolume}|{Mass} / {Density}|computed from {Mass}|computed]";
  const bool leavesSpray =
    NumberOf(run, "LoneParticles") > 0.0 && Fill(run, volume).compare(0, 8, "computed") != 0;
  const std::string pieces = NumberOf(run, "Pieces") == 1.0 ? "piece" : "pieces";
  return Fill(run,
    std::string("particles   {FluidParticles} fluid, {SolidParticles} solid; "
                "smoothing length {SmoothingLengthRange:0}") +
      (areMany ? " .. {SmoothingLengthRange:1}" : "") +
      "[ (array {SmoothingLengthArray})]; volume: " + volume + "\n" +
      (leavesSpray ? "spray       a lone particle has no surface where volume x W(0) is below the iso "
                     "value ({LoneParticles} of {FluidParticles}); --volume computed keeps drops\n"
                   : "") +
      "contour     [{Scalar}|weight sum][ = {IsoValues}]"
      "[; range {ScalarRange:0} .. {ScalarRange:1}]" +
      (atLength ? "[; field {Field}]; kernel {Kernel}; cube size {CubeSize}\n"
                  "device      {Device} ({Platform})\n"
                  "cells       {VirtualCells} of the virtual grid, {SeedCells} seeds "
                  "({SeedCellsNotIntersected} without surface), {CellsUsed} with surface\n"
                  "correction  " +
            std::string(isPreview
                ? "none (preview)"
                : "vertices moved by: mean {CorrectionMean}, max {CorrectionMax}, deviation "
                  "{CorrectionStandardDeviation}; iterations: mean {IterationsMean}, max "
                  "{IterationsMax}; largest remaining error {ResidualMax}")
                : "") +
      "\n[lines       {Points} points, {Lines} lines|"
      "surface     {Points} points, {Triangles} triangles]" +
      (atLength ? trimming : "") + "[; length {Length}][; {Pieces} " + pieces +
      " of area {Area}|; area {Area}][, volume {Volume}]\n");
}

std::string StatisticsAsJson(const Job& job, const std::vector<vtkSmartPointer<vtkFieldData>>& runs,
  const std::vector<double>& wallSeconds, const std::vector<std::string>& warnings,
  double peakResidentBytes)
{
  vtkFieldData* last = runs.back();
  std::vector<std::string> each;
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    each.push_back(Json(Members{ { "seconds", JsonSeconds(runs[i]) },
      { "statistics", JsonGroup(runs[i], StatisticNames) },
      { "wall_seconds", Json(wallSeconds[i]) } }));
  }
  return Json(ListSetting(job, last) +
           Members{ { "statistics", JsonGroup(last, StatisticNames) },
             { "seconds", JsonSeconds(last) }, { "wall_seconds", Json(wallSeconds.back()) },
             { "runs", JsonList(each) }, { "warnings", JsonTexts(warnings) },
             { "peak_resident_bytes", Json(peakResidentBytes) } }) +
    "\n";
}

std::string StepAsJson(double time, const std::vector<std::string>& inputs,
  const std::string& result, vtkFieldData* run, double wallSeconds)
{
  const Members members = { { "time", Json(time) }, { "inputs", JsonTexts(inputs) } };
  return Json(members +
    (run
        ? Members{ { "output", QuotedForJson(result) }, { "seconds", JsonSeconds(run) },
            { "statistics", JsonGroup(run, StatisticNames) }, { "wall_seconds", Json(wallSeconds) },
            { "peak_resident_bytes", Json(PeakResidentBytes()) } }
        : Members{ { "error", QuotedForJson(result) } }));
}

std::string FilmAsJson(const Job& job, const std::vector<std::string>& steps, vtkFieldData* run)
{
  return Json(ListSetting(job, run) +
           Members{
             { "steps", JsonList(steps) }, { "peak_resident_bytes", Json(PeakResidentBytes()) } }) +
    "\n";
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

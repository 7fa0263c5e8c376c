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

#include <sys/resource.h>

namespace
{

/// The members of an object or a list of JSON, as text. VTK's own library for JSON is private in some builds.
using Members = std::vector<std::string>;

std::string Of(const std::string& key, const std::string& value)
{
  return QuotedForJson(key) + ": " + value;
}

/// Writes a number so that it is read back exactly; NaN and infinity, which JSON lacks, become null.
std::string Json(double number)
{
  return std::isfinite(number) ? DigitsOf(number) : "null";
}

/// Writes an object or a list, with one member on each line.
std::string Json(const Members& members, const char* brackets = "{}")
{
  std::string text = (members.empty() ? "" : "\n") + Joined(members, ",\n");
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 3)
  {
    text.insert(at + 1, "  "); // no value has a line break of its own
  }
  return brackets[0] + text + (text.empty() ? "" : "\n") + brackets[1];
}

std::string JsonTexts(std::vector<std::string> texts)
{
  std::transform(texts.begin(), texts.end(), texts.begin(), QuotedForJson);
  return Json(texts, "[]");
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
      members.push_back(Of(Key(name), Json(run, name)));
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
    members.push_back(
      Of(Key(seconds->GetComponentName(i)), Json(seconds->GetComponent(0, i))));
  }
  return Json(members);
}

Members ListCosts(vtkFieldData* run, double wallSeconds)
{
  return { Of("seconds", JsonSeconds(run)), Of("statistics", JsonGroup(run, StatisticNames)),
    Of("wall_seconds", Json(wallSeconds)) };
}

/// Lists the program and its files; and, if `run` is not null, the run's device, arrays and parameters.
Members ListSetting(const Job& job, vtkFieldData* run)
{
  Members setting = { Of("program", QuotedForJson("marching-correctors " MCOR_PROGRAM_VERSION)),
    Of("vtk", QuotedForJson(vtkVersion::GetVTKVersion())),
    job.IsFilm() ? Of("inputs", JsonTexts(job.Inputs))
                 : Of("input", QuotedForJson(job.Inputs.front())) };
  if (!job.Walls.empty())
  {
    setting.push_back(Of("walls", JsonTexts(job.Walls)));
  }
  setting.push_back(Of("output", QuotedForJson(job.Output)));
  if (!run)
  {
    return setting;
  }
  setting = setting +
    Members{ Of("device", Json(run, "Device")), Of("platform", Json(run, "Platform")),
      Of("arrays", JsonGroup(run, ArrayNames)), Of("parameters", JsonGroup(run, ParameterNames)) };
  vtkMarchingCorrectors* filter = job.Surface;
  if (*filter->GetFluidArrayName())
  {
    static const char* const solids[] = { "weight", "ignore", "wall",
      "auto" }; // in the order of the filter's numbers
    Members fluid = { Of("array", QuotedForJson(filter->GetFluidArrayName())),
      Of("value", Json(filter->GetFluidValue())),
      Of("solids", QuotedForJson(solids[filter->GetSolids()])) };
    if (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL ||
      (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_AUTO && !filter->GetFreeSurface()))
    {
      fluid.push_back(Of("wall_share", Json(NumberOf(run, "WallShare", filter->GetWallShare()))));
    }
    setting.push_back(Of("fluid", Json(fluid)));
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

std::string Fill(vtkFieldData* run, const std::vector<std::string>& forms)
{
  std::string text;
  bool isComplete = false;
  for (std::size_t i = 0; i < forms.size() && !isComplete; ++i)
  {
    isComplete = true;
    text = Filled(forms[i],
      [run, &isComplete](const std::string& name)
      {
        const std::string value = Value(run, name);
        isComplete = isComplete && !value.empty();
        return value;
      });
  }
  return text;
}

std::string DescribeRun(vtkFieldData* run, bool atLength, bool onlySeconds)
{
  vtkDataArray* times = run->GetArray("Seconds");
  if (!times)
  {
    return "";
  }
  std::ostringstream seconds;
  seconds << "seconds     " << std::fixed << std::setprecision(3);
  const int last = times->GetNumberOfComponents() - 1; // the total
  for (int i = atLength ? 0 : last; i <= last; ++i)
  {
    seconds << (atLength && i > 0 ? ", " : "")
            << (atLength ? times->GetComponentName(i) + std::string(" ") : "")
            << times->GetComponent(0, i);
  }
  seconds << "\n";
  if (onlySeconds)
  {
    return seconds.str();
  }
  const std::vector<double> lengths = NumbersOf(run, "SmoothingLengthRange");
  const bool areMany = lengths.size() == 2 && lengths[0] < lengths[1];
  const bool isPreview = NumberOf(run, "Preview") != 0.0;
  const double caps = NumberOf(run, "CapTriangles");
  const bool hasLines = run->HasArray("Lines");
  std::string trimming; // may add triangles: a cut leaves one or two triangles of one
  if (!hasLines && NumberOf(run, "Triangles") - caps != NumberOf(run, "TrianglesBeforeTrimming"))
  {
    trimming = Fill(run, { "{TrianglesBeforeTrimming} before trimming, which cuts some in two" });
  }
  if (caps > 0.0)
  {
    trimming += (trimming.empty() ? "" : "; ") + Fill(run, { "{CapTriangles} " }) +
      (hasLines ? "parts of them in caps" : "of them in caps");
  }
  trimming = trimming.empty() ? "" : " (" + trimming + ")";
  const std::string volume = Fill(run,
    { "array {VolumeArray}", "{ParticleVolume}", "{Mass} / {Density}", "computed from {Mass}",
      "computed" });
  std::string text = Fill(run,
    { "particles   {FluidParticles} fluid, {SolidParticles} solid; smoothing length "
      "{SmoothingLengthRange:0}" });
  text += areMany ? Fill(run, { " .. {SmoothingLengthRange:1}" }) : "";
  text += Fill(run, { " (array {SmoothingLengthArray})", "" }) + "; volume: " + volume;
  if (NumberOf(run, "LoneParticles") > 0.0 && volume.compare(0, 8, "computed") != 0)
  {
    text += Fill(run,
      { "\nspray       a lone particle has no surface where volume x W(0) is below the iso value "
        "({LoneParticles} of {FluidParticles}); --volume computed keeps drops" });
  }
  text += "\ncontour     " + Fill(run, { "{Scalar}", "weight sum" }) +
    Fill(run, { " = {IsoValues}", "" }) +
    Fill(run, { "; range {ScalarRange:0} .. {ScalarRange:1}", "" });
  if (atLength)
  {
    text += Fill(run, { "; field {Field}", "" }) +
      Fill(run,
        { "; kernel {Kernel}; cube size {CubeSize}\n"
          "device      {Device} ({Platform})\n"
          "cells       {VirtualCells} of the virtual grid, {SeedCells} seeds "
          "({SeedCellsNotIntersected} without surface), {CellsUsed} with surface\n"
          "correction  " +
          std::string(isPreview
              ? "none (preview)"
              : "vertices moved by: mean {CorrectionMean}, max {CorrectionMax}, deviation "
                "{CorrectionStandardDeviation}; iterations: mean {IterationsMean}, max "
                "{IterationsMax}; largest remaining error {ResidualMax}") });
  }
  const std::string pieces = NumberOf(run, "Pieces") == 1.0 ? "piece" : "pieces";
  return text + "\n" +
    Fill(run,
      { "lines       {Points} points, {Lines} lines",
        "surface     {Points} points, {Triangles} triangles", "" }) +
    (atLength ? trimming : "") + Fill(run, { "; length {Length}", "" }) +
    Fill(run, { "; {Pieces} " + pieces + " of area {Area}", "; area {Area}", "" }) +
    Fill(run, { ", volume {Volume}", "" }) + "\n" + seconds.str();
}

std::string StatisticsAsJson(const Job& job, const std::vector<Run>& runs,
  const std::vector<std::string>& warnings, double peakResidentBytes)
{
  vtkFieldData* last = runs.back().Statistics;
  std::vector<std::string> each;
  for (const Run& run : runs)
  {
    each.push_back(Json(ListCosts(run.Statistics, run.WallSeconds)));
  }
  return Json(ListSetting(job, last) +
           Members{ Of("statistics", JsonGroup(last, StatisticNames)),
             Of("seconds", JsonSeconds(last)), Of("wall_seconds", Json(runs.back().WallSeconds)),
             Of("runs", Json(each, "[]")), Of("warnings", JsonTexts(warnings)),
             Of("peak_resident_bytes", Json(peakResidentBytes)) }) +
    "\n";
}

std::string StepAsJson(double time, const std::vector<std::string>& inputs,
  const std::string& result, vtkFieldData* run, double wallSeconds)
{
  const Members members = { Of("time", Json(time)), Of("inputs", JsonTexts(inputs)) };
  return Json(members +
    (run ? Members{ Of("output", QuotedForJson(result)) } + ListCosts(run, wallSeconds) +
          Members{ Of("peak_resident_bytes", Json(PeakResidentBytes())) }
         : Members{ Of("error", QuotedForJson(result)) }));
}

std::string FilmAsJson(const Job& job, const std::vector<std::string>& steps, vtkFieldData* run)
{
  return Json(ListSetting(job, run) +
           Members{ Of("steps", Json(steps, "[]")),
             Of("peak_resident_bytes", Json(PeakResidentBytes())) }) +
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

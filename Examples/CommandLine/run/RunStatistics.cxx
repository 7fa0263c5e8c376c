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

#include <sys/resource.h>

namespace
{

/// Writes JSON, indented. VTK's own JSON library is private in some builds.
class JsonText
{
public:
  /// At depth 0 a text of its own, else what Raw() puts into another one at that depth.
  explicit JsonText(std::size_t depth = 0)
    : Depth(depth)
  {
  }

  /// An object. The key is empty for the outermost one and for elements of a list.
  void Begin(const std::string& key) { this->Open(key, "{"); }
  void End() { this->Close("}"); }
  void BeginList(const std::string& key) { this->Open(key, "["); }
  void EndList() { this->Close("]"); }

  void Value(const std::string& key, const std::string& text)
  {
    this->Line(key);
    this->Text += QuotedForJson(text);
  }

  void Value(const std::string& key, double number)
  {
    this->Line(key);
    this->Text += Formatted(number);
  }

  void Value(const std::string& key, const std::vector<double>& numbers)
  {
    this->Line(key);
    this->Text += "[";
    for (std::size_t i = 0; i < numbers.size(); ++i)
    {
      this->Text += (i ? ", " : "") + Formatted(numbers[i]);
    }
    this->Text += "]";
  }

  void Raw(const std::string& values)
  {
    this->Text += (this->First ? "" : ",") + values;
    this->First = false;
  }

  const std::string& Get() const { return this->Text; }

private:
  void Open(const std::string& key, const char* bracket)
  {
    this->Line(key);
    this->Text += bracket;
    ++this->Depth;
    this->First = true;
  }

  void Close(const char* bracket)
  {
    --this->Depth;
    if (!this->First)
    {
      this->NewLine();
    }
    this->First = false;
    this->Text += bracket;
  }

  /// Comma, line break and key before a value.
  void Line(const std::string& key)
  {
    if (this->Depth > 0)
    {
      this->Text += this->First ? "" : ",";
      this->NewLine();
    }
    this->First = false;
    this->Text += key.empty() ? "" : QuotedForJson(key) + ": ";
  }

  void NewLine() { this->Text += "\n" + std::string(2 * this->Depth, ' '); }

  /// Reads back as the same number; JSON has neither NaN nor infinity.
  static std::string Formatted(double number)
  {
    if (!std::isfinite(number))
    {
      return "null";
    }
    char digits[32];
    const auto result = std::to_chars(digits, digits + sizeof(digits), number);
    return std::string(digits, result.ptr);
  }

  std::string Text;
  std::size_t Depth;
  bool First = true;
};

const char* const ArrayNames[] = { "Scalar", "SmoothingLengthArray", "VolumeArray", "MassArray",
  "DensityArray" };
const char* const ParameterNames[] = { "SmoothingLengthIsSupportRadius", "EstimateSmoothingLength",
  "ParticleVolume", "Mass", "Density", "IsoValues", "Field", "CubeSizeMode", "Capping",
#define BOUNDS(member, scope, property) property,
#define OPTION(member, usual, legal, words, scope, property) property,
#include "mcor_options.def"
};
const char* const StatisticNames[] = {
#define STATISTIC(how, when, member, name) name,
#include "mcor_statistics.def"
  "SmoothingLengthRange", "ScalarRange", "Points", "Triangles", "Lines", "Pieces", "RankParticles",
  "RankCopies", "RankBytesSent", "RankWork", "RankNodesEvaluated", "RankTriangles", "RankSeconds" };

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

void WriteArray(JsonText& json, vtkFieldData* run, const char* name)
{
  vtkDataArray* numbers = run->GetArray(name);
  if (!numbers)
  {
    json.Value(Key(name), Text(run, name));
  }
  else if (numbers->GetNumberOfValues() == 1 && std::string(name) != "IsoValues")
  {
    json.Value(Key(name), Number(run, name));
  }
  else
  {
    std::vector<double> values;
    for (vtkIdType i = 0; i < numbers->GetNumberOfValues(); ++i)
    {
      values.push_back(Number(run, name, i));
    }
    json.Value(Key(name), values);
  }
}

template <std::size_t N>
void WriteGroup(JsonText& json, vtkFieldData* run, const char* group, const char* const (&names)[N])
{
  json.Begin(group);
  for (const char* name : names)
  {
    if (*name && run->GetAbstractArray(name))
    {
      WriteArray(json, run, name);
    }
  }
  json.End();
}

void WriteSeconds(JsonText& json, vtkFieldData* run)
{
  vtkDataArray* seconds = run->GetArray("Seconds");
  json.Begin("seconds");
  for (int i = 0; seconds && i < seconds->GetNumberOfComponents(); ++i)
  {
    json.Value(Key(seconds->GetComponentName(i)), seconds->GetComponent(0, i));
  }
  json.End();
}

void WriteSetting(JsonText& json, const Job& job, vtkFieldData* run)
{
  json.Value("device", Text(run, "Device"));
  json.Value("platform", Text(run, "Platform"));
  WriteGroup(json, run, "arrays", ArrayNames);
  WriteGroup(json, run, "parameters", ParameterNames);
  vtkMarchingCorrectors* filter = job.Surface;
  const std::string fluid = filter->GetFluidArrayName();
  if (!fluid.empty())
  {
    static const char* const names[] = { "weight", "ignore", "wall",
      "auto" }; // by the filter's numbers
    json.Begin("fluid");
    json.Value("array", fluid);
    json.Value("value", filter->GetFluidValue());
    json.Value("solids", std::string(names[filter->GetSolids()]));
    if (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL ||
      (filter->GetSolids() == vtkMarchingCorrectors::SOLIDS_AUTO && !filter->GetFreeSurface()))
    {
      vtkDataArray* used = run->GetArray("WallShare");
      json.Value("wall_share", used ? used->GetComponent(0, 0) : filter->GetWallShare());
    }
    json.End();
  }
}

void WriteList(JsonText& json, const char* key, const std::vector<std::string>& texts)
{
  json.BeginList(key);
  for (const std::string& text : texts)
  {
    json.Value("", text);
  }
  json.EndList();
}

/// Writes the program and its input files. Opens the outermost braces.
void WriteBeginning(JsonText& json, const Job& job)
{
  json.Begin("");
  json.Value("program", std::string("marching-correctors " MCOR_PROGRAM_VERSION));
  json.Value("vtk", std::string(vtkVersion::GetVTKVersion()));
  if (job.IsFilm())
  {
    WriteList(json, "inputs", job.Inputs);
  }
  else
  {
    json.Value("input", job.Inputs.front());
  }
  if (!job.Walls.empty())
  {
    WriteList(json, "walls", job.Walls);
  }
  json.Value("output", job.Output);
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
  JsonText json;
  WriteBeginning(json, job);
  WriteSetting(json, job, last);
  WriteGroup(json, last, "statistics", StatisticNames);
  WriteSeconds(json, last);
  json.Value("wall_seconds", wallSeconds.back());
  json.BeginList("runs");
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    json.Begin("");
    WriteSeconds(json, runs[i]);
    WriteGroup(json, runs[i], "statistics", StatisticNames);
    json.Value("wall_seconds", wallSeconds[i]);
    json.End();
  }
  json.EndList();
  WriteList(json, "warnings", warnings);
  json.Value("peak_resident_bytes", peakResidentBytes);
  json.End();
  return json.Get() + "\n";
}

std::string StepAsJson(const FilmStep& step, vtkFieldData* run, double wallSeconds)
{
  JsonText json(2);
  json.Begin("");
  json.Value("time", step.Time);
  WriteList(json, "inputs", step.Inputs);
  if (run)
  {
    json.Value("output", step.Output);
    WriteSeconds(json, run);
    WriteGroup(json, run, "statistics", StatisticNames);
    json.Value("wall_seconds", wallSeconds);
    json.Value("peak_resident_bytes", PeakResidentBytes());
  }
  else
  {
    json.Value("error", step.Error);
  }
  json.End();
  return json.Get();
}

std::string SettingAsJson(const Job& job, vtkFieldData* run)
{
  JsonText json(1);
  WriteSetting(json, job, run);
  return json.Get();
}

std::string FilmAsJson(
  const Job& job, const std::vector<FilmStep>& steps, const std::string& setting)
{
  JsonText json;
  WriteBeginning(json, job);
  if (!setting.empty())
  {
    json.Raw(setting);
  }
  json.BeginList("steps");
  for (const FilmStep& step : steps)
  {
    json.Raw(step.Statistics);
  }
  json.EndList();
  json.Value("peak_resident_bytes", PeakResidentBytes());
  json.End();
  return json.Get() + "\n";
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

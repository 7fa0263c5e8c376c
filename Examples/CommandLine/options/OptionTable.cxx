// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Reads the values of options, and makes the list of all options from Options.def.
#include "Job.h"

#include "ParticleFile.h"
#include "Text.h"
#include "mcor.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace
{

using Filter = vtkMarchingCorrectors;
using Text = const std::string&;

template <typename... T>
void SetAll(const Job& job, void (vtkSPHAlgorithm::*set)(T...), T... values)
{
  for (vtkSPHAlgorithm* filter : job.All())
  {
    (filter->*set)(values...);
  }
}

/// Returns the index of the last "=" in NAME=... Throws UsageError if there is none, or no name before it.
std::size_t NameEnd(Text option, Text text, const char* form)
{
  const std::size_t equals = text.rfind('=');
  Need(equals != std::string::npos && equals > 0, option, form, text);
  return equals;
}

void SetFluid(Job& job, Text option, Text text)
{
  const std::size_t equals = NameEnd(option, text, "NAME=VALUE");
  SetAll(job, &vtkSPHAlgorithm::SetFluidArrayName, Printable(text.substr(0, equals)).c_str());
  SetAll(job, &vtkSPHAlgorithm::SetFluidValue, ToNumber(option, text.substr(equals + 1)));
}

void AddOnly(Job& job, Text option, Text text)
{
  const std::size_t equals = NameEnd(option, text, "NAME=VALUE or NAME=LOW:HIGH");
  const std::size_t colon = text.find(':', equals);
  const std::string name = Printable(text.substr(0, equals)), word = text.substr(equals + 1);
  double low = 0.0, high = 0.0;
  if (colon == std::string::npos && !ParseNumber(word, low) && word != "inf" && word != "-inf")
  {
    Need(!word.empty(), option, "NAME=VALUE, NAME=LOW:HIGH or NAME=WORD", text);
    std::vector<std::string>& words = ChosenWords()[name];
    words.push_back(word);
    low = high = static_cast<double>(words.size());
  }
  else
  {
    low = ToLimit(option, text.substr(equals + 1, colon - equals - 1));
    high = colon == std::string::npos ? low : ToLimit(option, text.substr(colon + 1));
    Need(low <= high, option, "the lower value first", text);
  }
  SetAll(job, &vtkSPHAlgorithm::AddOnly, name.c_str(), low, high);
}

/// Reads times and ranges of times; returns all the times, ascending, each once.
std::vector<double> ToTimes(Text option, Text text)
{
  std::set<double> times;
  for (const std::string& item : ItemsOf(text))
  {
    const std::vector<std::string> parts = ItemsOf(item, ':');
    Need(parts.size() == 1 || parts.size() == 3, option, "times, or BEGIN:END:STEP", text);
    const double begin = ToNumber(option, parts[0]);
    times.insert(begin);
    if (parts.size() == 3)
    {
      const double step = ToPositive(option, parts[2]);
      const double count = std::floor((ToNumber(option, parts[1]) - begin) / step + 1e-9);
      Need(count >= 0.0 && count < 1e6, option, "a range with 1 to 1,000,000 times", text);
      for (double i = 1.0; i <= count; ++i)
      {
        times.insert(Rounded(begin + i * step));
      }
    }
  }
  return { times.begin(), times.end() };
}

void SetPeriod(Job& job, Text option, Text text)
{
  job.DetectPeriod = text == "auto";
  job.Periodic = job.DetectPeriod ? std::vector<double>() : ToNumbers(option, text);
  const std::vector<double>& period = job.Periodic;
  Need(job.DetectPeriod || period.size() == 3 || period.size() == 6, option,
    "three lengths, or six bounds x0,x1,y0,y1,z0,z1, or auto", text);
  const std::size_t step = period.size() / 3;
  for (std::size_t a = 0; a < 3 && step > 0; ++a)
  {
    Need(period[step * a + step - 1] >= (step == 1 ? 0.0 : period[2 * a]), option,
      std::string("a period of 0 or more along ") + "xyz"[a], text);
  }
}

void SetSlice(Job& job, Text option, Text text)
{
  const std::size_t axis = std::string("xyz").find(text.substr(0, 1));
  Need(text.size() >= 3 && text[1] == '=' && axis != std::string::npos, option,
    "an axis and a position, such as z=0.1", text);
  job.Slice.Axis = static_cast<int>(axis);
  job.Slice.Place = ToNumber(option, text.substr(2));
}

std::vector<double> ToDirection(Text option, Text text)
{
  const std::vector<double> direction = ToNumbers(option, text);
  Need(direction.size() == 3 && std::count(direction.begin(), direction.end(), 0.0) < 3, option,
    "three numbers, not all 0", text);
  return direction;
}

void SetWithin(Job& job, Text option, Text text)
{
  std::vector<double> sides = ToBox(option, text);
  if (std::count(sides.begin(), sides.end(), 0.0) == 6) // six zeros would mean "no choice"
  {
    sides[0] = -std::numeric_limits<double>::denorm_min();
  }
  for (vtkSPHAlgorithm* filter : job.All())
  {
    filter->SetWithin(sides.data());
  }
}

void SetSmoothingLength(Job& job, Text option, Text text)
{
  job.SmoothingLength = ToQuantity(option, text);
  const std::size_t equals = text.find('=');
  const std::string word = text.substr(0, equals);
  const bool isWord = word == "neighbours" || word == "neighbors";
  job.NeighborRatio = !isWord     ? 0.0
    : equals == std::string::npos ? MCOR_USUAL_ETA
                                  : ToPositive(option, text.substr(equals + 1));
}

void SetSolids(Job& job, Text option, Text text)
{
  const int solids = ToChoice(option, text,
    { { "auto", Filter::SOLIDS_AUTO }, { "weight", Filter::SOLIDS_WEIGHT },
      { "ignore", Filter::SOLIDS_IGNORE }, { "wall", Filter::SOLIDS_WALL } });
  const bool ignores = solids == Filter::SOLIDS_IGNORE;
  job.Derivatives->SetIgnoreSolids(ignores);
  job.Probe->SetIgnoreSolids(ignores);
  job.Gauge->SetIgnoreSolids(ignores);
  job.Flux->SetIgnoreSolids(ignores);
  job.Projection->SetIgnoreSolids(ignores);
  job.Surface->SetSolids(solids);
}

/// Sets contour values and free-surface values (a surface uses only one kind), and the level of gauges and fluxes.
void SetIsoValues(Job& job, Text option, Text text)
{
  const std::vector<double> values = ToNumbers(option, text);
  job.Surface->SetNumberOfContours(static_cast<int>(values.size()));
  job.Surface->SetNumberOfFreeSurfaceValues(static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    job.Surface->SetValue(static_cast<int>(i), values[i]);
    job.Surface->SetFreeSurfaceValue(static_cast<int>(i), values[i]);
  }
  job.Gauge->SetLevel(values.front());
  job.Flux->SetLevel(values.front());
}

Choices ListKernels()
{
  Choices kernels;
  for (int k = 0; Filter::GetKernelName(k); ++k)
  {
    kernels.emplace_back(Filter::GetKernelName(k), k);
  }
  return kernels;
}

std::string DescribeKernels()
{
  std::vector<std::string> names;
  for (const auto& [name, number] : ListKernels())
  {
    names.push_back(name + std::string(number == 0 ? " (default)" : ""));
  }
  return Joined(names);
}

void SetProjection(Job& job, Text option, Text text)
{
  const std::size_t axis = text.size() == 1 ? std::string("xyz").find(text) : std::string::npos;
  Need(axis != std::string::npos || text.find(',') != std::string::npos, option,
    "an axis, x, y or z, or a direction X,Y,Z", text);
  const std::string axes[] = { "1,0,0", "0,1,0", "0,0,1" };
  job.Projection->SetDirection(
    ToDirection(option, axis == std::string::npos ? text : axes[axis]).data());
}

void SetBoundary(Job& job, Text option, Text text)
{
  // "weight" is an older word for "weight_sum"
  const int boundary = ToChoice(option, text == "weight" ? "weight_sum" : text,
    { { "weight_sum", Filter::WEIGHT_SUM }, { "eigenvalue", Filter::EIGENVALUE } });
  job.Surface->SetBoundaryDetection(boundary);
  if (!job.Has("--vertex-threshold"))
  {
    job.Surface->SetVertexThreshold(boundary == Filter::EIGENVALUE ? 0.3 : 0.5);
  }
}

/// An option's effect on the job `j`; `n` is its name as given, and `v` the value behind it.
#define DO(...)                                                                                    \
  []([[maybe_unused]] Job& j, [[maybe_unused]] Text n, [[maybe_unused]] Text v) { __VA_ARGS__; }

#define GROUP(title) { "", "", title },
#define OPTION(...) { __VA_ARGS__ },
const std::vector<Option> Table = {
#include "Options.def"
};
}

const std::vector<Option>& AllOptions()
{
  return Table;
}

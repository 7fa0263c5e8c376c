// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Job.h"

#include "DataFile.h"
#include "FileName.h"
#include "OptionValue.h"
#include "ParticleFile.h"
#include "Sharing.h"

#include <algorithm>
#include <cstddef>
#include <sstream>

namespace
{

/// Names what is made of the particles, for rules that hold for some of it.
enum Modes : unsigned
{
  Gauges = 1,
  Fluxes = 2,
  Probes = 4,
  Projections = 8,
  Surfaces = 16,
  Tables = Gauges | Fluxes,
  Films = Projections | Surfaces, ///< of which there may be several
  Others = Probes | Films,
  All = Tables | Others
};

Modes ModeOf(const Job& job)
{
  return job.Has("--project") ? Projections
    : job.IsFlux()            ? Fluxes
    : job.IsGauge()           ? Gauges
    : job.IsProbe()           ? Probes
                              : Surfaces;
}

/// A reason to refuse a command line before the input is looked at.
struct Rule
{
  Modes Of;
  bool (*Holds)(const Job& j);
  const char* Sentence; ///< with {mode}, {output}, {endings} and {--option}, see Filled()
  std::vector<const char*> Excluded = {}; ///< only where one of these is given, which is named
};
#define IF(...) [](const Job& j) -> bool { return __VA_ARGS__; }

bool IsAny(const Job&)
{
  return true;
}

/// Output endings, for sentences of a mode.
bool IsTo(const Job& j, const char* ending)
{
  return EndsWith(j.Output, ending);
}

const std::vector<Rule> Rules = {
  { All, IF(!j.HasTimes()), "particles are matched between steps, which only --times asks for",
    { "--ids" } },
  { All, IF(!j.Walls.empty()), "--walls tells which particles are fluid", { "--fluid" } },
  { All, IF(!j.IsFlux()), "--velocity is for --flux and --fluxes", { "--velocity" } },
  { All, IF(!j.Has("--fps")), "--slow is for --fps", { "--slow" } },
  { All, IF(j.Has("--times")), "--times says which times", { "--fps" } },
  { All, IF(!j.Has("--dp")), "--coefh is for --dp", { "--coefh" } },
  { All, IF(!j.Has("--slice") && !j.Has("--line") && !j.Has("--project")),
    "--resolution is for --slice, --line and --project", { "--resolution" } },
  { All, IF(!j.Has("--project")), "--weighted-by is for --project", { "--weighted-by" } },
  { All, IF(!j.Has("--components")), "without --components there are no pieces to remove",
    { "--least-volume", "--least-particles" } },
  { All, IF(!j.Has("--screenshot")), "without --screenshot there is no picture",
    { "--view", "--up" } },
  { All, IF(!j.Has("--screenshot") && !IsTo(j, ".ply")),
    "without --screenshot or a .ply file there are no colours", { "--color-by", "--color-range" } },

  { Tables, IsAny, "{mode} makes no surface",
    { "--scalar", "--stats", "--repeat", "--components", "--screenshot", "--probe", "--slice",
      "--line", "--box", "--widening", "--numbers" } },
  { Fluxes, IsAny, "{mode} writes a table of its own", { "--gauge", "--gauges", "--gauge-grid" } },
  { Tables, IF(j.Surface->GetNumberOfContours() > 1),
    "{mode} makes no surface; leave out all but one --iso value" },
  { Gauges, IF(j.Has("--gauge-grid")), "--gauge-grid makes its own gauges",
    { "--gauge", "--gauges" } },
  { Gauges, IF(j.Has("--gauge-grid") && !IsTo(j, ".vti")),
    "the output of {mode} is a .vti file, not '{output}'" },
  { Tables, IF(!(j.IsGauge() && j.Has("--gauge-grid")) && !IsTo(j, ".csv")),
    "the output of {mode} is a .csv file, not '{output}'" },
  { Tables, IF(!(j.Gauge->GetLevel() > 0.0)),
    "{mode} needs an --iso value above 0, the weight at which the fluid ends; 0.5 is usual" },

  { Others,
    IF(!j.IsProbe() && !j.Has("--project") && !j.Has("--color-by") && j.Has("--color-range")),
    "--color-range needs --color-by NAME" },
  { Others, IF(j.Has("--screenshot") && !EndsWith(j.Picture.File, ".png")),
    "--screenshot writes a .png file, not '{--screenshot}'" },
  { Others, IF(j.Has("--screenshot") && j.IsFilm() && !HasStepNumber(j.Picture.File)),
    "a film has a picture of each step: --screenshot frame_%04d.png, not '{--screenshot}'" },
  { Others, IF(!(j.Surface->GetWidening() > 1.0 || j.Surface->GetSmooth())),
    "without --widen there are no factors", { "--widening" } },
  { Others, IF(j.Has("--widening") && !EndsWith(j.WideningFile, ".vtp")),
    "--widening writes a .vtp file, not '{--widening}'" },
  { Others, IF(j.IsFilm()), "--widening is for one surface", { "--widening" } },
  { Others, IF(j.Has("--components")), "--components needs a surface",
    { "--probe", "--slice", "--line" } },
  { Others, IF(j.Has("--components") && !EndsWith(j.ComponentFile, ".csv")),
    "--components writes a .csv file, not '{--components}'" },
  { Others, IF(j.Has("--numbers") && !EndsWith(j.NumbersFile, ".csv")),
    "--numbers writes a .csv file, not '{--numbers}'" },
  { Others, IF(j.Has("--numbers") && !j.IsFilm()),
    "--numbers writes the table of a film, which is a .pvd file or has %04d in its name; for one "
    "surface use --stats" },
  { Others, IF(j.Has("--numbers")), "a film cannot have an image of levels", { "--gauge-grid" } },

  { Probes,
    IF(!j.IsPointTable() &&
      (j.Inputs.size() > 1 || IsListOfSteps(j.Inputs.front()) || j.HasTimes() ||
        j.TimeStep != 1.0)),
    "{mode} takes one INPUT of one time, unless it is --probe and the output is a .csv table" },
  { Probes, IsAny, "{mode} makes no surface",
    { "--scalar", "--iso", "--free-surface", "--stats", "--repeat", "--widening" } },
  { Probes, IF(j.Has("--probe")), "{mode} has points already", { "--slice", "--line" } },
  { Probes, IF(j.Has("--slice")), "{mode} has points already", { "--line" } },
  { Probes, IF(!j.Has("--probe") && j.Has("--line")), "--line makes data for a plot",
    { "--screenshot" } },
  { Probes, IF(!j.Has("--probe") && j.Has("--slice") && !IsTo(j, ".vti") && !IsTo(j, ".vtk")),
    "the output of {mode} is a .vti or .vtk file, not '{output}'" },
  { Probes, IF(!j.Has("--probe") && j.Has("--line") && !IsTo(j, ".vtp") && !IsTo(j, ".vtk")),
    "the output of {mode} is a .vtp or .vtk file, not '{output}'" },

  { Films, IF(!j.IsFilm()),
    "the output is not a film, which is a .pvd file or has %04d in its name",
    { "--times", "--fps", "--time-step" } },
  { Films, IF(j.Inputs.size() > 1 && std::any_of(j.Inputs.begin(), j.Inputs.end(), IsListOfSteps)),
    "a .pvd or .series file must be the only INPUT, because it lists the steps" },
  { Films, IF(IsListOfSteps(j.Inputs.front()) && j.TimeStep != 1.0),
    "--time-step is for a list of particle files; a .pvd or .series file has times of its own" },

  { Projections, IsAny, "{mode} makes no surface",
    { "--iso", "--free-surface", "--stats", "--repeat", "--components", "--numbers", "--probe",
      "--slice", "--line", "--gauge", "--gauges", "--gauge-grid", "--flux", "--fluxes" } },
  { Projections, IF(!IsCollectionFile(j.Output) && !IsTo(j, ".vti") && !IsTo(j, ".vtk")),
    "the output of {mode} is a .vti or .vtk file, or .pvd for a film, not '{output}'" },
  { Projections, IF(j.IsFilm() && !IsCollectionFile(j.Output) && !HasStepNumber(j.Output)),
    "the output of several steps is a .pvd file, or has %04d in its name, unlike '{output}'" },

  { Surfaces, IF(IsTo(j, ".usdc") || IsTo(j, ".usda") || IsTo(j, ".usd")),
    "'{output}' is written by Python: python -m marchingcorrectors surface INPUT... {output} "
    "[OPTIONS], or, of surfaces that this program wrote, python -m marchingcorrectors convert "
    "FILM.pvd {output}" },
  { Surfaces,
    IF(j.IsFilm() && !IsCollectionFile(j.Output) &&
      !(HasStepNumber(j.Output) && IsSurfaceFile(j.Output))),
    "the output of several steps is a .pvd file, or a {endings} file with %04d in its name, not "
    "'{output}'" },
  { Surfaces, IF(j.IsFilm() && j.Repeat > 1), "--repeat is for one surface, not for a film" },
  { Surfaces,
    IF(!j.IsFilm() && !IsSurfaceFile(j.Output) && !(LaunchedCount() > 1 && IsTo(j, ".pvtp"))),
    "the output is a {endings} file, or .pvd for a film, not '{output}'" },
  { Surfaces,
    IF(j.Surface->GetCapping() && !j.Has("--periodic") && !j.Has("--box")),
    "--capping closes the surface at the sides of a period or a box; add --periodic or --box" },
  { Surfaces, IF(j.Has("--free-surface") && j.Has("--scalar")),
    "--free-surface contours the weight sum; leave out --scalar" },
  { Surfaces, IF(!j.Has("--free-surface") && !j.Has("--scalar")),
    "needs --scalar NAME, or --free-surface" },
};
#undef IF

/// Whether an option asks for something, and does not say what holds without it.
bool IsAsked(const Job& job, const std::string& option)
{
  const auto given = job.Given.find(option);
  double value = 0.0;
  const bool isUsual = given != job.Given.end() &&
    (option == "--up" ? given->second == "y"
                      : (option == "--time-step" || option == "--repeat") &&
          ParseNumber(given->second, value) && value == 1.0);
  return given != job.Given.end() && !isUsual;
}

/// The sentence with what stands for the names in braces.
std::string Filled(std::string sentence, const Job& job)
{
  for (std::size_t at = 0; (at = sentence.find('{', at)) != std::string::npos;)
  {
    const std::size_t end = sentence.find('}', at);
    const std::string name = sentence.substr(at + 1, end - at - 1);
    const std::string text = name == "output" ? job.Output
      : name == "endings"                     ? SurfaceFileEndings()
      : name == "mode"                        ? job.Mode()
                                              : job.Given.at(name);
    sentence.replace(at, end + 1 - at, text);
    at += text.size();
  }
  return sentence;
}

/// Refuses what can be refused without looking at the input.
void Check(const Job& job)
{
  if (job.Inputs.empty())
  {
    throw UsageError("needs INPUT and OUTPUT");
  }
  for (const std::string& input : job.Inputs)
  {
    for (const char* ending :
      { ".bgeo", ".bi4", ".data", ".gro", ".gz", ".h5", ".h5part", ".hdf5", ".npy", ".npz" })
    {
      if (EndsWith(input, ending))
      {
        throw UsageError(input +
          " is read by the Python package: 'python -m marchingcorrectors convert " + input +
          " particles.vtp' (particles.pvd, if it has several steps) makes one that is read here");
      }
    }
  }
  if (job.ListArrays)
  {
    return;
  }
  for (const std::string& walls : job.Walls)
  {
    const Modes mode = ModeOf(job);
    if ((mode & Others) && !job.IsFilm() && (IsListOfSteps(walls) || HasStepNumber(walls)))
    {
      throw UsageError("--walls " + walls +
        " has walls for each step, which only films, gauges and fluxes can use; give one file");
    }
  }
  for (const Rule& rule : Rules)
  {
    const auto found = std::find_if(rule.Excluded.begin(), rule.Excluded.end(),
      [&job](const char* option) { return IsAsked(job, option); });
    const bool isNamed = found != rule.Excluded.end();
    if ((rule.Of & ModeOf(job)) && rule.Holds(job) && (rule.Excluded.empty() || isNamed))
    {
      throw UsageError(
        Filled(rule.Sentence, job) + (isNamed ? std::string("; leave out ") + *found : ""));
    }
  }
}

/// Takes an option and its value; the name, with a value behind "=" if there is one, was
/// `next[-1]`.
void TakeOption(const char* const*& next, const char* const* end, Job& job)
{
  std::string name = next[-1], value;
  const std::size_t equals = name.find('=');
  const bool isJoined = equals != std::string::npos;
  if (isJoined)
  {
    value = name.substr(equals + 1);
    name.resize(equals);
  }
  const std::vector<Option>& all = AllOptions();
  const auto find = [&all](const std::string& text)
  {
    return std::find_if(
      all.begin(), all.end(), [&text](const Option& o) { return !text.empty() && text == o.Name; });
  };
  const auto option = find(name == "-h" ? "--help" : name);
  if (option == all.end())
  {
    const bool lacksDash = find("-" + name) != all.end();
    throw UsageError("unknown option " + name + (lacksDash ? "; it is -" + name : ""));
  }
  const bool takesValue = option->Argument[0] != '\0';
  if (isJoined && !takesValue)
  {
    throw UsageError(name + " takes no value");
  }
  if (takesValue && job.Has(option->Name) && !option->Repeats)
  {
    throw UsageError(name + " is given twice");
  }
  if (takesValue && !isJoined && next < end)
  {
    // Words that begin with a dash are options, unless they are numbers, -1, -.5, -1,2, -inf, or
    // axes, -z.
    const std::string word = *next;
    const bool isOption = word == "-h" ||
      (word.size() > 2 && word[0] == '-' && word.compare(0, 4, "-inf") != 0 &&
        std::string("0123456789.").find(word[1]) == std::string::npos);
    next += isOption ? 0 : 1;
    value = isOption ? "" : word;
  }
  if (takesValue && value.empty())
  {
    throw UsageError(name + " needs " + option->Argument);
  }
  job.Given[option->Name] = value;
  option->Set(job, name, value);
}

} // namespace

std::vector<std::string> Job::InputFiles() const
{
  std::vector<std::string> files = this->Inputs;
  files.insert(files.end(), this->Walls.begin(), this->Walls.end());
  files.insert(files.end(), { this->ProbeFile, this->GaugeFile, this->FluxFile });
  for (const Place& section : this->Fluxes)
  {
    files.push_back(section.File);
  }
  return files;
}

const char* Job::Mode() const
{
  for (const char* option : { "--project", "--flux", "--fluxes", "--gauge-grid", "--gauge",
         "--gauges", "--probe", "--slice", "--line" })
  {
    if (this->Has(option))
    {
      return option;
    }
  }
  return "";
}

bool Job::IsPointTable() const
{
  return !this->ProbeFile.empty() && EndsWith(this->Output, ".csv");
}

bool Job::IsFilm() const
{
  return !this->IsProbe() && (!this->IsTable() || this->Has("--project")) &&
    (this->Inputs.size() > 1 || IsCollectionFile(this->Output) || HasStepNumber(this->Output) ||
      (!this->Inputs.empty() && IsListOfSteps(this->Inputs.front())));
}

std::string CommandLineHelp()
{
  std::ostringstream help;
  help << "usage: marching-correctors INPUT OUTPUT [options]\n"
          "       marching-correctors INPUT... OUTPUT.pvd [options]\n"
          "       marching-correctors INPUT.pvd OUTPUT.pvd [options]\n"
          "       marching-correctors INPUT... OUTPUT.csv --gauge NAME=X,Y,Z:X,Y,Z [options]\n"
          "       marching-correctors INPUT... OUTPUT.csv --flux NAME=SECTION [options]\n\n"
          "Extracts an isosurface from SPH particles. INPUT is a "
       << ParticleFileEndings() << " file,\nOUTPUT a " << SurfaceFileEndings()
       << " file. OUTPUT.pvd makes a film: one surface per step,\n"
          "OUTPUT_0000.vtp and so on, at the times of INPUT.pvd, or 0, 1, 2, ... OUTPUT_%04d.ply, "
          ".obj or\n"
          ".stl does the same without a list of the steps.\n"
          "With mpirun, processes share one surface (see the guide), and OUTPUT may be a .pvtp "
          "file.\n";
  for (const Option& option : AllOptions())
  {
    if (option.Name[0] == '\0')
    {
      help << "\n" << option.Help << ":\n";
      continue;
    }
    std::string left = std::string("  ") + option.Name + " " + option.Argument;
    left.resize(std::max<std::size_t>(left.size() + 2, 32), ' ');
    help << left << option.Help << "\n";
  }
  help
    << "\nEvery output file is either written completely or left as it was. -- ends the options.\n"
       "Exit status: 0 all outputs were written (also if the surface is empty, with a warning);\n"
       "1 the data are bad, or a file or the device failed; 2 wrong usage.\n"
       "Example: marching-correctors dam_break_45k.vtp speed.vtp --scalar Velocity --iso 1 "
       "--fluid ParticleType=0\n";
  return help.str();
}

void ParseCommandLine(int argc, char* argv[], Job& job)
{
  for (vtkSPHAlgorithm* filter : job.All())
  {
    filter->KeepDeviceDataOff(); // for one run
  }
  std::vector<std::string> files;
  const char* const* const end = argv + argc;
  bool isEnded = false; // of options
  for (const char* const* next = argv + std::min(argc, 1); next < end;)
  {
    const std::string word = *next++;
    if (!isEnded && word == "--")
    {
      isEnded = true;
    }
    else if (!isEnded && word.size() > 1 && word[0] == '-')
    {
      TakeOption(next, end, job);
    }
    else if (word.empty() || word == "-")
    {
      throw UsageError("'" + word + "' is not the name of a file");
    }
    else
    {
      files.push_back(word);
    }
  }
  if (job.ListArrays && (argc > 3 || !files.empty()))
  {
    throw UsageError("--list-arrays FILE stands alone; leave out the rest");
  }
  if (files.size() > 1)
  {
    job.Output = files.back();
    files.pop_back();
    job.Inputs = files;
  }
  if (!job.Has("--help") && !job.Has("--version") && !job.Has("--list-devices"))
  {
    Check(job);
  }
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Job.h"

#include "CollectionFile.h"
#include "FileFormat.h"
#include "OptionTable.h"
#include "OptionValue.h"
#include "ParticleFile.h"
#include "RankLaunch.h"
#include "StepName.h"
#include "SurfaceFile.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <sstream>
#include <utility>

namespace
{

/// Names the first option that was given of those that do not go here.
void Exclude(
  const std::string& sentence, std::initializer_list<std::pair<bool, const char*>> others)
{
  for (const auto& other : others)
  {
    if (other.first)
    {
      throw UsageError(sentence + other.second);
    }
  }
}

/// What gauges have no use for.
void CheckGauge(const Job& job)
{
  const bool isGrid = job.Grid.Counts[0] > 0;
  const std::string name = isGrid ? "--gauge-grid" : !job.Gauges.empty() ? "--gauge" : "--gauges";
  Exclude(name + " makes no surface; leave out ",
    { { !job.Scalar.empty(), "--scalar" },
      { job.Surface->GetNumberOfContours() > 1, "all but one --iso value" },
      { !job.StatisticsFile.empty(), "--stats" }, { job.Repeat > 1, "--repeat" },
      { !job.ComponentFile.empty(), "--components" }, { !job.Picture.File.empty(), "--screenshot" },
      { job.IsProbe(), "--probe, --slice and --line" },
      { job.Surface->GetUseBox() != 0, "--box" } });
  Exclude("gauges do not end at walls; leave out ",
    { { job.Surface->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL, "--solids wall" } });
  Exclude("--gauge-grid makes its own gauges; leave out ",
    { { isGrid && !job.Gauges.empty(), "--gauge" },
      { isGrid && !job.GaugeFile.empty(), "--gauges" } });
  if (!EndsWith(job.Output, isGrid ? ".vti" : ".csv"))
  {
    throw UsageError("the output of " + name + " is a " + (isGrid ? ".vti" : ".csv") +
      " file, not '" + job.Output + "'");
  }
  if (!(job.Gauge->GetLevel() > 0.0))
  {
    throw UsageError(
      "gauges need an --iso value above 0, the weight at which the fluid ends; 0.5 is usual");
  }
}

void CheckNumbers(const Job& job)
{
  if (job.NumbersFile.empty())
  {
    return;
  }
  if (!EndsWith(job.NumbersFile, ".csv"))
  {
    throw UsageError("--numbers writes a .csv file, not '" + job.NumbersFile + "'");
  }
  if (!job.IsFilm())
  {
    throw UsageError("--numbers writes the table of a film, which is a .pvd file or has %04d in "
                     "its name; for one surface use --stats");
  }
  Exclude("a film cannot have an image of levels; leave out ",
    { { job.Grid.Counts[0] > 0, "--gauge-grid" } });
}

void CheckComponents(const Job& job)
{
  if (job.ComponentFile.empty())
  {
    Exclude("without --components there are no pieces to remove; leave out ",
      { { job.LeastVolume > 0.0, "--least-volume" },
        { job.LeastParticles > 0, "--least-particles" } });
    return;
  }
  Exclude("--components needs a surface; leave out ",
    { { job.IsProbe(), "--probe, --slice and --line" } });
  if (!EndsWith(job.ComponentFile, ".csv"))
  {
    throw UsageError("--components writes a .csv file, not '" + job.ComponentFile + "'");
  }
}

/// What a probe has no use for.
void CheckProbe(const Job& job)
{
  const std::string name = !job.ProbeFile.empty() ? "--probe"
    : job.Slice.Axis >= 0                         ? "--slice"
                                                  : "--line";
  if (job.Inputs.size() > 1 || IsCollectionFile(job.Inputs.front()) || !job.Times.empty() ||
    job.TimeStep != 1.0)
  {
    throw UsageError(name + " takes one INPUT of one time");
  }
  Exclude(name + " makes no surface; leave out ",
    { { !job.Scalar.empty(), "--scalar" }, { job.HasIsoValues, "--iso" },
      { job.Surface->GetFreeSurface() != 0, "--free-surface" },
      { !job.StatisticsFile.empty(), "--stats" }, { job.Repeat > 1, "--repeat" } });
  Exclude(name + " has points already; leave out ",
    { { name != "--slice" && job.Slice.Axis >= 0, "--slice" },
      { name != "--line" && !job.Slice.Line.empty(), "--line" } });
  Exclude("--line makes data for a plot; leave out ",
    { { name == "--line" && !job.Picture.File.empty(), "--screenshot" } });
  if (name != "--probe" && !EndsWith(job.Output, name == "--slice" ? ".vti" : ".vtp") &&
    !EndsWith(job.Output, ".vtk"))
  {
    throw UsageError("the output of " + name + " is a " + (name == "--slice" ? ".vti" : ".vtp") +
      " or .vtk file, not '" + job.Output + "'");
  }
}

/// What the film's options are for, and what it has no use for.
void CheckFilm(const Job& job)
{
  const bool isListed = IsCollectionFile(job.Inputs.front());
  if (!job.IsFilm())
  {
    Exclude("the output is not a film, which is a .pvd file or has %04d in its name; leave out ",
      { { !job.Times.empty(), "--times" }, { job.TimeStep != 1.0, "--time-step" } });
    return;
  }
  if (!IsCollectionFile(job.Output) && !(HasStepNumber(job.Output) && IsSurfaceFile(job.Output)))
  {
    throw UsageError("the output of several steps is a .pvd file, or a " + SurfaceFileEndings() +
      " file with %04d in its name, not '" + job.Output + "'");
  }
  if (job.Inputs.size() > 1 && std::any_of(job.Inputs.begin(), job.Inputs.end(), IsCollectionFile))
  {
    throw UsageError("a .pvd file must be the only INPUT, because it lists the steps");
  }
  if (isListed && job.TimeStep != 1.0)
  {
    throw UsageError(
      "--time-step is for a list of particle files; a .pvd file has times of its own");
  }
  if (job.Repeat > 1)
  {
    throw UsageError("--repeat is for one surface, not for a film");
  }
}

void CheckPicture(const Job& job)
{
  const PictureOptions& picture = job.Picture;
  if (picture.File.empty())
  {
    Exclude("without --screenshot there is no picture; leave out ",
      { { !picture.View.empty(), "--view" }, { picture.Up != "y", "--up" } });
    const bool hasColors = EndsWith(job.Output, ".ply");
    Exclude("without --screenshot or a .ply file there are no colours; leave out ",
      { { !hasColors && !picture.ColorBy.empty(), "--color-by" },
        { !hasColors && !picture.ColorRange.empty(), "--color-range" } });
  }
  if (!job.IsProbe() && picture.ColorBy.empty() && !picture.ColorRange.empty())
  {
    throw UsageError("--color-range needs --color-by NAME");
  }
  if (picture.File.empty())
  {
    return;
  }
  if (!EndsWith(picture.File, ".png"))
  {
    throw UsageError("--screenshot writes a .png file, not '" + picture.File + "'");
  }
  if (job.IsFilm() && !HasStepNumber(picture.File))
  {
    throw UsageError(
      "a film has a picture of each step: --screenshot frame_%04d.png, not '" + picture.File + "'");
  }
}

/// What can be said without looking at the input.
void Check(const Job& job)
{
  if (job.Inputs.empty())
  {
    throw UsageError("needs INPUT and OUTPUT");
  }
  for (const std::string& input : job.Inputs)
  {
    for (const char* ending : { ".bgeo", ".bgeo.gz", ".bi4", ".h5", ".hdf5" })
    {
      if (EndsWith(input, ending))
      {
        throw UsageError(input + " is a solver's own file; 'python -m marchingcorrectors convert " +
          input + " particles.vtp' of the Python package makes one that is read here");
      }
    }
  }
  if (job.ListArrays)
  {
    return;
  }
  Exclude("particles are matched between steps, which only --times asks for; leave out ",
    { { !job.IdArray.empty() && job.Times.empty(), "--ids" } });
  Exclude("--walls tells which particles are fluid; leave out ",
    { { !job.Walls.empty() && *job.Surface->GetFluidArrayName(), "--fluid" } });
  if (job.IsGauge())
  {
    CheckGauge(job);
    return;
  }
  for (const std::string& walls : job.Walls)
  {
    if (!job.IsFilm() && (IsCollectionFile(walls) || HasStepNumber(walls)))
    {
      throw UsageError("--walls " + walls +
        " has walls for each step, which only films and gauges can use; give one file");
    }
  }
  CheckPicture(job);
  Exclude("--resolution is for --slice and --line; leave out ",
    { { job.Slice.Resolution > 0 && job.Slice.Axis < 0 && job.Slice.Line.empty(),
      "--resolution" } });
  CheckComponents(job);
  CheckNumbers(job);
  if (job.IsProbe())
  {
    CheckProbe(job);
    return;
  }
  CheckFilm(job);
  if (!job.IsFilm() && !IsSurfaceFile(job.Output) &&
    !(LaunchedCount() > 1 && EndsWith(job.Output, ".pvtp")))
  {
    throw UsageError("the output is a " + SurfaceFileEndings() +
      " file, or .pvd for a film, not '" + job.Output + "'");
  }
  if (job.Surface->GetCapping() && job.Periodic.empty() && !job.DetectPeriod &&
    !job.Surface->GetUseBox() &&
    !(job.Surface->GetFreeSurface() &&
      job.Surface->GetSolids() == vtkMarchingCorrectors::SOLIDS_WALL))
  {
    throw UsageError("--capping closes the surface at the sides of a period or a box, and the free "
                     "surface at walls; add --periodic, --box or --solids wall");
  }
  const bool isFree = job.Surface->GetFreeSurface() != 0;
  if (isFree && !job.Scalar.empty())
  {
    throw UsageError("--free-surface contours the weight sum; leave out --scalar");
  }
  if (!isFree && job.Scalar.empty())
  {
    throw UsageError("needs --scalar NAME, or --free-surface");
  }
}

const Option& FindOption(const std::string& name)
{
  const std::vector<Option>& all = AllOptions();
  const auto find = [&](const std::string& text)
  {
    return std::find_if(
      all.begin(), all.end(), [&](const Option& o) { return !text.empty() && text == o.Name; });
  };
  const auto option = find(name == "-h" ? "--help" : name);
  if (option == all.end())
  {
    const bool lacksDash = find("-" + name) != all.end();
    throw UsageError("unknown option " + name + (lacksDash ? "; it is -" + name : ""));
  }
  return *option;
}

/// Words that begin with a dash are options, unless they are numbers, -1, -.5, -1,2, or axes, -z.
bool LooksLikeOption(const std::string& word)
{
  return word == "-h" ||
    (word.size() > 2 && word[0] == '-' &&
      std::string("0123456789.").find(word[1]) == std::string::npos);
}

/// The words of a command line, taken from left to right.
class Parser
{
public:
  Parser(const std::vector<std::string>& words, Job& job)
    : Words(words)
    , Target(job)
  {
  }

  void Parse()
  {
    while (this->Next < this->Words.size())
    {
      const std::string word = this->Words[this->Next++];
      if (!this->OptionsEnded && word == "--")
      {
        this->OptionsEnded = true;
      }
      else if (!this->OptionsEnded && word.size() > 1 && word[0] == '-')
      {
        this->TakeOption(word);
      }
      else
      {
        this->TakeFile(word);
      }
    }
    if (this->Target.ListArrays && (this->Words.size() > 2 || !this->Files.empty()))
    {
      throw UsageError("--list-arrays FILE stands alone; leave out the rest");
    }
    if (this->Files.size() > 1)
    {
      this->Target.Output = this->Files.back();
      this->Files.pop_back();
      this->Target.Inputs = this->Files;
    }
  }

private:
  void TakeOption(std::string name)
  {
    std::string value;
    const std::size_t equals = name.find('=');
    const bool joined = equals != std::string::npos;
    if (joined)
    {
      value = name.substr(equals + 1);
      name.resize(equals);
    }
    const Option& option = FindOption(name);
    const bool takesValue = option.Argument[0] != '\0';
    if (joined && !takesValue)
    {
      throw UsageError(name + " takes no value");
    }
    if (takesValue && !this->Given.insert(name).second && !option.Repeats)
    {
      throw UsageError(name + " is given twice");
    }
    if (takesValue && !joined && this->Next < this->Words.size() &&
      !LooksLikeOption(this->Words[this->Next]))
    {
      value = this->Words[this->Next++];
    }
    if (takesValue && value.empty())
    {
      throw UsageError(name + " needs " + option.Argument);
    }
    option.Set(this->Target, name, value);
  }

  void TakeFile(const std::string& word)
  {
    if (word.empty() || word == "-")
    {
      throw UsageError("'" + word + "' is not the name of a file");
    }
    this->Files.push_back(word);
  }

  const std::vector<std::string> Words;
  std::size_t Next = 0;
  std::vector<std::string> Files;
  bool OptionsEnded = false;
  std::set<std::string> Given; ///< options with a value
  Job& Target;
};

} // namespace

std::vector<std::string> Job::InputFiles() const
{
  std::vector<std::string> files = this->Inputs;
  files.insert(files.end(), this->Walls.begin(), this->Walls.end());
  files.insert(files.end(), { this->ProbeFile, this->GaugeFile });
  return files;
}

bool Job::IsFilm() const
{
  return !this->IsProbe() && !this->IsGauge() &&
    (this->Inputs.size() > 1 || IsCollectionFile(this->Output) || HasStepNumber(this->Output) ||
      (!this->Inputs.empty() && IsCollectionFile(this->Inputs.front())));
}

std::string CommandLineHelp()
{
  std::ostringstream help;
  help << "usage: marching-correctors INPUT OUTPUT [options]\n"
          "       marching-correctors INPUT... OUTPUT.pvd [options]\n"
          "       marching-correctors INPUT.pvd OUTPUT.pvd [options]\n"
          "       marching-correctors INPUT... OUTPUT.csv --gauge NAME=X,Y,Z:X,Y,Z [options]\n\n"
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
  Parser(std::vector<std::string>(argv + std::min(argc, 1), argv + argc), job).Parse();
  if (!job.Help && !job.Version && !job.ListDevices)
  {
    Check(job);
  }
}

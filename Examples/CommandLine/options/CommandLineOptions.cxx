// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "CommandLineOptions.h"

#include "CollectionFile.h"
#include "OptionValue.h"
#include "ParticleFile.h"
#include "RankLaunch.h"
#include "SafeText.h"
#include "SurfaceFile.h"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

namespace
{

void SetFluid(CommandLineOptions& options, const std::string& option, const std::string& text)
{
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
  {
    throw UsageError(option + " needs NAME=VALUE, not '" + text + "'");
  }
  options.FluidArray = Printable(text.substr(0, equals));
  options.FluidValue = ToNumber(option, text.substr(equals + 1));
}

void SetComponent(CommandLineOptions& options, const std::string& option, const std::string& text)
{
  options.Magnitude = text == "magnitude" || text == "-1"; // the filter's number for it
  if (!options.Magnitude)
  {
    options.Component = ToCount(option, text, 0);
  }
}

using Options = CommandLineOptions;
using Text = const std::string&;

struct Option
{
  const char* Name;
  const char* Argument; ///< what stands for it in the help; empty: the option has none
  const char* Help;
  std::function<void(Options&, Text option, Text value)> Set;
};

/// Every option, in the order of the help. An option without a name starts a group.
const std::vector<Option>& AllOptions()
{
  static const std::vector<Option> all = {
    { "", "", "What to contour", {} },
    { "--scalar", "NAME", "point array to contour",
      [](Options& o, Text, Text v) { o.Scalar = Printable(v); } },
    { "--component", "N|magnitude", "component of a vector, from 0, or its magnitude (default)",
      SetComponent },
    { "--iso", "V[,V...]", "iso values; with --free-surface the weight sum (default 0.5)",
      [](Options& o, Text n, Text v) { o.IsoValues = ToNumbers(n, v); } },
    { "--free-surface", "", "contour the weight sum; needs no scalar",
      [](Options& o, Text, Text) { o.FreeSurface = true; } },
    { "--derive", "NAME", "add Gradients of this array; of a vector also Vorticity, Lambda2, ...",
      [](Options& o, Text, Text v) { o.Derive = Printable(v); } },
    { "--probe", "POINTS_FILE", "no surface: the field at these points; OUTPUT is their data set",
      [](Options& o, Text, Text v) { o.Probe = v; } },
    { "--field", "shepard|sum", "normalised field (default), or the plain SPH sum",
      [](Options& o, Text n, Text v) {
        o.Field = ToChoice(n, v, { "shepard", "sum" });
      } },

    { "", "", "The particles (arrays are found by their usual names if not given)", {} },
    { "--smoothing-length", "NAME|VALUE|estimate", "array, one value, or from the spacing",
      [](Options& o, Text n, Text v) { o.SmoothingLength = ToQuantity(n, v); } },
    { "--dp", "D", "particle distance of DualSPHysics: smoothing length coefh x sqrt(3) x D",
      [](Options& o, Text n, Text v) { o.ParticleDistance = ToPositive(n, v); } },
    { "--coefh", "C", "its coefficient (default 1)",
      [](Options& o, Text n, Text v) { o.CoefH = ToPositive(n, v); } },
    { "--support-radius", "", "these are the support radius, not the smoothing length",
      [](Options& o, Text, Text) { o.SupportRadius = true; } },
    { "--volume", "NAME", "array of particle volumes",
      [](Options& o, Text, Text v) { o.Volume = Printable(v); } },
    { "--mass", "NAME|VALUE", "array of particle masses, or one value",
      [](Options& o, Text n, Text v) { o.Mass = ToQuantity(n, v); } },
    { "--density", "NAME|VALUE", "array of densities, or one value",
      [](Options& o, Text n, Text v) { o.Density = ToQuantity(n, v); } },
    { "--fluid", "NAME=VALUE", "particles with this value are fluid, all others solid", SetFluid },
    { "--solids", "auto|weight|ignore|wall",
      "count in the weight that trims, not at all, or end the surface; auto (default): the last "
      "for "
      "a scalar, the first for the free surface",
      [](Options& o, Text n, Text v) {
        o.Solids = ToChoice(n, v, { "auto", "weight", "ignore", "wall" });
      } },
    { "--wall-share", "S|measured",
      "where solids end the surface: their share of the weight (default: as measured at the walls)",
      [](Options& o, Text n, Text v) { o.WallShare = ToShare(n, v); } },

    { "", "", "The method", {} },
    { "--kernel", "NAME", "cubic (default), quadratic, mprime4, quintic or wendland",
      [](Options& o, Text n, Text v) {
        o.Kernel = ToChoice(n, v, { "cubic", "quadratic", "mprime4", "quintic", "wendland" });
      } },
    { "--h-scale", "S", "the kernel uses S times the smoothing length (default 1)",
      [](Options& o, Text n, Text v) { o.HScale = ToPositive(n, v); } },
    { "--cube-factor", "C", "cube size / smallest smoothing length (default 0.5)",
      [](Options& o, Text n, Text v) { o.CubeFactor = ToPositive(n, v); } },
    { "--cube-size", "D", "cube size itself, in the unit of the positions",
      [](Options& o, Text n, Text v) { o.CubeSize = ToPositive(n, v); } },
    { "--cubes", "uniform|adaptive", "cubes alike, or as fine as the particles are (default)",
      [](Options& o, Text n, Text v) {
        o.Cubes = ToChoice(n, v, { "uniform", "adaptive" });
      } },
    { "--partition", "HOW",
      "processes of mpirun have as many particles each, or as much work (default work)",
      [](Options& o, Text n, Text v) {
        o.Partition = ToChoice(n, v, { "particles", "work" });
      } },
    { "--max-level", "N", "adaptive cubes are up to 2^N times as large, 0 to 24 (default 24)",
      [](Options& o, Text n, Text v) { o.MaxLevel = ToLevel(n, v); } },
    { "--box", "X0,X1,Y0,Y1,Z0,Z1", "only the cells in this box; a side may be inf or -inf",
      [](Options& o, Text n, Text v) { o.Box = ToBox(n, v); } },
    { "--periodic", "LX,LY,LZ|BOUNDS|auto",
      "particles repeat: lengths (0: open), x0,x1,y0,y1,z0,z1, or as field data say",
      [](Options& o, Text n, Text v)
      {
        o.DetectPeriod = v == "auto";
        o.Periodic = o.DetectPeriod ? std::vector<double>() : ToPeriod(n, v);
      } },
    { "--capping", "", "close the surface at periodic sides, around what is above the iso value",
      [](Options& o, Text, Text) { o.Capping = true; } },
    { "--seeds", "pairs|complete", "the paper's seeds, or such that nothing is missed (default)",
      [](Options& o, Text n, Text v) {
        o.Seeds = ToChoice(n, v, { "pairs", "complete" });
      } },
    { "--topology", "table|field", "ambiguous cells: by the table (default), or as the field is",
      [](Options& o, Text n, Text v) {
        o.Topology = ToChoice(n, v, { "table", "field" });
      } },
    { "--preview", "", "no correction, normals of the triangles",
      [](Options& o, Text, Text) { o.Preview = true; } },
    { "--node-threshold", "T", "discard cells with a node of lower weight (default 0.1)",
      [](Options& o, Text n, Text v) { o.NodeThreshold = ToThreshold(n, v); } },
    { "--boundary", "weight|eigenvalue", "trim by the weight (default), or by Marrone's eigenvalue",
      [](Options& o, Text n, Text v) {
        o.Boundary = ToChoice(n, v, { "weight", "eigenvalue" });
      } },
    { "--vertex-threshold", "T", "trim triangles where that is lower (default 0.5; eigenvalue 0.3)",
      [](Options& o, Text n, Text v) { o.VertexThreshold = ToThreshold(n, v); } },
    { "--precision", "single|double", "of the field evaluation on the device (default single)",
      [](Options& o, Text n, Text v) {
        o.Precision = ToChoice(n, v, { "single", "double" });
      } },

    { "", "", "Output", {} },
    { "--weight-sum", "", "add the array WeightSum",
      [](Options& o, Text, Text) { o.WeightSum = true; } },
    { "--boundary-eigenvalue", "", "add the array BoundaryEigenvalue",
      [](Options& o, Text, Text) { o.BoundaryEigenvalue = true; } },
    { "--gradients", "", "add the array Gradients",
      [](Options& o, Text, Text) { o.Gradients = true; } },
    { "--attributes", "NAME[,NAME...]", "carry only these arrays to the surface (default all)",
      [](Options& o, Text n, Text v) { o.AttributeNames = ToNames(n, v); } },
    { "--no-attributes", "", "leave out the particles' other arrays",
      [](Options& o, Text, Text) { o.Attributes = false; } },
    { "--output-precision", "single|double|input",
      "of the surface's points (default: as the input's)",
      [](Options& o, Text n, Text v) {
        o.OutputPrecision = ToChoice(n, v, { "single", "double", "input" });
      } },
    { "--times", "T[,T...]", "of a film: at these times, stored ones or between two steps",
      [](Options& o, Text n, Text v)
      {
        o.Times = ToNumbers(n, v);
        std::sort(o.Times.begin(), o.Times.end());
        o.Times.erase(std::unique(o.Times.begin(), o.Times.end()), o.Times.end());
      } },
    { "--time-step", "DT", "of a film: time from each INPUT to the next (default 1)",
      [](Options& o, Text n, Text v) { o.TimeStep = ToPositive(n, v); } },
    { "--stats", "FILE.json", "write the statistics of the run",
      [](Options& o, Text, Text v) { o.StatisticsFile = v; } },
    { "--screenshot", "FILE.png", "write a picture of the surface (may need a display)",
      [](Options& o, Text, Text v) { o.PictureFile = v; } },
    { "--repeat", "N", "run N times, statistics of each (default 1)",
      [](Options& o, Text n, Text v) { o.Repeat = ToCount(n, v, 1); } },
    { "--quiet", "", "print errors and warnings only",
      [](Options& o, Text, Text) { o.Quiet = true; } },

    { "", "", "Device and help", {} },
    { "--device", "N|SUBSTRING", "OpenCL device: number, or part of its name (see --list-devices)",
      [](Options& o, Text, Text v) { o.Device = v; } },
    { "--memory-limit", "MIB", "most device memory used (default all)",
      [](Options& o, Text n, Text v) { o.MemoryLimit = ToCount(n, v, 1); } },
    { "--list-devices", "", "list the OpenCL devices",
      [](Options& o, Text, Text) { o.ListDevices = true; } },
    { "--help", "", "print this text (also -h)", [](Options& o, Text, Text) { o.Help = true; } },
    { "--version", "", "print the version", [](Options& o, Text, Text) { o.Version = true; } },
  };
  return all;
}

bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// What a probe has no use for.
void CheckProbe(const CommandLineOptions& options)
{
  if (options.Inputs.size() > 1 || IsCollectionFile(options.Inputs.front()) ||
    !options.Times.empty() || options.TimeStep != 1.0)
  {
    throw UsageError("--probe takes one INPUT of one time");
  }
  const std::pair<bool, const char*> others[] = { { !options.Scalar.empty(), "--scalar" },
    { !options.IsoValues.empty(), "--iso" }, { options.FreeSurface, "--free-surface" },
    { !options.StatisticsFile.empty(), "--stats" },
    { !options.PictureFile.empty(), "--screenshot" }, { options.Repeat > 1, "--repeat" } };
  for (const auto& other : others)
  {
    if (other.first)
    {
      throw UsageError(std::string("--probe makes no surface; leave out ") + other.second);
    }
  }
}

/// What the film's options are for, and what it has no use for.
void CheckFilm(const CommandLineOptions& options)
{
  const bool isListed = IsCollectionFile(options.Inputs.front());
  if (!IsFilm(options))
  {
    if (!options.Times.empty() || options.TimeStep != 1.0)
    {
      throw UsageError(std::string(options.Times.empty() ? "--time-step" : "--times") +
        " is for films, whose output is a .pvd file");
    }
    return;
  }
  if (!IsCollectionFile(options.Output))
  {
    throw UsageError("the output of several steps is a .pvd file, not '" + options.Output + "'");
  }
  for (const std::string& input : options.Inputs)
  {
    if (options.Inputs.size() > 1 && IsCollectionFile(input))
    {
      throw UsageError("a .pvd file is the only input; it lists the steps");
    }
  }
  if (isListed && options.TimeStep != 1.0)
  {
    throw UsageError("--time-step is for a list of particle files; a .pvd file has times");
  }
  if (!options.PictureFile.empty() || options.Repeat > 1)
  {
    throw UsageError(std::string(options.Repeat > 1 ? "--repeat" : "--screenshot") +
      " is for one surface, not for a film");
  }
}

/// What can be said without looking at the input.
void Check(const CommandLineOptions& options)
{
  if (options.Inputs.empty())
  {
    throw UsageError("needs INPUT and OUTPUT");
  }
  if (!options.Probe.empty())
  {
    CheckProbe(options);
    return;
  }
  CheckFilm(options);
  if (!IsFilm(options) && !IsSurfaceFile(options.Output) &&
    !(LaunchedCount() > 1 && EndsWith(options.Output, ".pvtp")))
  {
    throw UsageError("the output is a " + SurfaceFileEndings() +
      " file, or .pvd for a film, not '" + options.Output + "'");
  }
  if (!options.PictureFile.empty() && !EndsWith(options.PictureFile, ".png"))
  {
    throw UsageError("--screenshot writes a .png file, not '" + options.PictureFile + "'");
  }
  if (options.Capping && options.Periodic.empty() && !options.DetectPeriod)
  {
    throw UsageError("--capping closes the surface at periodic sides; add --periodic");
  }
  if (options.FreeSurface && !options.Scalar.empty())
  {
    throw UsageError("--free-surface contours the weight sum; leave out --scalar");
  }
  if (!options.FreeSurface && options.Scalar.empty())
  {
    throw UsageError("needs --scalar NAME and --iso V, or --free-surface");
  }
  if (!options.FreeSurface && options.IsoValues.empty())
  {
    throw UsageError("--scalar needs an iso value, --iso V");
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

/// Words that begin with a dash are options, unless they are numbers: -1, -.5, -1,2.
bool LooksLikeOption(const std::string& word)
{
  return word.size() > 1 && word[0] == '-' &&
    std::string("0123456789.").find(word[1]) == std::string::npos;
}

/// The words of a command line, taken from left to right.
class Parser
{
public:
  explicit Parser(const std::vector<std::string>& words)
    : Words(words)
  {
  }

  CommandLineOptions Parse()
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
    if (this->Files.size() > 1)
    {
      this->Options.Output = this->Files.back();
      this->Files.pop_back();
      this->Options.Inputs = this->Files;
    }
    return this->Options;
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
    if (takesValue && !this->Given.insert(name).second)
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
    option.Set(this->Options, name, value);
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
  CommandLineOptions Options;
};

} // namespace

//------------------------------------------------------------------------------
bool IsFilm(const CommandLineOptions& options)
{
  return options.Probe.empty() &&
    (options.Inputs.size() > 1 || IsCollectionFile(options.Output) ||
      (!options.Inputs.empty() && IsCollectionFile(options.Inputs.front())));
}

//------------------------------------------------------------------------------
std::string CommandLineHelp()
{
  std::ostringstream help;
  help
    << "usage: marching-correctors INPUT OUTPUT [options]\n"
       "       marching-correctors INPUT... OUTPUT.pvd [options]\n"
       "       marching-correctors INPUT.pvd OUTPUT.pvd [options]\n\n"
       "Extracts an isosurface from SPH particles. INPUT is a "
    << ParticleFileEndings() << " file,\nOUTPUT a " << SurfaceFileEndings()
    << " file. With OUTPUT.pvd a film: one surface for each step,\n"
       "OUTPUT_0000.vtp and so on, at the times of INPUT.pvd, or 0, 1, 2, ...\n"
       "With mpirun, processes share a surface, see the guide; OUTPUT may be a .pvtp file then.\n";
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
  help << "\nEvery output is written completely or left as it was. -- ends the options.\n"
          "Exit status: 0 all outputs were written (of an empty surface, too, with a warning),\n"
          "1 bad data, or a problem with a file or the device, 2 wrong usage.\n"
          "Example: marching-correctors dam_break_45k.vtp speed.vtp --scalar Velocity --iso 1 "
          "--fluid ParticleType=0\n";
  return help.str();
}

//------------------------------------------------------------------------------
CommandLineOptions ParseCommandLine(int argc, char* argv[])
{
  const CommandLineOptions options =
    Parser(std::vector<std::string>(argv + std::min(argc, 1), argv + argc)).Parse();
  if (!options.Help && !options.Version && !options.ListDevices)
  {
    Check(options);
  }
  return options;
}

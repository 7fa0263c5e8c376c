// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Job.h"

#include "DataFile.h"
#include "ParticleFile.h"
#include "Sharing.h"
#include "Text.h"

#include "vtkSPHSay.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <set>
#include <sstream>

namespace
{

/// The words for a mode in sentences and in the help.
struct ModeWords
{
  Modes Mode;
  const char* Word;   ///< the word that may stand before the files
  const char* Plural; ///< its name in sentences
  const char* Needs;
};

const ModeWords AllModes[] = {
  { SURFACE, "surface", "surfaces", "one INPUT and one OUTPUT" },
  { FILM, "film", "films", "an OUTPUT.pvd, or %04d in the name of OUTPUT" },
  { GAUGE, "gauge", "gauges", "--gauge NAME=X,Y,Z:X,Y,Z" },
  { FLUX, "flux", "fluxes", "--flux NAME=SECTION" },
  { SLICE, "slice", "slices", "--slice AXIS=PLACE" },
  { LINE, "line", "lines", "--line X,Y,Z,X,Y,Z" },
  { PROBE, "probe", "probes", "--probe POINTS_FILE" },
  { PROJECT, "project", "projections", "--project AXIS" },
};

const ModeWords* FindMode(const std::string& word)
{
  const auto* found = std::find_if(std::begin(AllModes), std::end(AllModes),
    [&word](const ModeWords& mode) { return word == mode.Word; });
  return found == std::end(AllModes) ? nullptr : found;
}

/// Returns the modes as "surfaces, films and slices".
std::string PluralsOf(unsigned modes)
{
  std::vector<std::string> plurals;
  for (const ModeWords& mode : AllModes)
  {
    plurals.insert(plurals.end(), (modes & mode.Mode) ? 1 : 0, mode.Plural);
  }
  return Joined(plurals, ", ", " and ");
}

/// Two options of which only one can act.
struct Exclusion
{
  const char* First;
  const char* Second;
  const char* Why;
};

const Exclusion Exclusions[] = {
  { "--free-surface", "--scalar", "--free-surface contours the weight sum" },
  { "--smoothing-length", "--dp", "both give the smoothing length" },
  { "--support-radius", "--dp", "--dp gives the smoothing length itself" },
  { "--cube-factor", "--cube-size", "both give the size of the cubes" },
  { "--fluid", "--walls", "--walls tells which particles are fluid" },
  { "--no-attributes", "--attributes", "one asks for arrays, and one for none" },
  { "--tolerance", "--preview", "--preview corrects no vertex" },
  { "--iteration-limit", "--preview", "--preview corrects no vertex" },
  { "--fps", "--times", "--times says which times" },
  { "--gauge", "--gauge-grid", "--gauge-grid makes its own gauges" },
  { "--gauges", "--gauge-grid", "--gauge-grid makes its own gauges" },
};

/// A reason to refuse a command line before the input is looked at.
struct Rule
{
  unsigned Of;
  bool (*Holds)(const Job& j);
  const char* Sentence; ///< with {output}, {endings} and {--option}, see Check()
};
#define IF(...) [](const Job& j) -> bool { return __VA_ARGS__; }

bool IsTo(const Job& j, const char* ending)
{
  return EndsWith(j.Output, ending);
}

bool IsOfSteps(const Job& j)
{
  return IsCollectionFile(j.Output) || HasStepNumber(j.Output);
}

/// Whether there are several inputs, the input lists steps (.pvd, .series), or the output lists steps (.pvd)
/// or has the number of a step in its name (%04d).
bool HasSteps(const Job& j)
{
  return j.Inputs.size() > 1 || IsOfSteps(j) ||
    (!j.Inputs.empty() && IsListOfSteps(j.Inputs.front()));
}

/// Whether the run uses an array that --derive makes: as scalar, as weight, or as an array of the output.
bool UsesDerived(const Job& j)
{
  std::vector<std::string> asked = j.AttributeNames;
  asked.insert(asked.end(), { j.Scalar, j.Projection->GetWeightArrayName() });
  const bool areAll = (j.Mode() & (CONTOUR | POINTS)) && j.AttributeNames.empty() && !j.Has("--no-attributes");
  const std::set<std::string> made = { "Gradients", "Divergence", "Vorticity", "Q-criterion",
    "Lambda2", "StrainRate" };
  return areAll ||
    std::any_of(asked.begin(), asked.end(),
      [&made](const std::string& name) { return made.count(name) > 0; });
}

const std::vector<Rule> Rules = {
  { METER, IF(j.Surface->GetNumberOfContours() > 1),
    "gauges and fluxes have one level; leave out all but one --iso value" },
  { GAUGE, IF(j.Has("--gauge-grid") && !IsTo(j, ".vti")),
    "the output of --gauge-grid is a .vti file, not '{output}'" },
  { METER, IF(!j.Has("--gauge-grid") && !IsTo(j, ".csv")),
    "the output of gauges and fluxes is a .csv file, not '{output}'" },
  { METER, IF(!(j.Gauge->GetLevel() > 0.0)),
    "gauges and fluxes need an --iso value above 0, the weight at which the fluid ends; 0.5 is "
    "usual" },

  { CONTOUR, IF(!j.Has("--color-by") && j.Has("--color-range")),
    "--color-range needs --color-by NAME" },
  { PICTURE, IF(j.Has("--screenshot") && !EndsWith(j.Picture.File, ".png")),
    "--screenshot writes a .png file, not '{--screenshot}'" },
  { PICTURE, IF(j.Has("--screenshot") && j.IsFilm() && !HasStepNumber(j.Picture.File)),
    "a film has a picture of each step: --screenshot frame_%04d.png, not '{--screenshot}'" },
  { SURFACE, IF(j.Has("--widening") && !EndsWith(j.Text("--widening"), ".vtp")),
    "--widening writes a .vtp file, not '{--widening}'" },
  { CONTOUR, IF(j.Has("--components") && !EndsWith(j.Text("--components"), ".csv")),
    "--components writes a .csv file, not '{--components}'" },
  { FILM, IF(j.Has("--numbers") && !EndsWith(j.Text("--numbers"), ".csv")),
    "--numbers writes a .csv file, not '{--numbers}'" },

  { POINTS,
    IF(!j.IsPointTable() &&
      (j.Inputs.size() > 1 || IsListOfSteps(j.Inputs.front()) || j.HasTimes() ||
        j.Has("--time-step"))),
    "slices, lines and probes take one INPUT of one time, unless it is --probe and the output is a "
    ".csv table" },
  { SLICE, IF(!IsTo(j, ".vti") && !IsTo(j, ".vtk")),
    "the output of --slice is a .vti or .vtk file, not '{output}'" },
  { LINE, IF(!IsTo(j, ".vtp") && !IsTo(j, ".vtk")),
    "the output of --line is a .vtp or .vtk file, not '{output}'" },

  { SERIES, IF(j.Inputs.size() > 1 && std::any_of(j.Inputs.begin(), j.Inputs.end(), IsListOfSteps)),
    "a .pvd or .series file must be the only INPUT, because it lists the steps" },
  { SERIES, IF(IsListOfSteps(j.Inputs.front()) && j.Has("--time-step")),
    "--time-step is for a list of particle files; a .pvd or .series file has times of its own" },
  { PROJECT, IF(!j.IsFilm() && (j.HasTimes() || j.Has("--time-step"))),
    "--times, --fps and --time-step need a film, whose OUTPUT is a .pvd file or has %04d in its "
    "name" },
  { PROJECT, IF(j.Has("--derive") && !UsesDerived(j)),
    "--derive needs a --scalar that it makes, such as Divergence or Lambda2; give one, or leave "
    "out "
    "--derive" },
  { PROJECT, IF(!IsCollectionFile(j.Output) && !IsTo(j, ".vti") && !IsTo(j, ".vtk")),
    "the output of --project is a .vti or .vtk file, or .pvd for a film, not '{output}'" },
  { PROJECT, IF(j.IsFilm() && !IsOfSteps(j)),
    "the output of several steps is a .pvd file, or has %04d in its name, unlike '{output}'" },
  { CONTOUR, IF(IsTo(j, ".usdc") || IsTo(j, ".usda") || IsTo(j, ".usd")),
    "'{output}' is written by Python: python -m marchingcorrectors surface INPUT... {output} "
    "[OPTIONS], or, of surfaces that this program wrote, python -m marchingcorrectors convert "
    "FILM.pvd {output}" },
  { FILM, IF(!IsCollectionFile(j.Output) && !(HasStepNumber(j.Output) && IsSurfaceFile(j.Output))),
    "the output of several steps is a .pvd file, or a {endings} file with %04d in its name, not "
    "'{output}'" },
  { SURFACE, IF(!IsSurfaceFile(j.Output) && !(LaunchedCount() > 1 && IsTo(j, ".pvtp"))),
    "the output is a {endings} file, or .pvd for a film, not '{output}'" },
  { CONTOUR, IF(!j.Has("--free-surface") && !j.Has("--scalar")),
    "nothing tells what to contour; give --scalar NAME, or --free-surface" },
  { CONTOUR | POINTS, IF(j.Has("--derive") && !UsesDerived(j)),
    "what --derive makes is neither the --scalar nor among the --attributes; ask for one of its "
    "arrays, or leave out --derive" },
  { ALL, IF(LaunchedCount() > 1 && (j.Has("--screenshot") || j.Repeat > 1)),
    "several processes share a surface, a film, a probe, a projection, gauges or fluxes, but no "
    "--screenshot or --repeat; run these without mpirun" },
  { ALL,
    IF(j.Has("--support-radius") && (j.NeighborRatio > 0.0 || j.SmoothingLength == "estimate")),
    "--support-radius is for a smoothing length that is given, not for an estimate; leave out "
    "--support-radius" },
  { CONTOUR,
    IF(j.Has("--wall-share") && j.Surface->GetSolids() != vtkMarchingCorrectors::SOLIDS_WALL &&
      (j.Surface->GetSolids() != vtkMarchingCorrectors::SOLIDS_AUTO || j.Has("--free-surface"))),
    "{WALL_SHARE_IN_VAIN}" },
  { CONTOUR, IF(j.Has("--max-level") && j.Surface->GetCubeSizeMode() == j.Surface->UNIFORM),
    "--max-level is for adaptive cubes; leave out --max-level, or --cubes uniform" },
};
#undef IF

/// Returns the option of this name; nullptr if there is none.
const Option* FindOption(const std::string& name)
{
  const std::vector<Option>& all = AllOptions();
  const auto found = std::find_if(all.begin(), all.end(),
    [&name](const Option& option) { return !name.empty() && name == option.Name; });
  return found == all.end() ? nullptr : &*found;
}

/// Refuses an option that does not act in the job's mode, or that lacks what it needs: another option, or an
/// ending of the output.
void CheckOption(const Job& job, const Option& option)
{
  const std::string name = option.Name;
  const unsigned mode = job.Mode();
  const bool isForFilm = mode == SURFACE && (option.Modes & FILM);
  Need((option.Modes & mode) != 0,
    name + " is for " + PluralsOf(option.Modes) + ", not for " + PluralsOf(mode) +
      "; leave it out" + (isForFilm ? ", or make a film (OUTPUT.pvd)" : ""));
  const std::vector<std::string> needs = ItemsOf(option.Needs, '|');
  const auto isMet = [&job, mode](const std::string& need)
  {
    const Option* other = FindOption(need);
    return other ? job.Has(other->Name) || !(other->Modes & mode) : IsTo(job, need.c_str());
  };
  Need(option.Needs.empty() || std::any_of(needs.begin(), needs.end(), isMet),
    name + " needs " + Joined(needs, ", ", " or ") + "; add " + (needs.size() > 1 ? "one" : "it") +
      ", or leave out " + name);
}

/// Refuses a command line that is wrong whatever the input is.
void Check(const Job& job)
{
  Need(!job.Inputs.empty(), "INPUT or OUTPUT is missing; give both");
  for (const std::string& input : job.Inputs)
  {
    for (const char* ending :
      { ".bgeo", ".bi4", ".data", ".gro", ".gz", ".h5", ".h5part", ".hdf5", ".npy", ".npz" })
    {
      Need(!EndsWith(input, ending),
        input + " is read by the Python package: 'python -m marchingcorrectors convert " + input +
          " particles.vtp' (particles.pvd, if it has several steps) makes one that is read here");
    }
  }
  if (job.Has("--list-arrays"))
  {
    return;
  }
  const unsigned mode = job.Mode();
  const ModeWords* asked = FindMode(job.Word);
  Need(!asked || asked->Mode == mode,
    job.Word + " needs " + (asked ? asked->Needs : "") + ", but this is a command line for " +
      PluralsOf(mode));
  for (const Option& option : AllOptions())
  {
    if (job.Has(option.Name))
    {
      CheckOption(job, option);
    }
  }
  for (const Exclusion& pair : Exclusions)
  {
    Need(!job.Has(pair.First) || !job.Has(pair.Second),
      std::string(pair.First) + " and " + pair.Second + " exclude each other: " + pair.Why +
        "; leave out one of them");
  }
  for (const std::string& walls : job.Walls)
  {
    Need((mode & METER) || job.IsFilm() || !(IsListOfSteps(walls) || HasStepNumber(walls)),
      "--walls " + walls +
        " has walls for each step, which only films, gauges and fluxes can use; give one file");
  }
  for (const Rule& rule : Rules)
  {
    if ((rule.Of & mode) && rule.Holds(job))
    {
      const auto valueOf = [&job](const std::string& name)
      {
        std::string inVain = vtkSPHSay(MCOR_SAY(WALL_SHARE_IN_VAIN), "add --solids wall");
        inVain.pop_back(); // "(see --help)" follows, not a full stop
        return name == "output"          ? job.Output
          : name == "WALL_SHARE_IN_VAIN" ? inVain
          : name == "endings"            ? SurfaceFileEndings()
                                         : job.Text(name.c_str());
      };
      throw UsageError(Filled(rule.Sentence, valueOf));
    }
  }
}

/// Takes an option and its value. `next[-1]` is the name, perhaps with "=" and the value.
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
  const Option* option = FindOption(name == "-h" ? "--help" : name);
  if (!option)
  {
    std::vector<std::string> names;
    for (const Option& each : AllOptions())
    {
      names.emplace_back(each.Name);
    }
    throw UsageError("unknown option " + name + NearestOf(name, names));
  }
  const bool takesValue = option->Argument[0] != '\0';
  Need(takesValue || !isJoined, name + " takes no value");
  Need(!takesValue || !job.Has(option->Name) || option->Repeats, name + " is given twice");
  if (takesValue && !isJoined && next < end)
  {
    // Words that begin with a dash are options, unless they are numbers (-1, -.5, -1,2, -inf) or
    // axes (-z).
    const std::string word = *next;
    const bool isOption = word == "-h" ||
      (word.size() > 2 && word[0] == '-' && word.compare(0, 4, "-inf") != 0 &&
        std::string("0123456789.").find(word[1]) == std::string::npos);
    next += isOption ? 0 : 1;
    value = isOption ? "" : word;
  }
  Need(!takesValue || !value.empty(), name + " needs " + option->Argument);
  job.Given[option->Name] = value;
  option->Set(job, name, value);
}

} // namespace

std::vector<std::string> Job::InputFiles() const
{
  std::vector<std::string> files = this->Inputs;
  files.insert(files.end(), this->Walls.begin(), this->Walls.end());
  files.insert(
    files.end(), { this->Text("--probe"), this->Text("--gauges"), this->Text("--fluxes") });
  for (const Place& place : this->Places)
  {
    files.push_back(place.File);
  }
  return files;
}

unsigned Job::Mode() const
{
  const bool hasGauges = this->Has("--gauge") || this->Has("--gauges") || this->Has("--gauge-grid");
  return this->Has("--project")                                 ? PROJECT
    : this->Has("--flux") || this->Has("--fluxes")              ? FLUX
    : hasGauges && !(this->Has("--numbers") && HasSteps(*this)) ? GAUGE
    : this->Has("--probe")                                      ? PROBE
    : this->Has("--slice")                                      ? SLICE
    : this->Has("--line")                                       ? LINE
    : HasSteps(*this)                                           ? FILM
                                                                : SURFACE;
}

bool Job::IsFilm() const
{
  return (this->Mode() & (FILM | PROJECT)) && HasSteps(*this);
}

int OptionWord(void*, const char* name, const char* value, char* word, std::size_t size)
{
  const std::string member = name;
  const std::vector<Option>& all = AllOptions();
  const auto found = std::find_if(all.begin(), all.end(),
    [&member](const Option& option) { return !member.empty() && member == option.Member; });
  const bool isEstimate = member == "estimate_smoothing_length";
  const std::string option =
    isEstimate ? "--smoothing-length estimate" : found == all.end() ? "" : found->Name;
  std::snprintf(word, size, "%s%s%s%s", option.c_str(), *value ? " " : "", value,
    member == "fluid" && *value ? "=VALUE" : "");
  return !option.empty();
}

bool Job::IsPointTable() const
{
  return this->Has("--probe") && EndsWith(this->Output, ".csv");
}

std::string CommandLineHelp(const std::string& word, std::size_t width)
{
  const ModeWords* mode = FindMode(word);
  std::vector<std::string> words = { "all" };
  for (const ModeWords& each : AllModes)
  {
    words.emplace_back(each.Word);
  }
  Need(mode || word.empty() || word == "all",
    "there is no help on '" + word + "', but on " + Joined(words, ", ", " and "));
  std::ostringstream help;
  const auto add = [&help, width](std::string left, const std::string& text)
  {
    const std::size_t indent = left.empty() ? 0 : 32;
    left.resize(std::max(left.empty() ? 0 : left.size() + 2, indent), ' ');
    std::string line = left;
    for (const std::string& item : ItemsOf(text, ' '))
    {
      const bool isFirst = line.empty() || line.back() == ' ';
      if (!isFirst && line.size() + 1 + item.size() > width)
      {
        help << line << "\n";
        line = std::string(indent, ' ') + item;
        continue;
      }
      line += (isFirst ? "" : " ") + item;
    }
    help << line << "\n";
  };
  help << "usage: marching-correctors [MODE] INPUT... OUTPUT [options]\n\n";
  add("",
    "MODE is " + Joined({ words.begin() + 1, words.end() }, ", ", " or ") +
      ", and may be left out, as the options tell it. INPUT is a " + ParticleFileEndings() +
      " file, OUTPUT a " + SurfaceFileEndings() +
      " file. OUTPUT.pvd makes a film: one surface per step, OUTPUT_0000.vtp and so on, at the "
      "times of INPUT.pvd, or 0, 1, 2, ... OUTPUT_%04d.ply, .obj or .stl does the same without a "
      "list of the steps. With mpirun, processes share one surface (see the guide), and OUTPUT may "
      "be a .pvtp file.");
  if (word.empty())
  {
    help << "\nExamples:\n"
            "  marching-correctors water.vtp surface.vtp --free-surface\n"
            "  marching-correctors step_*.vtp film.pvd --free-surface --fluid Type=0 --smooth\n"
            "  marching-correctors water.vtp fast.ply --scalar Velocity --iso 1 --color-by "
            "Pressure\n"
            "  marching-correctors step_*.vtp levels.csv --gauge a=1,0,0:1,0,2 --time-step 0.01\n"
            "  marching-correctors slice water.vtp plane.vti --slice z=0.1\n"
            "\nOptions that most people need (--help all: all of them; --help slice: those that "
            "act on slices):\n";
  }
  const unsigned shown = mode ? mode->Mode : word.empty() ? USUAL : ALL;
  std::string group;
  for (const Option& option : AllOptions())
  {
    if (option.Name[0] == '\0')
    {
      group = option.Help;
    }
    else if (option.Modes & shown)
    {
      if (!group.empty() && !word.empty())
      {
        help << "\n";
        add("", group + ":");
      }
      group.clear();
      add(std::string("  ") + option.Name + (option.Argument[0] ? " " : "") + option.Argument,
        option.Help);
    }
  }
  help << "\n";
  add("",
    "Every output file is either written completely or left as it was. -- ends the options. "
    "Exit status: 0 all outputs were written (also if the surface is empty, with a warning); 1 the "
    "data are bad, or a file or the device failed; 2 wrong usage.");
  return help.str();
}

void ParseCommandLine(int argc, char* argv[], Job& job)
{
  for (vtkSPHAlgorithm* filter : job.All())
  {
    filter->KeepDeviceDataOff(); // each filter runs once
  }
  std::vector<std::string> files;
  const char* const* const end = argv + argc;
  bool isEnded = false; // whether "--" has ended the options
  for (const char* const* next = argv + std::min(argc, 1); next < end;)
  {
    const std::string word = *next++;
    if (next == argv + 2 && FindMode(word))
    {
      job.Word = word;
    }
    else if (!isEnded && word == "--")
    {
      isEnded = true;
    }
    else if (!isEnded && word.size() > 1 && word[0] == '-')
    {
      TakeOption(next, end, job);
    }
    else
    {
      Need(!word.empty() && word != "-", "'" + word + "' is not the name of a file");
      files.push_back(word);
    }
  }
  Need(!job.Has("--list-arrays") || (argc <= 3 && files.empty()),
    "--list-arrays FILE stands alone; leave out the rest");
  if (job.Has("--help"))
  {
    job.Word = files.empty() ? job.Word : files.front();
    return;
  }
  if (files.size() > 1)
  {
    job.Output = files.back();
    files.pop_back();
    job.Inputs = files;
  }
  if (!(job.Mode() & CONTOUR))
  {
    job.Surface->FreeSurfaceOn(); // --widen uses the free surface's rule
  }
  if ((job.Word == "surface" || job.Word == "film") && !job.Has("--scalar"))
  {
    job.Surface->FreeSurfaceOn(); // python -m marchingcorrectors has these words, too
    job.Given["--free-surface"];
  }
  if (!job.Has("--version") && !job.Has("--list-devices"))
  {
    Check(job);
  }
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Job_h
#define Job_h

#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkSPHDerivatives.h"
#include "vtkSPHFlux.h"
#include "vtkSPHGauge.h"
#include "vtkSPHProbe.h"
#include "vtkSPHProjection.h"

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

/// Modes, which say what a run makes of the particles, and sets of modes.
enum Modes : unsigned
{
  SURFACE = 1,
  FILM = 2, ///< a film of surfaces
  GAUGE = 4,
  FLUX = 8,
  SLICE = 16,
  LINE = 32,
  PROBE = 64,
  PROJECT = 128, ///< one image, or a film of images
  CONTOUR = SURFACE | FILM,
  METER = GAUGE | FLUX,
  SERIES = FILM | METER | PROBE | PROJECT, ///< outputs that may have several times
  POINTS = SLICE | LINE | PROBE,
  PICTURE = CONTOUR | SLICE | PROBE | PROJECT,
  ALL = CONTOUR | METER | POINTS | PROJECT,
  USUAL = 256 ///< marks an option that most people need
};

struct PictureOptions
{
  std::string File;               ///< empty: no picture; with %04d: one for each step of a film
  std::string ColorBy;            ///< an array of the data that is shown; empty: chosen
  std::vector<double> ColorRange; ///< lowest and highest value; empty: the array's range
  std::string Up;                 ///< axis, or -axis, that points upwards; empty: chosen
  std::vector<double> View;       ///< direction from the shown data to the eye; empty: chosen
};

/// Points to probe, from options, not from a file.
struct SliceOptions
{
  int Axis = -1;            ///< axis that the slice is normal to; below 0: there is no slice
  double Place = 0.0;       ///< place of the slice on that axis
  std::vector<double> Line; ///< begin and end of the line: six numbers; empty: there is no line
  int Resolution = 512;     ///< points along the longest side
};

struct Job;

/// A place to measure at: the line of a gauge, or a section that fluid flows through.
struct Place
{
  std::string Name;
  std::string File; ///< a section's triangles; empty: numbers tell the place
  std::function<void(const Job& job)> Add; ///< adds the place to the job's filter
};

/// What a command line asks for: the filters, set up as far as possible before the input is read,
/// and all other settings. Array names are spelled as ReadParticles() spells them.
struct Job
{
  Job() { this->Surface->FreeSurfaceOff(); }

  vtkNew<vtkMarchingCorrectors> Surface;
  vtkNew<vtkSPHDerivatives> Derivatives; ///< used if Derive is not empty
  vtkNew<vtkSPHProbe> Probe;             ///< used for POINTS
  vtkNew<vtkSPHGauge> Gauge;             ///< used for gauges, of films, too
  vtkNew<vtkSPHFlux> Flux;               ///< used for FLUX
  vtkNew<vtkSPHProjection> Projection;   ///< used with --project

  /// Lists all filters, for settings that several share.
  std::array<vtkSPHAlgorithm*, 6> All() const
  {
    return { this->Surface, this->Derivatives, this->Probe, this->Gauge, this->Flux,
      this->Projection };
  }
  /// Whether OUTPUT is a table of the field at a file's points, with a row for each step and point.
  bool IsPointTable() const;
  /// Lists the files to read that the command line names, without the files that are named inside
  /// them. Some names may be empty.
  std::vector<std::string> InputFiles() const;
  /// Returns one of the modes, which the options and the names of the files tell.
  unsigned Mode() const;
  /// Whether the run makes a film, of surfaces or of images.
  bool IsFilm() const;

  /// The options that were given, with the text behind each. Text() returns "" for other options.
  std::map<std::string, std::string> Given;
  bool Has(const char* option) const { return this->Given.count(option) > 0; }
  std::string Text(const char* option) const
  {
    return this->Has(option) ? this->Given.at(option) : "";
  }

  std::string Word; ///< the mode in front of the files, or behind --help; empty: none
  std::vector<std::string> Inputs;
  std::vector<std::string>
    Walls; ///< files whose particles are walls, at all times or for each step (.pvd, %04d)
  std::string Output;
  std::vector<double> Times;    ///< times of a film or table, ascending; empty: all stored times
  double FramesPerSecond = 0.0; ///< frames per second of a film; 0: not asked for
  double SlowMotion = 1.0;      ///< how many times slower a film is than the simulation
  bool HasTimes() const { return !this->Times.empty() || this->FramesPerSecond > 0.0; }
  double TimeStep = 1.0; ///< time between the steps of a film of particle files
  SliceOptions Slice;
  std::vector<Place> Places; ///< gauges, or sections
  /// The numbers of --gauge-grid, which puts upright gauges over a rectangle: how many along x and along y,
  /// then x0, x1, y0, y1, z0, z1. Empty: there is no grid. If there is a grid, no other gauges are given.
  std::vector<double> Grid;
  /// The particles get the gradient of this array, and arrays that follow from the gradient, such as the
  /// vorticity; empty: no array.
  std::string Derive;

  std::string Scalar;
  /// A quantity is an array name or one value for all particles. If the input has an array "2", the
  /// text "2" is a name, else a value.
  std::string SmoothingLength;
  std::string Mass;
  std::string Density;
  double ParticleDistance = 0.0; ///< DualSPHysics' dp; 0: not given
  double CoefH = 1.0;
  double NeighborRatio = 0.0;              ///< eta of --smoothing-length neighbours; 0: not given
  bool DetectPeriod = false;               ///< --periodic auto
  std::vector<double> Periodic;            ///< three lengths, or six bounds; empty: open
  std::vector<std::string> AttributeNames; ///< names of arrays to carry; empty: all

  double LeastVolume = 0.0; ///< least volume of a piece
  int LeastParticles = 0;   ///< least number of particles in a piece

  PictureOptions Picture;
  int Repeat = 1;
};

struct Option
{
  const char* Name;
  const char* Argument; ///< the value's name in the help; empty: the option has no value
  std::string Help;
  unsigned Modes = 0;      ///< modes in which it acts; others refuse it
  std::string Needs = "";  ///< it needs one of these options or endings of OUTPUT: "--a|--b"
  const char* Member = ""; ///< its name in the core's sentences and in Python
  std::function<void(Job&, const std::string& option, const std::string& value)> Set = {};
  bool Repeats = false; ///< whether it may be given more than once
};

/// Lists every option, in the order of the help. An option without a name starts a group.
const std::vector<Option>& AllOptions();

/// Reads NAME=x0,y0,z0:x1,y1,z1. Throws UsageError.
Place ToGauge(const std::string& option, const std::string& text);

/// Reads nx,ny:x0,x1,y0,y1,z0,z1. Throws UsageError.
std::vector<double> ToGaugeGrid(const std::string& option, const std::string& text);

/// Reads NAME=SECTION. Throws UsageError.
Place ToFlux(const std::string& option, const std::string& text);

/// Adds places to the job's filter of fluxes or of gauges: the options' places, then the places in the
/// file of --fluxes or --gauges, then the grid of gauges. Returns their number. Throws UsageError if two places
/// have one name, or a file has a wrong line or no place; std::runtime_error if a file cannot be read.
std::size_t AddPlaces(const Job& job);

/// Reads the command line into the job. Throws UsageError, see Text.h.
void ParseCommandLine(int argc, char* argv[], Job& job);

/// Returns the text of --help WORD in lines of this width. The word is empty, "all", or a mode's.
/// Throws UsageError for any other word.
std::string CommandLineHelp(const std::string& word, std::size_t width);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef CommandLineOptions_h
#define CommandLineOptions_h

#include <string>
#include <vector>

/// What the command line asks for. Lengths are in the unit of the particle positions; array names
/// are spelled as ReadParticles() spells them.
struct CommandLineOptions
{
  std::vector<std::string> Inputs;
  std::string Output;
  std::vector<double> Times; ///< of a film, ascending; empty: all that are stored
  double TimeStep = 1.0;     ///< between the steps of a film of particle files

  std::string Scalar;
  bool Magnitude = true;
  int Component = 0; ///< used where Magnitude is false
  std::vector<double> IsoValues;
  bool FreeSurface = false;
  std::string Probe;  ///< file of points where the field is evaluated instead
  std::string Derive; ///< array whose gradient, and what is made of it, the particles get

  /// A quantity is an array name or one value for all particles; the input decides which of the two
  /// a text such as "2" is.
  std::string SmoothingLength;
  bool SupportRadius = false; ///< SmoothingLength is the kernel's support radius
  std::string Volume;
  std::string Mass;
  std::string Density;
  std::string FluidArray;
  double FluidValue = 0.0;
  double ParticleDistance = 0.0; ///< of DualSPHysics; 0: not given
  double CoefH = 1.0;
  std::string Solids = "auto";
  double WallShare = 0.0; ///< 0: measured

  std::string Kernel = "cubic";
  std::string Field = "shepard";
  std::string Seeds = "complete";
  std::string Topology = "table";
  std::string Precision = "single";
  double HScale = 1.0;
  double CubeFactor = 0.5;
  double CubeSize = 0.0; ///< 0: CubeFactor times the smallest smoothing length
  std::string Cubes = "adaptive";
  int MaxLevel = 24;              ///< of adaptive cubes
  std::string Partition = "work"; ///< what processes have alike
  std::vector<double> Box;        ///< x0, x1, y0, y1, z0, z1; empty: all
  bool Capping = false;
  bool DetectPeriod = false;    ///< --periodic auto
  std::vector<double> Periodic; ///< three lengths, or bounds like those of Box; empty: open
  bool Preview = false;
  double NodeThreshold = 0.1;
  std::string Boundary = "weight";
  double VertexThreshold = -1.0; ///< below 0: what suits Boundary
  bool WeightSum = false;
  bool BoundaryEigenvalue = false;
  bool Gradients = false;
  bool Attributes = true;
  std::vector<std::string> AttributeNames; ///< of those to carry; empty: all
  std::string OutputPrecision = "input";

  std::string Device;
  int MemoryLimit = 0;
  bool ListDevices = false;
  std::string StatisticsFile;
  std::string PictureFile;
  int Repeat = 1;
  bool Quiet = false;
  bool Help = false;
  bool Version = false;
};

/// Whether there are surfaces of several times, listed in a .pvd file.
bool IsFilm(const CommandLineOptions& options);

/// Throws UsageError, see OptionValue.h.
CommandLineOptions ParseCommandLine(int argc, char* argv[]);

/// The text of --help.
std::string CommandLineHelp();

#endif

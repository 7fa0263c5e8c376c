// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef CommandLineOptions_h
#define CommandLineOptions_h

#include <stdexcept>
#include <string>
#include <vector>

/// What the command line asks for. Lengths are in the unit of the particle positions; array names
/// are spelled as ReadParticles() spells them.
struct CommandLineOptions
{
  std::string Input;
  std::string Output;

  std::string Scalar;
  bool Magnitude = true;
  int Component = 0; ///< used where Magnitude is false
  std::vector<double> IsoValues;
  bool FreeSurface = false;

  /// A quantity is an array name or one value for all particles; the input decides which of the two
  /// a text such as "2" is.
  std::string SmoothingLength;
  bool SupportRadius = false; ///< SmoothingLength is the kernel's support radius
  std::string Volume;
  std::string Mass;
  std::string Density;
  std::string FluidArray;
  double FluidValue = 0.0;
  bool IgnoreSolids = false;

  std::string Kernel = "cubic";
  std::string Field = "shepard";
  std::string Seeds = "complete";
  std::string Topology = "table";
  std::string Precision = "single";
  double HScale = 1.0;
  double CubeFactor = 0.5;
  double CubeSize = 0.0; ///< 0: CubeFactor times the smallest smoothing length
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

/// Wrong usage; what() is one sentence.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// Throws UsageError.
CommandLineOptions ParseCommandLine(int argc, char* argv[]);

/// The text of --help.
std::string CommandLineHelp();

/// True, and the value, if the whole text is one finite number.
bool ParseNumber(const std::string& text, double& value);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Each setting of the filters is a line here.
#include "Job.h"

#include "OptionValue.h"
#include "ParticleFile.h"
#include "SafeText.h"
#include "mcor.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>

namespace
{

using Filter = vtkMarchingCorrectors;
using Text = const std::string&;

/// Sets a property of all filters.
template <typename... T>
void SetAll(const Job& job, void (vtkSPHAlgorithm::*set)(T...), T... values)
{
  for (vtkSPHAlgorithm* filter : job.All())
  {
    (filter->*set)(values...);
  }
}

/// Returns where NAME=... is divided.
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
  const std::string name = Printable(text.substr(0, equals));
  double value = 0.0;
  const std::string word = text.substr(equals + 1);
  if (colon == std::string::npos && !ParseNumber(word, value) && word != "inf" && word != "-inf")
  {
    Need(!word.empty(), option, "NAME=VALUE, NAME=LOW:HIGH or NAME=WORD", text);
    std::vector<std::string>& words = ChosenWords()[name];
    words.push_back(word);
    const auto place = static_cast<double>(words.size());
    SetAll(job, &vtkSPHAlgorithm::AddOnly, name.c_str(), place, place);
    return;
  }
  const auto toLimit = [&option](const std::string& number)
  {
    const double infinity = std::numeric_limits<double>::infinity();
    return number == "inf" ? infinity : number == "-inf" ? -infinity : ToNumber(option, number);
  };
  const double low = toLimit(text.substr(equals + 1, colon - equals - 1));
  const double high = colon == std::string::npos ? low : toLimit(text.substr(colon + 1));
  Need(low <= high, option, "the lower value first", text);
  SetAll(job, &vtkSPHAlgorithm::AddOnly, name.c_str(), low, high);
}

/// Returns times and ranges of times, ascending, each once.
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
        char digits[32];
        // 3 * 0.05 must be 0.15
        std::snprintf(digits, sizeof(digits), "%.15g", begin + i * step);
        times.insert(std::strtod(digits, nullptr));
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
  if (std::count(sides.begin(), sides.end(), 0.0) == 6) // for the filters this means no choice
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

/// Sets the iso values of both modes; each is used in its mode alone.
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
  std::string text;
  for (const auto& kernel : ListKernels())
  {
    text +=
      text.empty() ? kernel.first + std::string(" (default)") : ", " + std::string(kernel.first);
  }
  return text;
}

void SetProjection(Job& job, Text option, Text text)
{
  static const std::map<std::string, std::string> axes = { { "x", "1,0,0" }, { "y", "0,1,0" },
    { "z", "0,0,1" } };
  const auto axis = axes.find(text);
  Need(axis != axes.end() || text.find(',') != std::string::npos, option,
    "an axis, x, y or z, or a direction X,Y,Z", text);
  job.Projection->SetDirection(
    ToDirection(option, axis == axes.end() ? text : axis->second).data());
}

void SetBoundary(Job& job, Text option, Text text)
{
  // its earlier word
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

const std::vector<Option> Table = {
  { "", "", "What to contour" },
  { "--scalar", "NAME", "point array to contour", CONTOUR | PROJECT | USUAL, "", "scalar",
    DO(j.Scalar = Printable(v); j.Surface->SetInputArrayToProcess(
      0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, j.Scalar.c_str());
       j.Projection->SetScalarArrayName(j.Scalar.c_str())) },
  { "--component", "N|magnitude",
    "component of a vector, counted from 0, or its magnitude (default)", CONTOUR | PROJECT,
    "--scalar", "scalar_component",
    DO(const int component = // -1 is the filters' number for this word
       v == "magnitude" || v == "-1" ? Filter::MAGNITUDE : ToCount(n, v, 0);
       j.Surface->SetScalarComponent(component); j.Projection->SetScalarComponent(component)) },
  { "--iso", "V[,V...]",
    "iso values of the scalar (default: chosen, about the median, and told), or of the weight sum "
    "with --free-surface (default 0.5)",
    CONTOUR | METER | USUAL, "", "iso_values", SetIsoValues },
  { "--free-surface", "", "contour the weight sum, which needs no scalar", CONTOUR | GAUGE | USUAL,
    "", "", DO(j.Surface->FreeSurfaceOn()) },
  { "--derive", "NAME",
    "compute Gradients of this array first; of a vector also Vorticity, Lambda2, ...",
    CONTOUR | POINTS | PROJECT, "", "",
    DO(j.Derive = Printable(v); j.Derivatives->SetInputArrayToProcess(
      0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, j.Derive.c_str())) },
  { "--field", "shepard|sum", "normalised field (default), or the plain SPH sum", CONTOUR | POINTS,
    "--scalar", "field",
    DO(const int isShepard = ToChoice(n, v, { { "shepard", 1 }, { "sum", 0 } });
       j.Surface->SetShepardNormalization(isShepard);
       j.Probe->SetShepardNormalization(isShepard)) },

  { "", "", "The field at points, in place of a surface; OUTPUT is a data set of these points" },
  { "--probe", "POINTS_FILE", "at the points in this file", PROBE, "", "", DO(j.ProbeFile = v) },
  { "--slice", "AXIS=PLACE",
    "on a plane through the particles, e.g. z=0.1; OUTPUT is an image (.vti)", SLICE | USUAL, "",
    "", SetSlice },
  { "--line", "X,Y,Z,X,Y,Z", "on a line between two points; OUTPUT is a .vtp file", LINE | USUAL,
    "", "",
    DO(const std::vector<double>& x = j.Slice.Line = ToNumbers(n, v);
       Need(x.size() == 6 && !std::equal(x.begin(), x.begin() + 3, x.begin() + 3), n,
         "two different points, X,Y,Z,X,Y,Z", v)) },
  { "--resolution", "N",
    "number of points on the line, or on the longest side of the slice or projection (default 512)",
    SLICE | LINE | PROJECT, "", "",
    DO(j.Slice.Resolution = ToCount(n, v, 2, 1 << 15);
       j.Projection->SetResolution(j.Slice.Resolution)) },

  { "", "",
    "Projection: integrals along lines of sight, in place of a surface; OUTPUT is an image (.vti), "
    "or .pvd for a film" },
  { "--project", "AXIS|X,Y,Z",
    "along x, y, z or any direction: the column density, or the integral of --scalar; --box is "
    "what is seen",
    PROJECT | USUAL, "", "", SetProjection },
  { "--weighted-by", "NAME",
    "the mean of --scalar along the line of sight, weighted by this array (that of masses: by "
    "mass)",
    PROJECT, "", "", DO(j.Projection->SetWeightArrayName(Printable(v).c_str())) },

  { "", "",
    "Gauges: where lines cross the free surface, in place of a surface; OUTPUT is a .csv table" },
  { "--gauge", "NAME=X,Y,Z:X,Y,Z", "a line from one point to another; may be given more than once",
    GAUGE | FILM | USUAL, "", "", DO(j.Gauges.push_back(ToGauge(n, v))), true },
  { "--gauges", "FILE", "all lines of this file, one NAME=X,Y,Z:X,Y,Z in each row", GAUGE | FILM,
    "", "", DO(j.GaugeFile = v) },
  { "--gauge-grid", "NX,NY:BOUNDS",
    "NX by NY vertical lines in x0,x1,y0,y1,z0,z1; OUTPUT is an image of levels (.vti)", GAUGE, "",
    "", DO(j.Grid = ToGaugeGrid(n, v)) },

  { "", "", "Fluxes: what flows through sections, in place of a surface; OUTPUT is a .csv table" },
  { "--flux", "NAME=SECTION",
    "a rectangle X,Y,Z:X,Y,Z:X,Y,Z (corner, two ends), disc:X,Y,Z:NX,NY,NZ:R, the sides of "
    "box:X0,X1,Y0,Y1,Z0,Z1, a file of triangles, or in two dimensions a line X,Y,Z:X,Y,Z; may be "
    "given more than once",
    FLUX | USUAL, "", "", DO(j.Fluxes.push_back(ToFlux(n, v))), true },
  { "--fluxes", "FILE", "all sections of this file, one NAME=SECTION in each row", FLUX, "", "",
    DO(j.FluxFile = v) },
  { "--velocity", "NAME", "array of velocities for --flux (default: found by its usual names)",
    FLUX, "", "velocity", DO(j.Flux->SetVelocityArrayName(Printable(v).c_str())) },

  { "", "", "The particles (arrays are found by their usual names unless they are given)" },
  { "--smoothing-length", "NAME|VALUE|estimate|neighbours[=ETA]",
    "an array, one value, an estimate from the particle spacing, or for each particle from its "
    "neighbours (h^3 x sum of W = ETA^3, default 1.3)",
    ALL | USUAL, "", "smoothing_length", SetSmoothingLength },
  { "--dp", "D",
    "DualSPHysics: the initial particle distance; h = coefh x sqrt(3) x D (sqrt(2) in 2-D), and "
    "volumes are D^3 (D^2) unless mass and density tell them",
    ALL | USUAL, "", "", DO(j.ParticleDistance = ToPositive(n, v)) },
  { "--coefh", "C", "DualSPHysics: the coefficient in --dp (default 1)", ALL, "--dp", "",
    DO(j.CoefH = ToPositive(n, v)) },
  { "--support-radius", "", "--smoothing-length is the support radius of the kernel", ALL, "",
    "smoothing_length_is_support_radius",
    DO(SetAll<vtkTypeBool>(j, &vtkSPHAlgorithm::SetSmoothingLengthIsSupportRadius, true)) },
  { "--volume", "NAME|computed",
    "array of particle volumes; computed: from the distances of the particles, whatever volumes and "
    "densities there are, so that drops keep their surface",
    ALL, "", "volume",
    DO(v == "computed"
        ? SetAll<vtkTypeBool>(j, &vtkSPHAlgorithm::SetComputeVolumes, true)
        : SetAll(j, &vtkSPHAlgorithm::SetVolumeArrayName, Printable(v).c_str())) },
  { "--mass", "NAME|VALUE", "array of particle masses, or one value", ALL, "", "mass",
    DO(j.Mass = ToQuantity(n, v)) },
  { "--density", "NAME|VALUE", "array of densities, or one value", ALL, "", "density",
    DO(j.Density = ToQuantity(n, v)) },
  { "--fluid", "NAME=VALUE",
    "particles with this value of this array are fluid, all others are solids (walls, bodies)",
    ALL | USUAL, "", "fluid", SetFluid },
  { "--within", "X0,X1,Y0,Y1,Z0,Z1",
    "leave out particles that are not in these bounds, whose sides may be inf or -inf", ALL, "",
    "within", SetWithin },
  { "--only", "NAME=VALUE[:VALUE]|WORD",
    "leave out particles whose value or text in this array is another one, or not in this range; "
    "may be "
    "given more than once: of several ranges of one array any counts, of several arrays all do",
    ALL, "", "", AddOnly, true },
  { "--walls", "FILE",
    "the particles of this file are walls, in addition to INPUT; may be given more than once; a "
    ".pvd "
    "file, or %04d in its name, gives each step its own",
    ALL, "", "", DO(j.Walls.push_back(v)), true },
  { "--solids", "auto|weight|ignore|wall",
    "solids only add to the weight used for trimming, are ignored, or end the surface; auto "
    "(default): wall for a scalar, weight for the free surface",
    ALL, "--fluid|--walls", "", SetSolids },
  { "--wall-share", "S|measured",
    "solids' share of the weight at which walls end the surface (default: measured)", CONTOUR,
    "--fluid|--walls", "wall_share",
    DO(const bool isMeasured = v == "measured";
       const double share = isMeasured ? -1.0 : ToNumber(n, v);
       Need(isMeasured || (share > 0.0 && share < 1.0), n,
         "a number above 0 and below 1, or 'measured'", v);
       j.Surface->SetWallShare(share)) },

  { "", "", "The method" },
  { "--kernel", "NAME", DescribeKernels(), ALL | USUAL, "", "sph_kernel",
    DO(SetAll(j, &vtkSPHAlgorithm::SetKernel, ToChoice(n, v, ListKernels()))) },
  { "--dimension", "auto|2|3",
    "2: particles lie in a plane of constant x, y or z, and lines are extracted; auto "
    "(default): 2 if they do, else 3",
    ALL, "", "dimension",
    DO(SetAll(j, &vtkSPHAlgorithm::SetDimension,
      ToChoice(n, v,
        { { "auto", Filter::DIMENSION_AUTO }, { "2", Filter::DIMENSION_2 },
          { "3", Filter::DIMENSION_3 } }))) },
  { "--h-scale", "S", "the kernel uses S times the smoothing length (default 1)", ALL, "",
    "h_scale", DO(SetAll(j, &vtkSPHAlgorithm::SetHScaleFactor, ToPositive(n, v))) },
  { "--cube-factor", "C", "cube size / smallest smoothing length (default 0.5)", CONTOUR | USUAL,
    "", "cube_size_factor", DO(j.Surface->SetCubeSizeFactor(ToPositive(n, v))) },
  { "--cube-size", "D", "cube size in the unit of the positions, in place of --cube-factor",
    CONTOUR, "", "cube_size", DO(j.Surface->SetCubeSize(ToPositive(n, v))) },
  { "--cubes", "uniform|adaptive",
    "cubes of one size, or larger ones where smoothing lengths are larger (default)", CONTOUR, "",
    "",
    DO(j.Surface->SetCubeSizeMode(
      ToChoice(n, v, { { "uniform", Filter::UNIFORM }, { "adaptive", Filter::ADAPTIVE } }))) },
  { "--max-level", "N",
    "adaptive cubes are at most 2^N times the cube size, N from 0 to 24 (default 24)", CONTOUR, "",
    "level_limit", DO(j.Surface->SetCubeLevelLimit(ToCount(n, v, 0, 24))) },
  { "--box", "X0,X1,Y0,Y1,Z0,Z1",
    "only what is in this box, whose sides may be inf or -inf: cells of the surface, points of a "
    "slice, a line or a probe, what a projection sees; around particles in a plane it may be flat",
    CONTOUR | POINTS | PROJECT | USUAL, "", "box",
    DO(j.Surface->SetBox(ToBox(n, v).data()); j.Surface->UseBoxOn();
       j.Projection->SetBox(j.Surface->GetBox()); j.Projection->UseBoxOn()) },
  { "--periodic", "LX,LY,LZ|BOUNDS|auto",
    "periodic particles: lengths (0: not periodic), bounds X0,X1,Y0,Y1,Z0,Z1, or those in the "
    "field data",
    ALL | USUAL, "", "periodic", SetPeriod },
  { "--capping", "",
    "close the surface at the sides of the period and the box, where values exceed the iso value",
    CONTOUR, "--periodic|--box", "capping", DO(j.Surface->CappingOn()) },
  { "--filled", "",
    "in two dimensions, triangles fill the region above the lowest iso value, in bands from each "
    "value to the next",
    CONTOUR, "", "filled", DO(j.Surface->FilledOn()) },
  { "--seeds", "pairs|complete",
    "seeds as in the paper, or complete seeds, which miss nothing (default)", CONTOUR, "", "seeds",
    DO(j.Surface->SetSeedMode(
      ToChoice(n, v, { { "pairs", Filter::PAIRS }, { "complete", Filter::COMPLETE } }))) },
  { "--smooth", "", "for pictures: --compact, and --widen 2 unless another value is given",
    ALL | USUAL, "", "smooth", DO(j.Surface->SmoothOn()) },
  { "--widen", "S",
    "smoother: lengthen each smoothing length by up to S (1 to 4; 2 is usual) inside the fluid",
    ALL, "", "widen",
    DO(const double widening = ToNumber(n, v);
       Need(widening >= 1.0 && widening <= 4.0, n, "a number from 1 to 4", v);
       j.Surface->SetWidening(widening)) },
  { "--widening", "FILE.vtp",
    "with --widen, write the particles with the factors of their smoothing lengths, and the "
    "products",
    SURFACE, "--widen|--smooth", "", DO(j.WideningFile = v) },
  { "--compact", "",
    "a quarter fewer triangles and hardly any slivers: merge the vertices of each grid node, then "
    "correct them",
    CONTOUR, "", "compact", DO(j.Surface->CompactOn()) },
  { "--topology", "table|field", "resolve ambiguous cells by the table (default), or by the field",
    CONTOUR, "", "topology",
    DO(j.Surface->SetTopology(ToChoice(
      n, v, { { "table", Filter::TOPOLOGY_TABLE }, { "field", Filter::TOPOLOGY_FIELD } }))) },
  { "--tolerance", "T",
    "correct vertices until the field is within T times the scalar's range of the iso value "
    "(default 1e-6)",
    CONTOUR, "", "tolerance", DO(j.Surface->SetTolerance(ToPositive(n, v))) },
  { "--iteration-limit", "N", "correct a vertex in at most N steps, from 1 to 255 (default 30)",
    CONTOUR, "", "iteration_limit", DO(j.Surface->SetIterationLimit(ToCount(n, v, 1, 255))) },
  { "--preview", "", "faster: no correction, and normals from the triangles", CONTOUR, "",
    "preview", DO(j.Surface->PreviewOn()) },
  { "--node-threshold", "T", "discard cells with a node whose weight is lower than T (default 0.1)",
    CONTOUR | POINTS, "--scalar", "node_threshold",
    DO(j.Surface->SetNodeThreshold(ToThreshold(n, v));
       j.Probe->SetWeightThreshold(ToThreshold(n, v))) },
  { "--boundary", "weight_sum|eigenvalue",
    "how the end of the fluid is found, where surfaces are trimmed (no walls are meant): by the "
    "weight sum (default), or by the boundary eigenvalue of Marrone et al.",
    CONTOUR, "--scalar", "boundary_detection", SetBoundary },
  { "--vertex-threshold", "T",
    "trim triangles where the weight (or eigenvalue) is lower than T (default 0.5, or 0.3)",
    CONTOUR, "--scalar", "vertex_threshold", DO(j.Surface->SetVertexThreshold(ToThreshold(n, v))) },
  { "--precision", "single|double",
    "precision of the field evaluation on the device (default single)", ALL, "", "precision",
    DO(SetAll(j, &vtkSPHAlgorithm::SetPrecision,
      ToChoice(n, v,
        { { "single", vtkAlgorithm::SINGLE_PRECISION },
          { "double", vtkAlgorithm::DOUBLE_PRECISION } }))) },

  { "", "", "Output" },
  { "--weight-sum", "", "add the array WeightSum", CONTOUR | POINTS, "", "",
    DO(j.Surface->ComputeWeightSumOn()) },
  { "--boundary-eigenvalue", "", "add the array BoundaryEigenvalue", CONTOUR, "", "",
    DO(j.Surface->ComputeBoundaryEigenvalueOn()) },
  { "--curvature", "", "add the arrays MeanCurvature (1 / R for a drop) and GaussCurvature",
    CONTOUR, "", "", DO(j.Surface->ComputeCurvatureOn()) },
  { "--gradients", "", "add the array Gradients", CONTOUR | POINTS, "", "",
    DO(j.Surface->ComputeGradientsOn(); j.Probe->ComputeGradientsOn()) },
  { "--attributes", "NAME[,NAME...]", "interpolate only these arrays to the surface (default all)",
    CONTOUR | POINTS, "", "",
    DO(for (Text name
            : ItemsOf(v)) {
      Need(!name.empty(), n, "names separated by commas", v);
      j.AttributeNames.push_back(Printable(name));
    }) },
  { "--no-attributes", "", "interpolate no arrays to the surface", CONTOUR | POINTS, "", "",
    DO(j.Surface->InterpolateAttributesOff(); j.Probe->InterpolateAttributesOff()) },
  { "--output-precision", "single|double|input",
    "precision of the coordinates of the surface (default: that of the input)", CONTOUR, "",
    "output_precision",
    DO(j.Surface->SetOutputPointsPrecision(ToChoice(n, v,
      { { "single", vtkAlgorithm::SINGLE_PRECISION }, { "double", vtkAlgorithm::DOUBLE_PRECISION },
        { "input", vtkAlgorithm::DEFAULT_PRECISION } }))) },
  { "--components", "TABLE.csv",
    "add the array ComponentId, and write a table of the pieces of the surface: volume, particles, "
    "...",
    CONTOUR, "", "", DO(j.ComponentFile = v) },
  { "--least-volume", "V", "with --components, remove closed pieces with less volume", CONTOUR,
    "--components", "", DO(j.LeastVolume = ToPositive(n, v)) },
  { "--least-particles", "N", "with --components, remove closed pieces around fewer particles",
    CONTOUR, "--components", "", DO(j.LeastParticles = ToCount(n, v, 1)) },
  { "--numbers", "TABLE.csv",
    "for a film: write a row for each step: area, volume, pieces, and readings of --gauge",
    FILM | USUAL, "", "", DO(j.NumbersFile = v) },
  { "--times", "T[,T...]|BEGIN:END:STEP",
    "for a film, gauges, fluxes or a table of points: at these times, which may lie between two "
    "steps",
    SERIES, "", "", DO(j.Times = ToTimes(n, v)) },
  { "--fps", "N",
    "for a film, gauges, fluxes or a table of points: N frames for each unit of time, between "
    "steps, too",
    SERIES, "", "", DO(j.FramesPerSecond = ToPositive(n, v)) },
  { "--slow", "K", "with --fps, slow motion: K times as many frames", SERIES, "--fps", "",
    DO(j.SlowMotion = ToPositive(n, v)) },
  { "--ids", "NAME",
    "with --times, array of ids that tell which particle of a step is which of the next", SERIES,
    "--times|--fps", "ids", DO(j.IdArray = Printable(v)) },
  { "--time-step", "DT",
    "for a film: time between one INPUT and the next (default: the times in their field data, "
    "else 1)",
    SERIES, "", "time_scale", DO(j.TimeStep = ToPositive(n, v)) },
  { "--stats", "FILE.json", "write the statistics of the run", CONTOUR, "", "",
    DO(j.StatisticsFile = v) },
  { "--repeat", "N", "run N times, and write the statistics of each run (default 1)", SURFACE, "",
    "", DO(j.Repeat = ToCount(n, v, 1)) },
  { "--quiet", "", "print errors and warnings only", ALL, "", "", DO(j.Quiet = true) },
  { "--verbose", "",
    "print the device, the grid, the correction and the seconds of each phase, too", SURFACE, "",
    "", DO(j.Verbose = true) },

  { "", "", "Pictures and colours" },
  { "--screenshot", "FILE.png",
    "write a picture (may need a display); for a film, frame_%04d.png writes one for each step",
    PICTURE | USUAL, "", "", DO(j.Picture.File = v) },
  { "--color-by", "NAME", "array that colours the picture and .ply files", PICTURE | USUAL,
    "--screenshot|.ply", "", DO(j.Picture.ColorBy = Printable(v)) },
  { "--color-range", "LOW,HIGH",
    "values of the first and last colour (default: the range of the array)", PICTURE,
    "--screenshot|.ply", "",
    DO(const std::vector<double>& range = j.Picture.ColorRange = ToNumbers(n, v);
       Need(range.size() == 2 && range[0] < range[1], n, "two numbers, the lower one first", v)) },
  { "--up", "x|y|z|-x|-y|-z", "axis that points upwards in the picture (default y)", PICTURE,
    "--screenshot", "",
    DO(
      ToChoice(n, v, { { "x", 0 }, { "y", 0 }, { "z", 0 }, { "-x", 0 }, { "-y", 0 }, { "-z", 0 } });
      j.Picture.Up = v) },
  { "--view", "X,Y,Z", "direction from the surface to the eye (default: from the front, above)",
    PICTURE, "--screenshot", "", DO(j.Picture.View = ToDirection(n, v)) },

  { "", "", "Device and help" },
  { "--device", "N|SUBSTRING", "OpenCL device, by number or part of its name (see --list-devices)",
    ALL, "", "device", DO(SetAll(j, &vtkSPHAlgorithm::SetDevice, v.c_str())) },
  { "--threads", "N",
    "maximum number of threads of the built-in device (default: one per processor)", ALL, "", "",
    DO(vtksys::SystemTools::PutEnv("MCOR_THREADS=" + std::to_string(ToCount(n, v, 1)))) },
  { "--memory-limit", "MIB", "use at most this much device memory (default: no limit)", ALL, "",
    "memory_limit", DO(SetAll(j, &vtkSPHAlgorithm::SetDeviceMemoryLimit, ToCount(n, v, 1))) },
  { "--list-devices", "", "list the OpenCL devices", ALL, "", "", DO() },
  { "--list-arrays", "FILE", "list the arrays of these particles, and what is found among them",
    ALL, "", "", DO(j.Inputs = { v }; j.ListArrays = true) },
  { "--help", "", "print this text (also -h); --help all, --help MODE", ALL | USUAL, "", "", DO() },
  { "--version", "", "print the version", ALL, "", "", DO() },
};
}

const std::vector<Option>& AllOptions()
{
  return Table;
}

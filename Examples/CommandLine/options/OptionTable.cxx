// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// A setting of the filters is a line here.
#include "OptionTable.h"

#include "Job.h"
#include "OptionValue.h"
#include "SafeText.h"

#include <vtksys/SystemTools.hxx>

#include <algorithm>

namespace
{

using Filter = vtkMarchingCorrectors;
using Text = const std::string&;

/// Of all filters.
template <typename T>
void SetAll(const Job& job, void (vtkSPHAlgorithm::*set)(T), T value)
{
  for (vtkSPHAlgorithm* filter : job.All())
  {
    (filter->*set)(value);
  }
}

void SetFluid(Job& job, Text option, Text text)
{
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos || equals == 0)
  {
    throw UsageError(option + " needs NAME=VALUE, not '" + text + "'");
  }
  for (vtkSPHAlgorithm* filter : job.All())
  {
    filter->SetFluidArrayName(Printable(text.substr(0, equals)).c_str());
    filter->SetFluidValue(ToNumber(option, text.substr(equals + 1)));
  }
}

void SetSolids(Job& job, Text option, Text text)
{
  const int solids = ToChoice(option, text,
    { { "auto", Filter::SOLIDS_AUTO }, { "weight", Filter::SOLIDS_WEIGHT },
      { "ignore", Filter::SOLIDS_IGNORE }, { "wall", Filter::SOLIDS_WALL } });
  job.Derivatives->SetIgnoreSolids(solids == Filter::SOLIDS_IGNORE);
  job.Probe->SetIgnoreSolids(solids == Filter::SOLIDS_IGNORE);
  job.Gauge->SetIgnoreSolids(solids == Filter::SOLIDS_IGNORE);
  job.Surface->SetSolids(solids);
}

void SetComponent(Job& job, Text option, Text text)
{
  const bool isMagnitude = text == "magnitude" || text == "-1"; // the filter's number for it
  job.Surface->SetScalarComponent(isMagnitude ? Filter::MAGNITUDE : ToCount(option, text, 0));
}

/// Either is used in its mode alone.
void SetIsoValues(Job& job, Text option, Text text)
{
  const std::vector<double> values = ToNumbers(option, text);
  job.HasIsoValues = true;
  job.Surface->SetNumberOfContours(static_cast<int>(values.size()));
  job.Surface->SetNumberOfFreeSurfaceValues(static_cast<int>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    job.Surface->SetValue(static_cast<int>(i), values[i]);
    job.Surface->SetFreeSurfaceValue(static_cast<int>(i), values[i]);
  }
  job.Gauge->SetLevel(values.front());
}

void SetKernel(Job& job, Text option, Text text)
{
  const int kernel = ToChoice(option, text,
    { { "cubic", Filter::CUBIC_SPLINE }, { "quadratic", Filter::QUADRATIC },
      { "mprime4", Filter::M_PRIME_4 }, { "quintic", Filter::QUINTIC_SPLINE },
      { "wendland", Filter::WENDLAND_C2 }, { "quartic", Filter::QUARTIC_SPLINE },
      { "wendland_c4", Filter::WENDLAND_C4 }, { "wendland_c6", Filter::WENDLAND_C6 },
      { "sinc6", Filter::SINC_6 } });
  SetAll(job, &vtkSPHAlgorithm::SetKernel, kernel);
}

void SetField(Job& job, Text option, Text text)
{
  const int isShepard = ToChoice(option, text, { { "shepard", 1 }, { "sum", 0 } });
  job.Surface->SetShepardNormalization(isShepard);
  job.Probe->SetShepardNormalization(isShepard);
}

void SetBoundary(Job& job, Text option, Text text)
{
  const int boundary = ToChoice(
    option, text, { { "weight", Filter::WEIGHT_SUM }, { "eigenvalue", Filter::EIGENVALUE } });
  job.Surface->SetBoundaryDetection(boundary);
  if (!job.HasVertexThreshold)
  {
    job.Surface->SetVertexThreshold(boundary == Filter::EIGENVALUE ? 0.3 : 0.5);
  }
}

void SetPeriod(Job& job, Text option, Text text)
{
  job.DetectPeriod = text == "auto";
  job.Periodic = job.DetectPeriod ? std::vector<double>() : ToPeriod(option, text);
}

void SetTimes(Job& job, Text option, Text text)
{
  job.Times = ToNumbers(option, text);
  std::sort(job.Times.begin(), job.Times.end());
  job.Times.erase(std::unique(job.Times.begin(), job.Times.end()), job.Times.end());
}

using Options = std::vector<Option>;

const Options WhatToContour = {
  { "", "", "What to contour", {} },
  { "--scalar", "NAME", "point array to contour",
    [](Job& j, Text, Text v)
    {
      j.Scalar = Printable(v);
      j.Surface->SetInputArrayToProcess(
        0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, j.Scalar.c_str());
    } },
  { "--component", "N|magnitude", "component of a vector, from 0, or its magnitude (default)",
    SetComponent },
  { "--iso", "V[,V...]", "iso values; with --free-surface the weight sum (default 0.5)",
    SetIsoValues },
  { "--free-surface", "", "contour the weight sum; needs no scalar",
    [](Job& j, Text, Text) { j.Surface->FreeSurfaceOn(); } },
  { "--derive", "NAME", "add Gradients of this array; for a vector, also Vorticity, Lambda2, ...",
    [](Job& j, Text, Text v)
    {
      j.Derive = Printable(v);
      j.Derivatives->SetInputArrayToProcess(
        0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, j.Derive.c_str());
    } },
  { "--field", "shepard|sum", "normalised field (default), or the plain SPH sum", SetField },

  { "", "", "The field at points instead of a surface; OUTPUT is a data set of these points", {} },
  { "--probe", "POINTS_FILE", "at the points in this file",
    [](Job& j, Text, Text v) { j.ProbeFile = v; } },
  { "--slice", "AXIS=PLACE",
    "on a plane through the particles, e.g. z=0.1; OUTPUT is an image (.vti)",
    [](Job& j, Text n, Text v) { ToSlice(n, v, j.Slice.Axis, j.Slice.Place); } },
  { "--line", "X,Y,Z,X,Y,Z", "on a line between two points; OUTPUT is a .vtp file",
    [](Job& j, Text n, Text v) { j.Slice.Line = ToLine(n, v); } },
  { "--resolution", "N",
    "number of points on the line, or on the longest side of the slice (default 512)",
    [](Job& j, Text n, Text v) { j.Slice.Resolution = ToCount(n, v, 2, 1 << 15); } },
};

const Options Gauges = {
  { "", "", "No surface, but where lines cross the free surface; OUTPUT is a .csv table", {} },
  { "--gauge", "NAME=X,Y,Z:X,Y,Z", "from one place to another; may be given more than once",
    [](Job& j, Text n, Text v) { j.Gauges.push_back(ToGauge(n, v)); }, true },
  { "--gauges", "FILE", "those of a file with such lines",
    [](Job& j, Text, Text v) { j.GaugeFile = v; } },
  { "--gauge-grid", "NX,NY:BOUNDS",
    "NX by NY upright ones from z0 to z1 in x0,x1,y0,y1,z0,z1; OUTPUT is an image of levels, .vti",
    [](Job& j, Text n, Text v) { j.Grid = ToGaugeGrid(n, v); } },
};

const Options TheParticles = {
  { "", "", "The particles (arrays not given are found by their usual names)", {} },
  { "--smoothing-length", "NAME|VALUE|estimate", "array, one value, or estimated from the spacing",
    [](Job& j, Text n, Text v) { j.SmoothingLength = ToQuantity(n, v); } },
  { "--dp", "D",
    "particle distance of DualSPHysics: smoothing length coefh x sqrt(3) x D, in two dimensions "
    "sqrt(2)",
    [](Job& j, Text n, Text v) { j.ParticleDistance = ToPositive(n, v); } },
  { "--coefh", "C", "coefficient of DualSPHysics, see --dp (default 1)",
    [](Job& j, Text n, Text v) { j.CoefH = ToPositive(n, v); } },
  { "--support-radius", "", "--smoothing-length gives support radii instead",
    [](Job& j, Text, Text)
    { SetAll<vtkTypeBool>(j, &vtkSPHAlgorithm::SetSmoothingLengthIsSupportRadius, true); } },
  { "--volume", "NAME", "array of particle volumes",
    [](Job& j, Text, Text v)
    {
      for (vtkSPHAlgorithm* filter : j.All())
      {
        filter->SetVolumeArrayName(Printable(v).c_str());
      }
    } },
  { "--mass", "NAME|VALUE", "array of particle masses, or one value",
    [](Job& j, Text n, Text v) { j.Mass = ToQuantity(n, v); } },
  { "--density", "NAME|VALUE", "array of densities, or one value",
    [](Job& j, Text n, Text v) { j.Density = ToQuantity(n, v); } },
  { "--fluid", "NAME=VALUE", "particles with this value are fluid, all others are solid",
    SetFluid },
  { "--walls", "FILE",
    "its particles are walls, beside those of INPUT; may be given more than once",
    [](Job& j, Text, Text v) { j.Walls.push_back(v); }, true },
  { "--solids", "auto|weight|ignore|wall",
    "solids count in the weight used for trimming, are ignored, or end the surface; auto "
    "(default): wall for a scalar, weight for the free surface",
    SetSolids },
  { "--wall-share", "S|measured",
    "solids' share of the weight at which walls end the surface (default: measured)",
    [](Job& j, Text n, Text v) { j.Surface->SetWallShare(ToShare(n, v)); } },
};

const Options TheMethod = {
  { "", "", "The method", {} },
  { "--kernel", "NAME",
    "cubic (default), quadratic, mprime4, quintic, wendland, quartic, wendland_c4, "
    "wendland_c6 or sinc6",
    SetKernel },
  { "--dimension", "auto|2|3",
    "2: particles in a plane of constant x, y or z, which gives lines; auto (default): if all "
    "share it",
    [](Job& j, Text n, Text v)
    {
      SetAll(j, &vtkSPHAlgorithm::SetDimension,
        ToChoice(n, v,
          { { "auto", Filter::DIMENSION_AUTO }, { "2", Filter::DIMENSION_2 },
            { "3", Filter::DIMENSION_3 } }));
    } },
  { "--h-scale", "S", "the kernel uses S times the smoothing length (default 1)",
    [](Job& j, Text n, Text v)
    { SetAll(j, &vtkSPHAlgorithm::SetHScaleFactor, ToPositive(n, v)); } },
  { "--cube-factor", "C", "cube size / smallest smoothing length (default 0.5)",
    [](Job& j, Text n, Text v) { j.Surface->SetCubeSizeFactor(ToPositive(n, v)); } },
  { "--cube-size", "D", "cube size itself, in the unit of the positions",
    [](Job& j, Text n, Text v) { j.Surface->SetCubeSize(ToPositive(n, v)); } },
  { "--cubes", "uniform|adaptive", "cubes of one size, or as fine as the particles (default)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetCubeSizeMode(
        ToChoice(n, v, { { "uniform", Filter::UNIFORM }, { "adaptive", Filter::ADAPTIVE } }));
    } },
  { "--partition", "HOW",
    "under mpirun, give each process as many particles, or as much expected work (default)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetPartition(
        ToChoice(n, v, { { "particles", Filter::BY_PARTICLES }, { "work", Filter::BY_WORK } }));
    } },
  { "--max-level", "N",
    "adaptive cubes grow up to 2^N times the cube size, N from 0 to 24 (default 24)",
    [](Job& j, Text n, Text v) { j.Surface->SetCubeLevelLimit(ToCount(n, v, 0, 24)); } },
  { "--box", "X0,X1,Y0,Y1,Z0,Z1", "only the cells in this box; a side may be inf or -inf",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetBox(ToBox(n, v).data());
      j.Surface->UseBoxOn();
    } },
  { "--periodic", "LX,LY,LZ|BOUNDS|auto",
    "periodic particles: lengths (0: not periodic), x0,x1,y0,y1,z0,z1, or from the field data",
    SetPeriod },
  { "--capping", "",
    "close the surface at the sides of the period and of the box, where values are above the iso "
    "value; the free surface at walls, too, with --solids wall",
    [](Job& j, Text, Text) { j.Surface->CappingOn(); } },
  { "--seeds", "pairs|complete",
    "seeds as in the paper, or complete ones, which miss nothing (default)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetSeedMode(
        ToChoice(n, v, { { "pairs", Filter::PAIRS }, { "complete", Filter::COMPLETE } }));
    } },
  { "--topology", "table|field", "resolve ambiguous cells by the table (default), or by the field",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetTopology(ToChoice(
        n, v, { { "table", Filter::TOPOLOGY_TABLE }, { "field", Filter::TOPOLOGY_FIELD } }));
    } },
  { "--preview", "", "faster: no correction; normals from the triangles",
    [](Job& j, Text, Text) { j.Surface->PreviewOn(); } },
  { "--node-threshold", "T", "discard cells with a node of lower weight (default 0.1)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetNodeThreshold(ToThreshold(n, v));
      j.Probe->SetWeightThreshold(ToThreshold(n, v));
    } },
  { "--boundary", "weight|eigenvalue",
    "trim by the weight (default), or by the eigenvalue of Marrone et al.", SetBoundary },
  { "--vertex-threshold", "T",
    "trim triangles where it is lower than T (default 0.5; eigenvalue 0.3)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetVertexThreshold(ToThreshold(n, v));
      j.HasVertexThreshold = true;
    } },
  { "--precision", "single|double",
    "precision of the field evaluation on the device (default single)",
    [](Job& j, Text n, Text v)
    {
      SetAll(j, &vtkSPHAlgorithm::SetPrecision,
        ToChoice(n, v,
          { { "single", vtkAlgorithm::SINGLE_PRECISION },
            { "double", vtkAlgorithm::DOUBLE_PRECISION } }));
    } },
};

const Options Output = {
  { "", "", "Output", {} },
  { "--weight-sum", "", "add the array WeightSum",
    [](Job& j, Text, Text) { j.Surface->ComputeWeightSumOn(); } },
  { "--boundary-eigenvalue", "", "add the array BoundaryEigenvalue",
    [](Job& j, Text, Text) { j.Surface->ComputeBoundaryEigenvalueOn(); } },
  { "--gradients", "", "add the array Gradients",
    [](Job& j, Text, Text)
    {
      j.Surface->ComputeGradientsOn();
      j.Probe->ComputeGradientsOn();
    } },
  { "--attributes", "NAME[,NAME...]", "interpolate only these arrays to the surface (default all)",
    [](Job& j, Text n, Text v) { j.AttributeNames = ToNames(n, v); } },
  { "--no-attributes", "", "interpolate no other arrays",
    [](Job& j, Text, Text)
    {
      j.Surface->InterpolateAttributesOff();
      j.Probe->InterpolateAttributesOff();
    } },
  { "--output-precision", "single|double|input",
    "precision of the surface's points (default: that of the input)",
    [](Job& j, Text n, Text v)
    {
      j.Surface->SetOutputPointsPrecision(ToChoice(n, v,
        { { "single", vtkAlgorithm::SINGLE_PRECISION },
          { "double", vtkAlgorithm::DOUBLE_PRECISION },
          { "input", vtkAlgorithm::DEFAULT_PRECISION } }));
    } },
  { "--components", "TABLE.csv",
    "add the array ComponentId, and write a table of the surface's pieces: volumes, particles, ...",
    [](Job& j, Text, Text v) { j.ComponentFile = v; } },
  { "--least-volume", "V", "leave out closed pieces of a smaller volume (with --components)",
    [](Job& j, Text n, Text v) { j.LeastVolume = ToPositive(n, v); } },
  { "--least-particles", "N", "leave out closed pieces around fewer particles (with --components)",
    [](Job& j, Text n, Text v) { j.LeastParticles = ToCount(n, v, 1); } },
  { "--numbers", "TABLE.csv",
    "for a film: a row for each step, with area, volume, pieces and what --gauge reads",
    [](Job& j, Text, Text v) { j.NumbersFile = v; } },
  { "--times", "T[,T...]", "for a film or gauges: at these times, stored or between two steps",
    SetTimes },
  { "--time-step", "DT", "for a film: time between one INPUT and the next (default 1)",
    [](Job& j, Text n, Text v) { j.TimeStep = ToPositive(n, v); } },
  { "--stats", "FILE.json", "write the statistics of the run",
    [](Job& j, Text, Text v) { j.StatisticsFile = v; } },
  { "--repeat", "N", "run N times, with statistics of each run (default 1)",
    [](Job& j, Text n, Text v) { j.Repeat = ToCount(n, v, 1); } },
  { "--quiet", "", "print errors and warnings only", [](Job& j, Text, Text) { j.Quiet = true; } },

  { "", "", "Pictures and colours", {} },
  { "--screenshot", "FILE.png",
    "write a picture (may need a display); for a film, frame_%04d.png writes one for each step",
    [](Job& j, Text, Text v) { j.Picture.File = v; } },
  { "--color-by", "NAME", "array that colours the picture and .ply files",
    [](Job& j, Text, Text v) { j.Picture.ColorBy = Printable(v); } },
  { "--color-range", "LOW,HIGH",
    "values of the first and last colour (default: the range of the array)",
    [](Job& j, Text n, Text v) { j.Picture.ColorRange = ToRange(n, v); } },
  { "--up", "x|y|z|-x|-y|-z", "axis that points upwards in the picture (default y)",
    [](Job& j, Text n, Text v)
    {
      ToChoice(n, v, { { "x", 0 }, { "y", 0 }, { "z", 0 }, { "-x", 0 }, { "-y", 0 }, { "-z", 0 } });
      j.Picture.Up = v;
    } },
  { "--view", "X,Y,Z", "direction from the surface to the eye (default: from the front, above)",
    [](Job& j, Text n, Text v) { j.Picture.View = ToDirection(n, v); } },
};

const Options DeviceAndHelp = {
  { "", "", "Device and help", {} },
  { "--device", "N|SUBSTRING", "OpenCL device, by number or part of its name (see --list-devices)",
    [](Job& j, Text, Text v)
    {
      for (vtkSPHAlgorithm* filter : j.All())
      {
        filter->SetDevice(v.c_str());
      }
    } },
  { "--threads", "N", "most threads of the built-in device (default: one for each processor)",
    [](Job&, Text n, Text v)
    { vtksys::SystemTools::PutEnv("MCOR_THREADS=" + std::to_string(ToCount(n, v, 1))); } },
  { "--memory-limit", "MIB", "use at most this much device memory (default: no limit)",
    [](Job& j, Text n, Text v)
    { SetAll(j, &vtkSPHAlgorithm::SetDeviceMemoryLimit, ToCount(n, v, 1)); } },
  { "--list-devices", "", "list the OpenCL devices",
    [](Job& j, Text, Text) { j.ListDevices = true; } },
  { "--help", "", "print this text (also -h)", [](Job& j, Text, Text) { j.Help = true; } },
  { "--version", "", "print the version", [](Job& j, Text, Text) { j.Version = true; } },
};

}

//------------------------------------------------------------------------------
const std::vector<Option>& AllOptions()
{
  static const Options all = []
  {
    Options joined;
    for (const Options* group :
      { &WhatToContour, &Gauges, &TheParticles, &TheMethod, &Output, &DeviceAndHelp })
    {
      joined.insert(joined.end(), group->begin(), group->end());
    }
    return joined;
  }();
  return all;
}

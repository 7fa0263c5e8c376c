// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectors.h"

#include "mcor_parts.h"
#include "vtkCommand.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMarchingCorrectorsOutput.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"
#include "vtkSPHSay.h"
#if MCOR_HAS_RANKS
#include "vtkSPHSharedRun.h"
#endif

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
static_assert(static_cast<int>(vtkMarchingCorrectors::MAGNITUDE) == MCOR_MAGNITUDE,
  "the filter's numbers are the core's");

vtkStandardNewMacro(vtkMarchingCorrectors);

vtkMarchingCorrectors::vtkMarchingCorrectors()
{
  this->ContourValues->SetNumberOfContours(0);
  this->FreeSurfaceValues->SetValue(0, 0.5);
  for (vtkContourValues* values : { this->ContourValues.Get(), this->FreeSurfaceValues.Get() })
  {
    values->AddObserver(vtkCommand::ModifiedEvent, this, &vtkObject::Modified);
  }
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
}

void vtkMarchingCorrectors::SetFreeSurfaceValue(double value)
{
  this->FreeSurfaceValues->SetNumberOfContours(1);
  this->FreeSurfaceValues->SetValue(0, value);
}

void vtkMarchingCorrectors::SetSolids(int solids)
{
  const int legal = std::min(std::max<int>(solids, SOLIDS_WEIGHT), static_cast<int>(SOLIDS_AUTO));
  if (legal != this->Solids)
  {
    this->Solids = legal;
    this->IgnoreSolids = legal == SOLIDS_IGNORE;
    this->Modified();
  }
}

void vtkMarchingCorrectors::FillOptions(mcor_options& options)
{
  this->Superclass::FillOptions(options);
  options.field = this->DrawsFreeSurface ? MCOR_WEIGHT_SUM
    : this->ShepardNormalization         ? MCOR_SHEPARD
                                         : MCOR_SUM;
  options.seeds = this->SeedMode == PAIRS && !this->DrawsFreeSurface ? MCOR_PAIRS : MCOR_COMPLETE;
  options.topology = this->Topology == TOPOLOGY_FIELD ? MCOR_TOPOLOGY_FIELD : MCOR_TOPOLOGY_TABLE;
  options.cube_size_factor = this->CubeSizeFactor;
  options.cube_size = this->CubeSize;
  options.level_limit = this->CubeSizeMode == ADAPTIVE ? this->CubeLevelLimit : 0;
  if (this->UseBox)
  {
    std::copy(this->Box, this->Box + 6, options.box);
    // The core takes a box of zeros as no box. Here the user wants a box but has set zeros, so a
    // tiny number makes the core refuse the box.
    options.box[0] -= mcor_has_box(&options) ? 0.0 : std::numeric_limits<double>::denorm_min();
  }
  options.filled = this->Filled;
  options.capping = !this->Capping ? MCOR_CAP_NONE : this->UseBox ? MCOR_CAP_BOX : MCOR_CAP_PERIOD;
  options.compact = this->Compact;
  options.smooth = this->Smooth;
  options.widen = this->Widening;
  mcor_spell_out(&options);
  options.node_threshold = this->NodeThreshold;
  options.boundary_detection = this->Trim && this->BoundaryDetection == EIGENVALUE
    ? MCOR_BOUNDARY_EIGENVALUE
    : MCOR_BOUNDARY_WEIGHT_SUM;
  options.vertex_threshold = this->Trim ? this->VertexThreshold : 0.0;
  const bool endsAtSolids =
    this->Solids == SOLIDS_WALL || (this->Solids == SOLIDS_AUTO && !this->DrawsFreeSurface);
  options.wall_share =
    endsAtSolids && (this->Trim || this->DrawsFreeSurface) ? this->WallShare : 0.0;
  options.preview = this->Preview;
  options.tolerance = this->Tolerance;
  options.iteration_limit = this->IterationLimit;
  options.outputs = this->ComputeScalars ? MCOR_OUT_ISO_VALUE : 0;
#define WANT(bit, member, components, name, flag) options.outputs |= this->flag ? bit : 0;
  vtkMarchingCorrectorsArrays(WANT)
#undef WANT
}

std::unique_ptr<vtkSPHParticles> vtkMarchingCorrectors::MakeInput(
  vtkRun& run, const mcor_options& options, unsigned wants)
{
  vtkSPHWanted wanted;
  if (!this->DrawsFreeSurface) // a free surface contours no array, so not all values need be read
  {
    wanted.Scalar = this->FindRequest(0, run.Own);
    wanted.ScalarDot = this->FindRequest(1, run.Own);
  }
  const vtkSPHParticlesChoice choice =
    run.Choose(this->DrawsFreeSurface ? nullptr : &wanted.Scalar);
  wanted.Wants = wants;
  wanted.ScalarComponent = this->ScalarComponent;
  wanted.Taken = vtkMarchingCorrectorsOutput::ComputedArrays(options);
  wanted.FreeSurface = this->DrawsFreeSurface;
  wanted.HasIsoValues = this->ComputeScalars != 0;
  wanted.Filled = this->Filled != 0;
  return std::make_unique<vtkSPHParticles>(choice, run.Own, wanted);
}

// If the user chose neither a scalar, an iso value nor the free surface, the particles decide
// whether the free surface is drawn.
void vtkMarchingCorrectors::ChooseMode(vtkRun& run)
{
  const double* values = this->ContourValues->GetValues();
  this->DrawsFreeSurface = this->FreeSurface > 0;
  if (this->FreeSurface != FREE_SURFACE_AUTO || !this->FindRequest(0, run.Own).Name.empty() ||
    !std::all_of(values, values + this->ContourValues->GetNumberOfContours(),
      [](double value) { return std::isnan(value); }))
  {
    return;
  }
  vtkSPHParticles particles(run.Choose(), run.Own);
  particles.Collect();
  this->DrawsFreeSurface =
    run.Ask([&](const mcor_ranks* ranks) { return particles.HasFreeSurface(ranks); });
}

void vtkMarchingCorrectors::Process(vtkDataObject* data, vtkDataObject* output)
{
  std::fill_n(this->FluidScalarRange, 2, 0.0);
  this->UsedIsoValues.clear();
  this->IsoValueArrayName.clear();
  this->UsedSmoothingLength.clear();
  this->UsedCubeSize = 0.0;
  this->SurfaceMeasures.clear();
  this->EstimatedCells = 0.0;
  auto* particles = vtkPointSet::SafeDownCast(data);
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  if (data && !particles && !run->IsShared())
  {
    this->Warn(vtkSPHSay(MCOR_SAY(NO_POINTS), data->GetClassName(), "surface"));
    return;
  }
  if (!run->Begin(particles) || run->Particles == 0)
  {
    this->SetUsedNames(nullptr);
    return;
  }
  this->ChooseMode(*run);
  this->FillOptions(run->Options);
  const unsigned attributes = this->InterpolateAttributes ? MCOR_WANT_ATTRIBUTES : 0;
  const auto input =
    this->MakeInput(*run, run->Options, MCOR_WANT_SIZES | MCOR_WANT_SCALAR | attributes);
  if (!this->Take(*run, *input))
  {
    return;
  }
#if MCOR_HAS_RANKS
  if (run->IsShared())
  {
    this->ContourDistributed(
      static_cast<vtkSharedRun&>(*run), *input, vtkPolyData::SafeDownCast(output));
    return;
  }
#endif
  this->Extract(*run, *input, vtkPolyData::SafeDownCast(output));
}

// Returns whether there are fluid particles and all needed arrays. Sets the run's iso values: those
// that the user gave, without NaN (an empty row of the panel's list), else one usual value.
bool vtkMarchingCorrectors::Take(vtkRun& run, vtkSPHParticles& input)
{
  if (!run.Accept(input, "no surface") || !run.HasFluid ||
    !(run.IsShared() || run.Measure(input, false)))
  {
    this->SetUsedNames(&input, false); // no volumes were used
    return false;
  }
  const bool isFree = input.Wanted.FreeSurface;
  vtkContourValues* values = isFree ? this->FreeSurfaceValues : this->ContourValues;
  std::vector<double>& list = run.IsoValues;
  std::copy_if(values->GetValues(), values->GetValues() + values->GetNumberOfContours(),
    std::back_inserter(list), [](double value) { return !std::isnan(value); });
  run.CallAside(
    [&](const mcor_ranks* ranks)
    {
      double range[2], value = 0.5;
      if (list.empty() && (isFree || mcor_find_iso_value(&input.Core, ranks, range, &value)))
      {
        list.push_back(value);
      }
      return !list.empty();
    });
  run.Options.iso_values = list.data();
  run.Options.iso_count = static_cast<int>(list.size());
  return true;
}

bool vtkMarchingCorrectors::Widen(vtkPointSet* particles, vtkPolyData* output)
{
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  if (!run->Begin(particles))
  {
    return false;
  }
  this->ChooseMode(*run);
  this->FillOptions(run->Options);
  const auto input = this->MakeInput(*run, run->Options, MCOR_WANT_SIZES | MCOR_WANT_SCALAR);
  vtkNew<vtkPointData> found;
  mcor_statistics statistics = {};
  if (!this->Take(*run, *input) || !this->FindWidening(*run, *input, found, statistics))
  {
    return false;
  }
  const mcor_input& core = input->Core;
  vtkDataArray* const factors = found->GetArray("Widening");
  const double unit = core.smoothing_length_is_support_radius && !core.estimate_smoothing_length
    ? 1.0 / mcor_support_factor(run->Options.sph_kernel)
    : 1.0;
  vtkNew<vtkDoubleArray> lengths;
  lengths->SetNumberOfValues(factors->GetNumberOfTuples());
  for (vtkIdType i = 0; i < lengths->GetNumberOfValues(); ++i)
  {
    const double length = core.estimate_smoothing_length
      ? statistics.smoothing_length_min
      : vtkSPHValueOf(core.smoothing_length, i) * unit;
    lengths->SetValue(i, length * factors->GetComponent(i, 0));
  }
  output->Initialize();
  output->SetPoints(run->Own->GetPoints());
  output->GetPointData()->ShallowCopy(run->Own->GetPointData());
  output->GetFieldData()->ShallowCopy(run->Own->GetFieldData());
  vtkSPHAddArray(output->GetPointData(), "WidenedSmoothingLength", lengths.Get());
  vtkSPHAddArrays(found, output->GetPointData());
  return true;
}

// If processes share the run, the process that owns a particle's place finds the particle's factor
// and sends it back to the process that has the particle.
bool vtkMarchingCorrectors::FindWidening(
  vtkRun& run, vtkSPHParticles& mine, vtkPointData* found, mcor_statistics& statistics)
{
  const std::unique_ptr<vtkRun> sums = vtkRun::Make(this);
  sums->Own = run.Own;
  sums->Options = run.Options;
  sums->Options.level_limit = 0;
  if (!sums->Measure(mine, false)) // uses the box, to find particles that are too far away
  {
    return false;
  }
  std::fill_n(sums->Options.box, sums->IsShared() ? 6 : 0, 0.0);
  vtkSPHParticles* input = sums->Share(mine);
  vtkSPHOwned<mcor_widening, mcor_free_widening> widening;
  if (!input ||
    !sums->Call(*input,
      [&](mcor_context* context)
      { return mcor_widen(context, &input->Core, &sums->Options, &widening); }))
  {
    return false;
  }
  statistics = widening.statistics;
  // A process without particles of its own has 0 as its least length. This is replaced by infinity, so
  // that such a process does not change the minimum.
  const double least = statistics.smoothing_length_min;
  double range[2] = { least > 0.0 ? least : std::numeric_limits<double>::infinity(), 0.0 };
  sums->MergeRanges(range, 1);
  statistics.smoothing_length_min = range[0];
  const auto count = static_cast<vtkIdType>(input->Core.count);
  vtkSPHAddArray(found, "Widening", vtkSPHAdopt(widening.factor, 1, count));
  if (vtkSPHComputesVolumes(mine.Core))
  {
    vtkSPHAddArray(found, "WideningVolume", vtkSPHAdopt(widening.volume, 1, count));
  }
  vtkSPHAddArray(found, "WideningOutside", vtkSPHAdopt(widening.outside, 1, count));
  sums->Return(found, run.Own);
  statistics.widening_outside = 0;
  vtkDataArray* const outside = found->GetArray("WideningOutside");
  for (vtkIdType i = 0; i < outside->GetNumberOfTuples(); ++i)
  {
    statistics.widening_outside += outside->GetComponent(i, 0) != 0.0 ? 1 : 0;
  }
  found->RemoveArray("WideningOutside");
  return true;
}

namespace
{
// Lists the values of all options on which factors of widening may depend.
std::vector<double> ListFactorOptions(const mcor_options& o)
{
  const int SURFACE = 0, PROBE = 0, GAUGE = 0, ALL = 0, KEEPS = 1;
  std::vector<double> values = { o.wall_share };
  const int isos = o.field == MCOR_WEIGHT_SUM ? o.iso_count : 0;
  values.insert(values.end(), o.iso_values, o.iso_values + isos);
#define OPTION(member, usual, legal, words, scope, Property)                                       \
  if ((scope) != KEEPS)                                                                            \
  {                                                                                                \
    values.push_back(static_cast<double>(o.member));                                               \
  }
#define BOUNDS(member, scope, Property) values.insert(values.end(), o.member, o.member + 6);
#include "mcor_options.def"
  return values;
}
}

// Gives the input the factors by which smoothing lengths are multiplied. Takes the last run's factors
// if KeepDeviceData is on, and neither the particles nor the options have changed. Returns false if
// the factors cannot be found.
bool vtkMarchingCorrectors::TakeWidening(vtkRun& run, vtkSPHParticles& input)
{
  vtkInternals& kept = *this->Internals;
  std::vector<std::uint64_t> signature = input.ParticlesSignature;
  for (const double value : ListFactorOptions(run.Options))
  {
    vtkSPHSign(signature, value);
  }
  const bool isOther = kept.Widening.Take(signature, !kept.Factors || !this->KeepDeviceData);
  std::fill_n(kept.FactorsStatistics.seconds, MCOR_PHASE_COUNT, 0.0);
  kept.FactorsStatistics.build_seconds = 0.0;
  if (isOther)
  {
    auto found = vtkSmartPointer<vtkPointData>::New();
    kept.Factors = nullptr;
    if (!this->FindWidening(run, input, found, kept.FactorsStatistics))
    {
      return false;
    }
    kept.Factors = found;
  }
  input.TakeWidening(kept.Factors->GetArray("Widening"), kept.Factors->GetArray("WideningVolume"));
  return true;
}

// A progress observer may change this filter's settings, so they are copied first.
void vtkMarchingCorrectors::Extract(
  vtkRun& run, vtkSPHParticles& input, vtkPolyData* output)
{
  const int precision = this->OutputPointsPrecision;
  mcor_options& options = run.Options;
  options.outputs |= input.FromNearest.empty() ? 0 : MCOR_OUT_NEAREST_PARTICLE;
  this->EstimatedCells =
    mcor_estimate_cells(&input.Core, &options, mcor_least_smoothing_length(&input.Core));
  this->WarnOfHugeRun();
  if (options.widen > 1.0 && !this->TakeWidening(run, input))
  {
    return;
  }
  vtkSPHOwned<mcor_surface, mcor_free_surface> surface;
  if (!run.Call(input,
        [&](mcor_context* context)
        { return mcor_extract(context, &input.Core, &options, &surface); }))
  {
    return;
  }
  if (options.widen > 1.0)
  {
    mcor_add_widening(&surface.statistics, &this->Internals->FactorsStatistics);
  }
  vtkMarchingCorrectorsOutput builder(input, options, surface);
  this->Summarize(input, options, surface.statistics);
  this->WarnOf(input, surface, input.Core, options, builder.FindLargestFloat(precision));
  builder.AddRun(this->RunStatistics);
  builder.BuildMesh(
    output, precision, [&run](double* ranges, int count) { run.MergeRanges(ranges, count); });
}

void vtkMarchingCorrectors::WarnOf(const vtkSPHParticles& input,
  const mcor_surface& surface, const mcor_input& core, const mcor_options& options,
  double largestFloat)
{
  for (const std::string& sentence : input.ListLeftOut(surface.attribute_not_finite, "the surface"))
  {
    this->Warn(sentence);
  }
  for (int kind = 0; kind < MCOR_WARNING_COUNT; ++kind)
  {
    this->WarnOnce(kind,
      vtkSPHTakeText(
        mcor_describe_warning(static_cast<mcor_warning>(kind), &core, &options, &surface)));
  }
  this->WarnOnce(WARN_SINGLE_POINTS,
    vtkSPHTakeText(mcor_describe_single_points(largestFloat, surface.statistics.cube_size)));
}

void vtkMarchingCorrectors::WarnOfHugeRun()
{
  const std::string warning = vtkSPHTakeText(mcor_describe_estimate(this->EstimatedCells));
  if (!warning.empty())
  {
    this->Warn(warning);
  }
}

// Finds what the next update would find. Each value needs only some of the arrays: the range needs
// no smoothing length, the number of cells needs no scalar. The iso value is the first block's.
vtkMarchingCorrectors::vtkAhead& vtkMarchingCorrectors::LookAhead()
{
  vtkAhead& next = this->Next;
  vtkDataObject* data = this->GetParticles();
  if (!this->IsShared() && data &&
    std::max(this->GetMTime(), data->GetMTime()) < this->LookTime.GetMTime())
  {
    return next;
  }
  next = {};
  if (this->IsShared())
  {
    std::copy_n(this->FluidScalarRange, 2, next.ScalarRange);
    next.Fluid = this->UsedFluid;
    next.Cells = this->EstimatedCells;
    return next;
  }
  vtkSmartPointer<vtkDataObject> taken = data ? this->TakeVertices(data) : nullptr;
  taken = this->TakesTogether() ? this->JoinParticles(taken).Get() : taken.Get();
  for (vtkPointSet* particles : vtkSPHListPointSets(taken))
  {
    vtkRun run(this);
    run.Own = particles;
    this->ChooseMode(run);
    mcor_options options;
    this->FillOptions(options);
    const auto contoured = this->MakeInput(run, options, MCOR_WANT_SCALAR);
    vtkSPHRequest fittest;
    run.Choose(&fittest);
    next.Array = next.Array.empty() ? fittest.Name : next.Array;
    double range[2], value;
    if (!this->DrawsFreeSurface && contoured->Collect() &&
      mcor_find_iso_value(&contoured->Core, nullptr, range, &value))
    {
      const bool isFirst = std::isnan(next.IsoValue);
      next.ScalarRange[0] = isFirst ? range[0] : std::min(next.ScalarRange[0], range[0]);
      next.ScalarRange[1] = isFirst ? range[1] : std::max(next.ScalarRange[1], range[1]);
      next.IsoValue = isFirst ? value : next.IsoValue;
      next.Components = contoured->Core.scalar_dot.data ? 1 : contoured->Core.scalar.components;
    }
    vtkSPHWanted sizes = contoured->Wanted;
    sizes.Wants = MCOR_WANT_SIZES | MCOR_WANT_SCALAR;
    sizes.FreeSurface = true;
    vtkSPHParticles input(contoured->Description, particles, sizes);
    const bool isUsable = input.Collect();
    next.Fluid = input.DescribeFluid();
    if (isUsable)
    {
      next.Dimension = mcor_find_dimension(&input.Core, nullptr, this->Dimension);
      next.FreeSurface |= input.HasFreeSurface(nullptr) ? 1 : 0;
      next.Cells +=
        mcor_estimate_cells(&input.Core, &options, mcor_least_smoothing_length(&input.Core));
    }
  }
  next.Warning = vtkSPHTakeText(mcor_describe_estimate(next.Cells));
  this->LookTime.Modified();
  return next;
}

void vtkMarchingCorrectors::Summarize(const vtkSPHParticles& input,
  const mcor_options& options, const mcor_statistics& statistics)
{
  if (options.field != MCOR_WEIGHT_SUM)
  {
    this->FluidScalarRange[0] = statistics.scalar_min;
    this->FluidScalarRange[1] = statistics.scalar_max;
  }
  std::ostringstream isoValues;
  for (int i = 0; i < options.iso_count; ++i)
  {
    isoValues << (i ? ", " : "") << options.iso_values[i];
  }
  this->UsedIsoValues = isoValues.str();
  this->IsoValueArrayName = options.outputs & MCOR_OUT_ISO_VALUE ? std::string(input.Found.iso_value_name) : "";
  this->UsedSmoothingLength =
    vtkSPHTakeText(mcor_describe_smoothing_length(&input.Core, &statistics));
  this->UsedCubeSize = statistics.cube_size;
  this->SurfaceMeasures = vtkSPHTakeText(mcor_describe_measures(&statistics));
}

void vtkMarchingCorrectors::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(ScalarComponent, ShepardNormalization, FreeSurface, CubeSizeFactor, CubeSize,
    CubeLevelLimit, UseBox, Box, Capping, Filled, Preview, Compact, Smooth, Widening, Trim,
    NodeThreshold, VertexThreshold, Solids, WallShare, ComputeNormals, ComputeGradients,
    ComputeScalars, ComputeWeightSum, ComputeCurvature, ComputeBoundaryEigenvalue,
    ComputeCorrectionLength, ComputeResidual, ComputeBoundaryFlag, InterpolateAttributes,
    OutputPointsPrecision, Tolerance, IterationLimit, FluidScalarRange, UsedIsoValues,
    UsedSmoothingLength, UsedCubeSize, SurfaceMeasures, EstimatedCells);
  os << indent << "Cube Size Mode: " << (this->CubeSizeMode == ADAPTIVE ? "adaptive" : "uniform")
     << "\n"
     << indent << "Seed Mode: " << (this->SeedMode == PAIRS ? "pairs" : "complete") << "\n"
     << indent << "Topology: " << (this->Topology == TOPOLOGY_FIELD ? "field" : "table") << "\n"
     << indent << "Boundary Detection: "
     << (this->BoundaryDetection == EIGENVALUE ? "eigenvalue" : "weight sum") << "\n";
  this->ContourValues->PrintSelf(os, indent.GetNextIndent());
  this->FreeSurfaceValues->PrintSelf(os, indent.GetNextIndent());
}
VTK_ABI_NAMESPACE_END

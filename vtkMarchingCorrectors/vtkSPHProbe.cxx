// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHProbe.h"

#include "vtkCharArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMatrix4x4.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkSMPTools.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"

#include <algorithm>
#include <limits>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** The core gets at most this number of points at a time. */
constexpr vtkIdType ChunkSize = 1 << 20;

/** The points of a data set, some at a time, in a form that the core reads. */
class PointReader
{
public:
  explicit PointReader(vtkDataSet* data)
    : Data(data)
  {
    auto* set = vtkPointSet::SafeDownCast(data);
    vtkDataArray* stored = set && set->GetPoints() ? set->GetPoints()->GetData() : nullptr;
    this->Stored = stored ? vtkSPHAsReal(stored) : nullptr;
  }

  /** Returns `count` points from `first` on; the result is valid until the next call. */
  mcor_array View(vtkIdType first, vtkIdType count)
  {
    if (this->Stored)
    {
      mcor_array view = vtkSPHView(this->Stored);
      view.data = this->Stored->GetVoidPointer(3 * first);
      return view;
    }
    if (count > this->Room)
    {
      this->Copied.reset(new double[3 * count]);
      this->Room = count;
    }
    double* to = this->Copied.get();
    mcor_array view = {};
    view.type = MCOR_FLOAT64;
    view.components = 3;
    view.data = to;
    if (auto* image = vtkImageData::SafeDownCast(this->Data))
    {
      CopyImagePoints(image, first, count, to);
      return view;
    }
    vtkSMPTools::For(0, count,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          this->Data->GetPoint(first + i, to + 3 * i);
        }
      });
    return view;
  }

private:
  /**
   * Writes the same points as GetPoint() gives. Calls of GetPoint() would take as long as sending
   * the points to the device.
   */
  static void CopyImagePoints(vtkImageData* image, vtkIdType first, vtkIdType count, double* to)
  {
    const int* extent = image->GetExtent();
    const double* m = image->GetIndexToPhysicalMatrix()->GetData();
    const vtkIdType nx = extent[1] - extent[0] + 1, ny = extent[3] - extent[2] + 1;
    vtkSMPTools::For(first, first + count,
      [=](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType point = begin; point < end; ++point)
        {
          const double i = static_cast<double>(extent[0] + point % nx);
          const double j = static_cast<double>(extent[2] + point / nx % ny);
          const double k = static_cast<double>(extent[4] + point / nx / ny);
          double* x = to + 3 * (point - first);
          for (int a = 0; a < 3; ++a)
          {
            x[a] = m[4 * a] * i + m[4 * a + 1] * j + m[4 * a + 2] * k + m[4 * a + 3];
          }
        }
      });
  }

  vtkDataSet* Data;
  vtkSmartPointer<vtkDataArray> Stored;
  std::unique_ptr<double[]> Copied; // an array, because a vector would write zeros first
  vtkIdType Room = 0;
};

/** Progress of one chunk, as a part of the progress of the run. */
struct ChunkProgress
{
  int (*Report)(void* user, double fraction, const char* phase);
  void* User;
  double Begin;
  double Share;

  static int Run(void* user, double fraction, const char* phase)
  {
    const auto* chunk = static_cast<ChunkProgress*>(user);
    return chunk->Report(chunk->User, chunk->Begin + fraction * chunk->Share, phase);
  }
};

/**
 * The particles' version in a run of several chunks without KeepDeviceData: equal versions let the
 * core use its search grid for the next chunk, too. Runs with KeepDeviceData never have this version.
 * A run of one chunk has none, so that only the particles near the points go to the device.
 */
constexpr std::uint64_t VersionOfOneRun = UINT64_MAX;

/** Tuples that one thread copies at a time. */
constexpr vtkIdType CopyGrain = 1 << 14;

/** Copies values, but writes `null` for tuples whose `valid` is 0. */
template <typename ValueT>
void Copy(const double* from, const std::uint8_t* valid, double null, vtkIdType tuples,
  int components, ValueT* to)
{
  vtkSMPTools::For(0, tuples, CopyGrain,
    [=](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin * components; i < end * components; ++i)
      {
        to[i] = static_cast<ValueT>(valid && !valid[i / components] ? null : from[i]);
      }
    });
}

/** The arrays that a run makes, filled for a chunk of points at a time. */
class Samples
{
public:
  /**
   * Makes the arrays for `count` points. Interpolated arrays begin as `null` at all points, the
   * weight as 0.
   */
  Samples(const vtkSPHParticles& particles, const mcor_options& options,
    const std::string& maskName, vtkIdType count, double null)
    : NotFinite(particles.Interpolated.size(), -1)
    , Null(null)
  {
    const bool gradients = (options.outputs & MCOR_OUT_GRADIENTS) != 0;
    const auto make = [=](const std::string& name, int components, bool asFloat, double fill)
    {
      Pair pair;
      for (int i = 0; i < (gradients ? 2 : 1); ++i)
      {
        auto array = vtkSmartPointer<vtkDataArray>::Take(
          vtkDataArray::CreateDataArray(asFloat ? VTK_FLOAT : VTK_DOUBLE));
        array->SetName((name + (i == 0 ? "" : "_Gradient")).c_str());
        array->SetNumberOfComponents(i == 0 ? components : 3 * components);
        array->SetNumberOfTuples(count);
        array->Fill(fill);
        (i == 0 ? pair.Values : pair.Gradient) = array;
      }
      return pair;
    };
    for (const vtkSPHAttribute& from : particles.Interpolated)
    {
      this->Arrays.push_back(
        make(from.Name, from.Components, from.Array->GetDataType() == VTK_FLOAT, null));
      this->Arrays.back().Values->CopyComponentNames(from.Array);
    }
    this->Weight = make("WeightSum", 1, options.precision == MCOR_FLOAT32, 0.0);
    this->Mask->SetName(maskName.c_str());
    this->Mask->SetNumberOfTuples(count);
    this->Mask->FillValue(0);
  }

  /** Calls the core for some points at a time. Returns a mcor_status. */
  int Evaluate(vtkDataSet* points, mcor_context* context, const mcor_input& particles,
    mcor_options options, vtkFieldData* statistics)
  {
    const vtkIdType total = points->GetNumberOfPoints();
    mcor_input input = particles;
    if (input.particles_version == 0 && total > ChunkSize)
    {
      input.particles_version = input.scalar_version = input.attributes_version = VersionOfOneRun;
    }
    PointReader reader(points);
    ChunkProgress progress = { options.progress, options.progress_user, 0.0, 0.0 };
    options.progress = ChunkProgress::Run;
    options.progress_user = &progress;
    for (vtkIdType first = 0; first < total; first += ChunkSize)
    {
      const vtkIdType count = std::min(ChunkSize, total - first);
      progress.Begin = static_cast<double>(first) / static_cast<double>(total);
      progress.Share = static_cast<double>(count) / static_cast<double>(total);
      const mcor_array view = reader.View(first, count);
      mcor_samples samples = {};
      const mcor_status status = mcor_probe(context, &input, &options, &view, count, &samples);
      if (status != MCOR_OK)
      {
        return status;
      }
      this->Put(first, samples);
      this->Statistics = samples.statistics;
      vtkSPHAddRunStatistics(statistics, samples.statistics);
      mcor_free_samples(&samples);
    }
    return MCOR_OK;
  }

  /** Adds the arrays to the output, except the ones that the core has left out. */
  void AddTo(vtkFieldData* data) const
  {
    for (size_t a = 0; a <= this->Arrays.size(); ++a)
    {
      const bool isWeight = a == this->Arrays.size();
      const Pair& pair = isWeight ? this->Weight : this->Arrays[a];
      for (vtkDataArray* array : { pair.Values.Get(), pair.Gradient.Get() })
      {
        if (array && (isWeight || this->NotFinite[a] < 0))
        {
          data->AddArray(array);
        }
      }
    }
    data->AddArray(this->Mask);
  }

  std::vector<std::int64_t> NotFinite; // as attribute_not_finite of mcor_samples
  mcor_statistics Statistics = {};     // statistics of the last points

private:
  /** An array of the output, and the array of its gradient, if wanted. */
  struct Pair
  {
    vtkSmartPointer<vtkDataArray> Values, Gradient;
  };

  /** Copies the core's results to the points from `first` on. */
  void Put(vtkIdType first, const mcor_samples& samples)
  {
    const auto copy = [&](const double* from, const std::uint8_t* valid, vtkDataArray* to)
    {
      const int components = to ? to->GetNumberOfComponents() : 0;
      void* out = to ? to->GetVoidPointer(first * components) : nullptr;
      if (to && to->GetDataType() == VTK_FLOAT)
      {
        Copy(from, valid, this->Null, samples.count, components, static_cast<float*>(out));
      }
      else if (to)
      {
        Copy(from, valid, this->Null, samples.count, components, static_cast<double*>(out));
      }
    };
    for (size_t a = 0; a < this->Arrays.size(); ++a)
    {
      this->NotFinite[a] = samples.attribute_not_finite[a];
      if (samples.values[a])
      {
        copy(samples.values[a], samples.valid, this->Arrays[a].Values);
        copy(samples.gradients ? samples.gradients[a] : nullptr, samples.valid,
          this->Arrays[a].Gradient);
      }
    }
    copy(samples.weight_sum, nullptr, this->Weight.Values);
    copy(samples.weight_gradient, nullptr, this->Weight.Gradient);
    std::copy(samples.valid, samples.valid + samples.count, this->Mask->GetPointer(first));
  }

  const double Null;        // the value at points that are not valid
  std::vector<Pair> Arrays; // in the order of the core's attributes
  Pair Weight;
  vtkNew<vtkCharArray> Mask; // chars, as in vtkProbeFilter
};
}

vtkStandardNewMacro(vtkSPHProbe);

vtkSPHProbe::vtkSPHProbe()
{
  this->SetNumberOfInputPorts(2);
}

int vtkSPHProbe::FillInputPortInformation(int port, vtkInformation* info)
{
  // Inputs are optional for VTK: the filter itself reports a missing one in words.
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), this->GetNumberOfInputPorts() > 1 ? 1 : 0);
  if (port == this->GetParticlesPort())
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
  return 1;
}

// Asks for all particles, because each piece of the points needs all. Ranks that share a run exchange them instead.
int vtkSPHProbe::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  vtkInformation* particles = inputVector[this->GetParticlesPort()]->GetInformationObject(0);
  if (particles && !this->IsShared())
  {
    AskForAll(particles);
  }
  return 1;
}

void vtkSPHProbe::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* points = vtkDataSet::SafeDownCast(data);
  this->SetUsedNames(nullptr);
  const std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  const char* const problem = this->GetNumberOfInputConnections(0) == 0
    ? "Choose the points, the first input: there are none to probe at."
    : this->GetNumberOfInputConnections(this->GetParticlesPort()) == 0
    ? "Choose the particles, the second input: there are none to probe."
    : "";
  if (!run->Agree(problem))
  {
    return;
  }
  if (data && !points && !run->IsShared())
  {
    this->Warn(std::string("A ") + data->GetClassName() + " has no points to probe at.");
    return;
  }
  if (!run->Begin(this->Particles) || (!points && !run->IsShared()))
  {
    return;
  }
  std::int64_t pointCount = points ? points->GetNumberOfPoints() : 0;
  run->Sum(&pointCount, 1);
  vtkSPHWanted wanted;
  wanted.Wants |= this->InterpolateAttributes ? MCOR_WANT_ATTRIBUTES : 0;
  wanted.Taken = { "WeightSum", this->ValidPointMaskArrayName };
  vtkSPHParticles mine(run->Choose(), run->Own, wanted);
  if (!run->Accept(mine, "no point is valid"))
  {
    return;
  }
  this->FillOptions(run->Options);
  run->Options.field = this->ShepardNormalization ? MCOR_SHEPARD : MCOR_SUM;
  run->Options.node_threshold = this->WeightThreshold;
  run->Options.outputs = this->ComputeGradients ? MCOR_OUT_GRADIENTS : 0;
  run->Points = points;
  const bool evaluates = run->HasFluid && pointCount > 0;
  vtkSPHParticles* input = &mine;
  if (evaluates)
  {
    if (!run->Measure(mine, true))
    {
      return;
    }
    run->PlacePoints(points);
    input = run->Share(mine);
    if (!input)
    {
      return;
    }
  }
  // A progress observer may change this filter's settings, so they are copied here.
  Samples samples(*input, run->Options, this->ValidPointMaskArrayName,
    run->Points ? run->Points->GetNumberOfPoints() : 0,
    this->NaNOutside ? std::numeric_limits<double>::quiet_NaN() : this->NullValue);
  vtkNew<vtkPointData> found;
  if (evaluates)
  {
    vtkFieldData* statistics = this->RunStatistics;
    run->FindNotFinite(*input, samples.NotFinite);
    if (!run->Call(*input,
          [&](mcor_context* context) {
            return samples.Evaluate(run->Points, context, input->Core, run->Options, statistics);
          }))
    {
      return;
    }
  }
  samples.AddTo(found);
  if (evaluates)
  {
    run->Return(found, points);
    run->AddShares();
  }
  run->WarnOfParticles(input->Core, samples.Statistics);
  if (run->IsFirst())
  {
    for (const std::string& sentence : input->ListLeftOut(samples.NotFinite.data(), "the output"))
    {
      this->Warn(sentence);
    }
  }
  auto* probed = vtkDataSet::SafeDownCast(output);
  if (points && probed)
  {
    probed->ShallowCopy(points);
    vtkSPHAddArrays(found, probed->GetPointData());
  }
  FinishOutput(*run, found, points ? probed : nullptr);
}

// Chooses active scalars among the found arrays. The values at the particles decide, because points
// that are not valid have a replacement value.
void vtkSPHProbe::FinishOutput(vtkRun& run, vtkPointData* found, vtkDataSet* output)
{
  vtkPointData* from = run.Own->GetPointData();
  vtkNew<vtkPointData> used;
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    if (from->GetArray(i) && found->HasArray(from->GetArrayName(i)))
    {
      used->AddArray(from->GetArray(i));
    }
  }
  const std::string best =
    run.Ask([&](const mcor_ranks* ranks) { return vtkSPHChooseArray(used, ranks); });
  if (output && output->GetPointData()->HasArray(best.c_str()))
  {
    output->GetPointData()->SetActiveScalars(best.c_str());
  }
}

void vtkSPHProbe::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(ShepardNormalization, WeightThreshold, InterpolateAttributes, ComputeGradients,
    NaNOutside, NullValue, ValidPointMaskArrayName);
}
VTK_ABI_NAMESPACE_END

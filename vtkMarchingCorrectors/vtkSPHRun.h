// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: one run of a filter over particles, by this process alone. A run of many
 * processes is vtkSharedRun in ranks/. Filters take the same steps in both runs, in the order below.
 * In a shared run all processes call all steps, and each step returns the same everywhere: false if
 * it failed on any process (then all processes report the error), or if the run was cancelled.
 */
#ifndef vtkSPHRun_h
#define vtkSPHRun_h

#include "mcor.h"
#include "vtkDataObject.h"
#include "vtkDataSet.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSPHParticles.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/** Data that outlive a run: the core's context, signatures of the data that it keeps, and data made from the input. */
class vtkSPHAlgorithm::vtkInternals
{
public:
  ~vtkInternals();

  /**
   * This process is number `place` of `count` on this machine. Makes a context for the device and
   * both numbers, or keeps the present context if it was made for the same device and numbers.
   * Returns why the device is not usable, or an empty string.
   */
  std::string Prepare(const std::string& device, int place, int count);

  /** Forgets the data on the device after a failure, and the device itself after a device error. */
  void Forget(mcor_status status);

  /** Frees the device memory. Between BeginRun() and EndRun() it is in use, so EndRun() frees it. */
  void Release();
  void BeginRun()
  {
    this->InRun = true;
    this->ReleaseAfterRun = false;
  }
  void EndRun();

  mcor_context* Context = nullptr;
  /** Data that were made from an input, and are valid while the input and `How` stay the same. */
  struct Made
  {
    vtkSmartPointer<vtkDataObject> Data;
    vtkWeakPointer<vtkDataObject> From;
    std::string How;
    vtkTimeStamp Time;

    /** Returns whether the data are valid for this input. If not, the caller must make them anew. */
    bool Serves(vtkDataObject* from, const std::string& how);
  };
  Made Taken;  // particles among the cells of a mesh; how: whether any rank has vertices
  Made Joined; // blocks as one set of particles; how: the fluid array, which may be a block

  /** The signature of the last run's data, and their version, which counts changes. Equal versions mean equal data. */
  struct Kept
  {
    std::vector<std::uint64_t> Signature;
    std::uint64_t Version = 0;

    /** Keeps this signature. Returns whether the data have changed; if isOther is set, they count as changed. */
    bool Take(const std::vector<std::uint64_t>& signature, bool isOther = false)
    {
      isOther = isOther || signature != this->Signature;
      this->Version += isOther ? 1 : 0;
      this->Signature = signature;
      return isOther;
    }
  };
  Kept Particles, Scalar, Attributes, Widening;
  vtkSmartPointer<vtkPointData> Factors; // made from the data that Widening signs; or null
  mcor_statistics FactorsStatistics = {};

private:
  std::string Device; // Device, Place and Count: as the context was created
  int Place = 0, Count = 0;
  bool InRun = false;
  bool ReleaseAfterRun = false;
};

class vtkSPHAlgorithm::vtkRun
{
public:
  /** Makes a shared run if processes share the filter's runs, else a run of this process alone. */
  static std::unique_ptr<vtkRun> Make(vtkSPHAlgorithm* filter);

  explicit vtkRun(vtkSPHAlgorithm* filter)
    : Filter(filter)
  {
  }
  virtual ~vtkRun() = default;
  vtkRun(const vtkRun&) = delete;
  void operator=(const vtkRun&) = delete;

  virtual bool IsShared() const { return false; }
  /** Whether this process reports what must be reported once. */
  virtual bool IsFirst() const { return true; }
  virtual void Sum(std::int64_t*, int) {}
  /** Merges ranges, each a least and a greatest value, over all processes. */
  virtual void MergeRanges(double*, int /*count*/) {}
  using Named = std::pair<std::string, std::vector<double>>;
  /** Returns the lists of all processes, this one included. All processes get them in the same order. */
  virtual std::vector<std::vector<Named>> Gather(const std::vector<Named>& mine)
  {
    return { mine };
  }
  /** Computes sums over neighbours, which may be on other processes, see vtkSPHSumShared. */
  virtual std::string SumNeighbors(
    vtkPointSet*, const mcor_input&, const mcor_options&, const double*, double*)
  {
    return "";
  }
  /** Returns true if `problem` is empty on all processes. Else reports the error and returns false. */
  virtual bool Agree(const std::string& problem);

  /** Takes this process's particles. Returns false if the run was cancelled or, in a run of one process, if the particles are null. */
  virtual bool Begin(vtkPointSet* particles);
  /** Returns the filter's description of the particles, completed as vtkSPHChoose() does. */
  vtkSPHParticlesChoice Choose(vtkSPHRequest* first = nullptr);
  /**
   * Collects the particles, sets HasFluid, and notes which arrays were found. Warns if there is
   * no fluid, and names the `consequence`, such as "no surface"; else warns if a setting has no effect.
   * Returns false, after an error, if an array is not usable. Without particles, does nothing and returns true.
   */
  bool Accept(vtkSPHParticles& particles, const std::string& consequence);
  /**
   * Finds the period. A shared run also measures the particles of all processes (mcor_globals): for
   * mcor_probe if forSamples is set, else for mcor_extract.
   */
  virtual bool Measure(vtkSPHParticles&, bool /*forSamples*/) { return this->SetPeriod(); }
  /** Finds the period and, if smoothing lengths are estimated, the estimate from all processes' particles. */
  virtual bool MeasureLengths(vtkSPHParticles& particles) { return this->Measure(particles, true); }
  /** Limits a shared run to the box around places with these least and greatest coordinates. */
  virtual void PlaceBox(const double[3], const double[3]) {}
  /** Takes the points at which to evaluate, which may be null. */
  virtual void PlacePoints(vtkDataSet* points) { this->Points = points; }
  /**
   * Sends particles and points to the processes that need them. Returns the particles that came to
   * this process, with their arrays collected; null if these are not usable. A run of one process returns
   * `mine`.
   */
  virtual vtkSPHParticles* Share(vtkSPHParticles& mine) { return &mine; }
  /** Returns, for each particle of Share(), whether this process owns the particle; null: it owns all. */
  virtual const std::uint8_t* MarkOwned() { return nullptr; }
  /** Calls the core: `call` gets a context for the device, and returns the core's status. */
  virtual bool Call(vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call);
  /** Calls a function of the core that needs no context; `call` returns false if it failed. */
  virtual void CallAside(const std::function<bool(const mcor_ranks*)>& call) { call(nullptr); }
  /** Calls a function of the core that needs no context and cannot fail, and returns its result. */
  template <typename CallT>
  auto Ask(const CallT& call)
  {
    decltype(call(nullptr)) answer{};
    this->CallAside(
      [&](const mcor_ranks* ranks)
      {
        answer = call(ranks);
        return true;
      });
    return answer;
  }
  /**
   * Sends results back to the processes that the points came from; if there are no points, to the
   * processes of the particles. home: the data set of this process that gets results; may be null.
   */
  virtual void Return(vtkPointData*, vtkDataSet*) {}
  /** In a shared run, lists for each interpolated array the first particle with a value that is not
   * finite, among all processes' particles, or -1. A run of one process changes nothing. */
  virtual void FindNotFinite(const vtkSPHParticles&, std::vector<std::int64_t>&) {}
  /** Adds to the statistics of the run how much each process has done. */
  virtual void AddShares() {}
  /** Gives the warnings of the core that need no surface. */
  virtual void WarnOfParticles(const mcor_input& core, const mcor_statistics& statistics);

  bool IsQuiet = false;             ///< errors are not reported
  vtkSmartPointer<vtkPointSet> Own; ///< this process's particles
  std::int64_t Particles = 0;       ///< of all processes
  bool HasFluid = false;            ///< whether any process has fluid
  mcor_options Options = {};
  std::vector<double> IsoValues;      ///< of the options
  vtkSmartPointer<vtkDataSet> Points; ///< the points that this process evaluates

protected:
  void Fail(const std::string& message);
  /** Finds the period if DetectPeriod is on. Returns false, after an error, if no usable period is found. */
  bool SetPeriod();
  /** Returns the bounds of the period that field data tell; empty if they tell none. */
  virtual std::vector<double> FindPeriod(std::string& problem);
  /**
   * Calls the core, as number `place` of `count` processes of this machine. Returns its status;
   * `message` says why it failed, unless it was cancelled.
   */
  int CallCore(vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call,
    std::string& message, int place, int count);

  vtkSPHAlgorithm* const Filter;
};
VTK_ABI_NAMESPACE_END

#endif

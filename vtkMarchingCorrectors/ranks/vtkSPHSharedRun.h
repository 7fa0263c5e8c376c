// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: a run that many processes (ranks) share. Each rank hands over
 * its particles. Space is divided among the ranks, particles are sent to the ranks whose boxes they
 * reach, each rank calls the core for its box, and results go back to the ranks that points and
 * particles came from.
 */
#ifndef vtkSPHSharedRun_h
#define vtkSPHSharedRun_h

#include "mcor_parts.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksSpace.h"
#include "vtkSPHRun.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHAlgorithm::vtkSharedRun : public vtkSPHAlgorithm::vtkRun
{
public:
  explicit vtkSharedRun(vtkSPHAlgorithm* filter)
    : vtkRun(filter)
    , Ranks(filter->Controller)
  {
  }
  ~vtkSharedRun() override { mcor_free_globals(&this->Globals); }

  bool IsShared() const override { return true; }
  bool IsFirst() const override { return this->Ranks.GetRank() == 0; }
  void Sum(std::int64_t* values, int count) override
  {
    this->Ranks.Reduce(vtkSPHRanks::SUM, values, count);
  }
  void MergeRanges(double* ranges, int count) override { this->Ranks.ReduceRanges(ranges, count); }
  std::vector<std::vector<Named>> Gather(const std::vector<Named>& mine) override
  {
    return this->Ranks.Gather(mine);
  }
  std::string SumNeighbors(vtkPointSet* points, const mcor_input& mine,
    const mcor_options& options, const double* ratio, double* values) override;
  bool Agree(const std::string& problem) override;
  bool Begin(vtkPointSet* particles) override;
  bool Measure(vtkSPHParticles& particles, bool forSamples) override;
  bool MeasureLengths(vtkSPHParticles& particles) override;
  void PlaceBox(const double low[3], const double high[3]) override;
  void PlacePoints(vtkDataSet* points) override;
  vtkSPHParticles* Share(vtkSPHParticles& mine) override;
  const std::uint8_t* MarkOwned() override;
  bool Call(vtkSPHParticles& particles, const std::function<int(mcor_context*)>& call) override;
  void CallAside(const std::function<bool(const mcor_ranks*)>& call) override;
  void Return(vtkPointData* found, vtkDataSet* home) override;
  void FindNotFinite(const vtkSPHParticles& input, std::vector<std::int64_t>& notFinite) override;
  void AddShares() override;
  void WarnOfParticles(const mcor_input& core, const mcor_statistics& statistics) override;

  /**
   * Like Share(), but sends the set `particles`, which `mine` describes, with all its arrays, and
   * divides the space among the first `parts` ranks only.
   */
  vtkSPHParticles* Send(vtkSPHParticles& mine, vtkPointSet* particles, int parts);
  /** Makes the input describe all ranks' particles, for warnings: sets their number, and removes the
   * globals. Also removes positions and marks of solids, because this rank knows only its own particles. */
  void OfAll(mcor_input& core, mcor_options& options) const;
  /** Adds a statistic with one component for each rank. */
  template <typename T>
  void AddShare(const char* name, T mine)
  {
    vtkSPHAdd(this->Filter->RunStatistics, name, this->Ranks.Gather(mine));
  }
  /** Adds what was exchanged: "RankParticles", "RankCopies" and "RankBytesSent". */
  void AddExchange();

  vtkSPHRanks Ranks;
  mcor_globals Globals = {};
  std::vector<std::int64_t> Work; ///< the work of each of this rank's particles; empty: 1 each
  vtkSPHRanksSpace Space;
  vtkSmartPointer<vtkPolyData> Near; ///< the particles that this rank's box needs

protected:
  std::vector<double> FindPeriod(std::string& problem) override;

private:
  std::unique_ptr<vtkSPHParticles> Input;
  std::vector<std::uint8_t> Owned;
  vtkSmartPointer<vtkPolyData> Places;        ///< this rank's points with finite coordinates
  std::vector<vtkSPHRanksPlace> PlacesOfWork; ///< the work at these points
  std::vector<vtkIdType> Numbers;             ///< index of each place or particle in the given data
  std::vector<vtkIdType> From;                ///< how many points or particles came from each rank
};
VTK_ABI_NAMESPACE_END

#endif

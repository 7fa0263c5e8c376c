// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: the ranks' callbacks for the core. A rank that fails does not leave the
 * others waiting.
 */
#ifndef vtkSPHRanksCalls_h
#define vtkSPHRanksCalls_h

#include "mcor_parts.h"
#include "vtkSPHRanks.h"

#include <cstdint>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
struct vtkSPHRanksRoute;

class vtkSPHRanksCalls
{
public:
  /** `route` is null until space is divided. */
  explicit vtkSPHRanksCalls(vtkSPHRanks& ranks, const vtkSPHRanksRoute* route = nullptr);

  /** Returns the callbacks, for mcor_options during one call of the core. */
  const mcor_ranks* Get() const { return &this->Core; }

  /** Called by all ranks after the core's call, however that ended. */
  void End(bool failed);

  /** Whether this rank was told that another one failed. */
  bool WasStopped() const { return this->Stopped; }

private:
  vtkSPHRanksCalls(const vtkSPHRanksCalls&) = delete;
  void operator=(const vtkSPHRanksCalls&) = delete;

  bool AllGoOn(bool self);
  template <typename T>
  static int Reduce(void* user, mcor_reduction reduction, T* values, int count);
  static int Gather(void* user, const void* records, std::int64_t count, std::size_t width,
    const void** all, std::int64_t* allCount);
  using Bytes = std::vector<char>;
  int Deliver(const std::vector<Bytes>& received, std::size_t width, const void** all,
    std::int64_t* allCount);

  vtkSPHRanks& Ranks;
  mcor_ranks Core = {};
  bool Stopped = false;
  Bytes Gathered;
};
VTK_ABI_NAMESPACE_END

#endif

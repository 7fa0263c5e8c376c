// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what one rank has of a shared run. vtkSPHAlgorithm fills it step by
 * step.
 */
#ifndef vtkSPHRanksRun_h
#define vtkSPHRanksRun_h

#include "mcor.h"
#include "mcor_parts.h"
#include "vtkPolyData.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksRoute.h"
#include "vtkSmartPointer.h"

VTK_ABI_NAMESPACE_BEGIN
struct vtkSPHRanksRun
{
  explicit vtkSPHRanksRun(vtkMultiProcessController* controller)
    : Ranks(controller)
  {
  }
  ~vtkSPHRanksRun() { mcor_free_globals(&this->Globals); }
  vtkSPHRanksRun(const vtkSPHRanksRun&) = delete;
  void operator=(const vtkSPHRanksRun&) = delete;

  /** Makes of a rank's particles, of which the warnings read no positions, those of all ranks. */
  void OfAll(mcor_input& core, mcor_options& options) const
  {
    core.count = this->Particles;
    core.positions.data = nullptr;
    core.solid = nullptr;
    options.globals = nullptr;
  }

  vtkSPHRanks Ranks;
  vtkSmartPointer<vtkPolyData> Own; ///< the particles that it was given, see vtkSPHTakeParticles()
  std::int64_t Particles = 0;       ///< of all ranks
  bool HasFluid = false;            ///< on any rank
  mcor_options Options = {};
  mcor_globals Globals = {};
  vtkSPHRanksRoute Route;
  vtkSmartPointer<vtkPolyData> Near; ///< the particles that its box needs
  std::vector<vtkIdType> From;       ///< how many of them came from each rank
};

/** Lists, for each rank, the particles that came from it and that this rank owns. */
vtkSPHRanksLists vtkSPHListOwned(const vtkSPHRanksRun& run);
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: data that outlive a run. These are the core's context, and the
 * particles and the scalar that it keeps.
 */
#ifndef vtkSPHAlgorithmInternals_h
#define vtkSPHAlgorithmInternals_h

#include "mcor.h"
#include "vtkDataObject.h"
#include "vtkPointSet.h"
#include "vtkSPHAlgorithm.h"
#include "vtkSmartPointer.h"
#include "vtkTimeStamp.h"
#include "vtkWeakPointer.h"

#include <cstdint>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkSPHParticles;

class vtkSPHAlgorithm::vtkInternals
{
public:
  ~vtkInternals();

  /**
   * Makes a context for this device, or keeps the present one if it fits. This is number `place`
   * of `count` processes on this machine. Returns an empty string, or why the device is not
   * usable.
   */
  std::string Prepare(const std::string& device, int place, int count);

  /** Tells the core which data are the same as in the last run. */
  void SetVersions(vtkSPHParticles& input);

  /** Forgets the data on the device, and the device itself, after a failure. */
  void Forget(mcor_status status);

  /** Gives memory back. Between BeginRun() and EndRun() it is in use, so this waits for the end. */
  void Release();
  void BeginRun();
  void EndRun();

  mcor_context* Context = nullptr;
  vtkSmartPointer<vtkDataObject> Taken; // particles taken from an input
  vtkWeakPointer<vtkDataObject> TakenFrom;
  std::int64_t TakenAmong = 0; // whether there were vertices on any rank
  vtkTimeStamp TakenTime;
  vtkSmartPointer<vtkPointSet> Joined; // blocks that are one set of particles
  vtkWeakPointer<vtkDataObject> JoinedFrom;
  std::string JoinedFluid; // the fluid array, which may be a block
  vtkTimeStamp JoinedTime;

private:
  std::string Device; // settings that the context was created for
  int Place = 0, Count = 0;
  bool InRun = false;
  bool ReleaseAfterRun = false;
  /** A value of the last run, and how often it has changed. */
  struct Kept
  {
    std::vector<std::uint64_t> Signature;
    std::uint64_t Version = 0;

    /** Keeps this value. Returns whether it is another one. */
    bool Take(const std::vector<std::uint64_t>& signature, bool isOther = false);
  };
  Kept Particles, Scalar, Attributes;
};
VTK_ABI_NAMESPACE_END

#endif

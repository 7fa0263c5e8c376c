// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: what outlives a run, the core's context and what the particles and the
 * scalar were that it keeps.
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
   * A context for this device, the same one if there is one, for number `place` of `count` processes of
   * this machine. Nothing if it is usable, else why not.
   */
  std::string Prepare(const std::string& device, int place, int count);

  /** Tells the core what is the same as in the run before. */
  void SetVersions(vtkSPHParticles& input);

  /** After a failure nothing is assumed about what is on the device, or about the device itself. */
  void Forget(mcor_status status);

  /** Gives memory back: between a BeginRun() and an EndRun(), where it is in use, at the end. */
  void Release();
  void BeginRun();
  void EndRun();

  mcor_context* Context = nullptr;
  vtkSmartPointer<vtkDataObject> Taken; // what of an input are particles
  vtkWeakPointer<vtkDataObject> TakenFrom;
  std::int64_t TakenAmong = 0; // whether there were vertices on any rank
  vtkTimeStamp TakenTime;
  vtkSmartPointer<vtkPointSet> Joined; // blocks that are one set of particles
  vtkWeakPointer<vtkDataObject> JoinedFrom;
  std::string JoinedFluid; // the fluid array, which may be a block
  vtkTimeStamp JoinedTime;

private:
  std::string Device; // what the context was created for
  int Place = 0, Count = 0;
  bool InRun = false;
  bool ReleaseAfterRun = false;
  /** A value of the last run, and how many others it has been. */
  struct Kept
  {
    std::vector<std::uint64_t> Signature;
    std::uint64_t Version = 0;

    /** Whether this is another one. */
    bool Take(const std::vector<std::uint64_t>& signature, bool isOther = false);
  };
  Kept Particles, Scalar, Attributes;
};
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHTemporalInterpolator
 * @brief   SPH particles at any time between the steps that are stored
 *
 * This filter provides particles at any time between the reader's first and last step, interpolated
 * between two steps. It keeps these two steps, so that an animation reads each step once.
 *
 * Particles are matched between two steps by their ids, in any order. The position follows the
 * cubic Hermite curve through both positions with both velocities as tangents; float and double
 * arrays are linear in time; integers, strings and ids are those of the nearer step. A particle
 * that is in only one of the two steps exists in the half of the interval next to that step, moves
 * with the velocity that it has in this step, and keeps its values. Particles are in the order of
 * the nearer step (in the middle: of the later one).
 *
 * Ids and velocities are point arrays, found by their usual names (see mcor_name_priority in
 * mcor.h) unless they are named; ids are also found as the active global ids. Without ids, or if
 * two particles share one, it is an error to request a time between two steps. Without velocities
 * (or with UseVelocities off) positions are linear in time, and particles of only one step stay
 * where they are. Velocities are not used either, with a warning, if the particles (100 or more)
 * moved less than half or more than twice as far as their mean velocities say, see TimeScale.
 *
 * The output is a vtkPolyData with the points and point arrays; if the input has cells, each
 * particle is a vertex. Composite data must have the same tree in both steps, and give composite
 * data. Arrays that only one of the two steps has are left out between them, with a warning.
 *
 * @sa
 * vtkMarchingCorrectors vtkTemporalInterpolator
 */

#ifndef vtkSPHTemporalInterpolator_h
#define vtkSPHTemporalInterpolator_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSPHAlgorithm.h" // For macros

#include <memory> // For the pairs of blocks
#include <string> // For members

VTK_ABI_NAMESPACE_BEGIN
class vtkDataObject;
class vtkDataObjectTree;
class vtkPolyData;

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHTemporalInterpolator
  : public vtkPolyDataAlgorithm
{
public:
  static vtkSPHTemporalInterpolator* New();
  vtkTypeMacro(vtkSPHTemporalInterpolator, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The point array of particle ids: whole numbers of any type, each occurring once. Empty (the
   * default): found by name.
   */
  vtkSPHTextMacro(IdArrayName, "");

  /** The point array of velocities, with three components. Empty (the default): found by name. */
  vtkSPHTextMacro(VelocityArrayName, "");

  /** Positions follow the velocities; if this is off, positions are linear in time. On by default. */
  vtkSPHFlagMacro(UseVelocities, 1);

  /**
   * The unit of the steps' times in the time unit of the velocities: 0.01 where steps are numbered
   * 0, 1, 2, ... and stored every 0.01 s. > 0, 1 by default.
   */
  vtkSPHValueMacro(TimeScale, double, 1.0);

  ///@{
  /**
   * The lower and the upper side of one period along x, y and z; 0, 0 (the default): none. Particles
   * that cross a side go on beyond it. DetectPeriod (off by default): see vtkSPHAlgorithm.
   */
  vtkSPHVector6Macro(PeriodicBounds, double, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  vtkSPHFlagMacro(DetectPeriod, 0);
  ///@}

  /** The number of steps that are announced for each interval between stored ones, 1 by default. */
  vtkSPHClampMacro(ResampleFactor, int, 1, 1, 1000000);

  ///@{
  /** The arrays that the last update used; empty if none was used, as at the time of a stored step. */
  vtkSPHToldMacro(UsedIdArrayName);
  vtkSPHToldMacro(UsedVelocityArrayName);
  ///@}

  ///@{
  /**
   * The motion of the particles between the last two steps, divided by the motion that their
   * velocities give. 0 if the velocities fit the motion, or were not compared with it.
   */
  vtkSPHMemberMacro(double MotionRatio = 0.0);
  vtkGetMacro(MotionRatio, double);
  ///@}

  /** Why the last update failed: the sentences of its VTK errors, one a line; empty: it did not fail. */
  vtkSPHToldMacro(ErrorMessage);

protected:
  vtkSPHTemporalInterpolator();
  ~vtkSPHTemporalInterpolator() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

private:
  vtkSPHTemporalInterpolator(const vtkSPHTemporalInterpolator&) = delete;
  void operator=(const vtkSPHTemporalInterpolator&) = delete;

  bool FetchSteps(vtkInformation* input);
  void FillBlocks(vtkDataObjectTree* first, vtkDataObjectTree* second, vtkDataObjectTree* output);
  void Fill(size_t block, vtkDataObject* first, vtkDataObject* second, vtkPolyData* output);
  void Fail(const std::string& message);

  std::string BlockName; // begins the messages about a block of composite data
  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};
VTK_ABI_NAMESPACE_END

#endif

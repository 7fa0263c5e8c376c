// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHTemporalInterpolator
 * @brief   SPH particles at any time between the steps that are stored
 *
 * Readers of simulations offer particles at some times, the stored steps. This filter offers them at
 * any time from the first step to the last: at a stored one as they are, between two of them
 * interpolated. It asks upstream for the two steps around the time and keeps them, so that an
 * animation reads each step once. Its output is what vtkMarchingCorrectors and the other SPH filters
 * take as input.
 *
 * Between two steps at t0 and t1 a particle is recognised by its number, whatever its place in the
 * files. Its position is the cubic Hermite curve through both positions with both velocities as
 * tangents; float and double arrays are interpolated linearly; integers, strings and the numbers
 * themselves are those of the nearer step. A particle that is in one of the two steps alone belongs
 * to the half of the interval next to that step, moves there with the velocity that it has in it, and
 * keeps its values. Particles stand in the order of the nearer step; in the middle, that is the later
 * one.
 *
 * Numbers and velocities are point arrays, found by their usual names (case, blanks, "_" and "-" do
 * not matter) unless they are named; the numbers also as the active global ids:
 *
 *     number     Idp ParticleId ParticleIds PartId id ids GlobalIds GlobalId gid pid iorig
 *     velocity   Velocity Velocities vel v
 *
 * In place of a name, "(automatic)" and "(none)" mean the same as an empty one. Without numbers, or with numbers
 * that two particles share, there is nothing between two steps but an error that says so; stored
 * steps need none. Without a velocity (or with UseVelocities off) positions are linear in time,
 * and particles of one step alone stay where they are. So it is, with a warning, where the velocities
 * do not fit the positions: where the particles (100 or more) moved less than half or more than twice
 * as far as their mean velocities say. Then the steps' times have another unit than the velocities,
 * which TimeScale mends, or are too far apart.
 *
 * The output is a vtkPolyData with the points and point arrays; where the input has cells, each
 * particle is a vertex. Composite data give composite data: block by block, the same tree in both
 * steps. Arrays that only one of the two steps has are left out between them, with a warning.
 *
 * @warning
 * Particles that cross a periodic boundary from one step to the next fly through the whole domain
 * between them.
 *
 * @sa
 * vtkMarchingCorrectors vtkTemporalInterpolator
 */

#ifndef vtkSPHTemporalInterpolator_h
#define vtkSPHTemporalInterpolator_h

#include "vtkAlgorithm.h"
#include "vtkMarchingCorrectorsModule.h" // For export macro

#include <memory> // For the pairs of blocks
#include <string> // For members
#include <vector> // For members

class vtkDataObject;
class vtkDataObjectTree;
class vtkPolyData;

class VTKMARCHINGCORRECTORS_EXPORT vtkSPHTemporalInterpolator : public vtkAlgorithm
{
public:
  static vtkSPHTemporalInterpolator* New();
  vtkTypeMacro(vtkSPHTemporalInterpolator, vtkAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The point array of the particles' numbers: whole numbers of any type, each one once. Empty (the
   * default): found by name.
   */
  vtkSetStdStringFromCharMacro(IdArrayName);
  vtkGetCharFromStdStringMacro(IdArrayName);
  ///@}

  ///@{
  /**
   * The point array of velocities, with three components. Empty (the default): found by name.
   */
  vtkSetStdStringFromCharMacro(VelocityArrayName);
  vtkGetCharFromStdStringMacro(VelocityArrayName);
  ///@}

  ///@{
  /**
   * Positions follow the velocities; off, they are linear in time. On by default.
   */
  vtkSetMacro(UseVelocities, vtkTypeBool);
  vtkGetMacro(UseVelocities, vtkTypeBool);
  vtkBooleanMacro(UseVelocities, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The unit of the steps' times in the time unit of the velocities: 0.01 where steps are numbered
   * 0, 1, 2, ... and stored every 0.01 s. > 0, 1 by default.
   */
  vtkSetMacro(TimeScale, double);
  vtkGetMacro(TimeScale, double);
  ///@}

  ///@{
  /**
   * Into how many steps each interval between two stored ones is divided, for those who ask which
   * steps there are (ParaView's animation does). 1, the default: the stored steps alone. Every other
   * time can be asked for, too.
   */
  vtkSetClampMacro(ResampleFactor, int, 1, 1000000);
  vtkGetMacro(ResampleFactor, int);
  ///@}

  ///@{
  /**
   * The arrays used for the last time between two steps; empty if there was none, or no velocity.
   */
  vtkGetCharFromStdStringMacro(UsedIdArrayName);
  vtkGetCharFromStdStringMacro(UsedVelocityArrayName);
  ///@}

  /**
   * The sentence that says why the last update failed; empty if it did not. It is also reported as a
   * VTK error.
   */
  vtkGetCharFromStdStringMacro(ErrorMessage);

  /**
   * Particles without a time, which are passed on.
   */
  void SetInputData(vtkDataObject* particles);

  /**
   * The output, nullptr where it is composite.
   */
  vtkPolyData* GetOutput();

protected:
  vtkSPHTemporalInterpolator();
  ~vtkSPHTemporalInterpolator() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  std::string IdArrayName;
  std::string VelocityArrayName;
  vtkTypeBool UseVelocities = 1;
  double TimeScale = 1.0;
  int ResampleFactor = 1;
  std::string UsedIdArrayName;
  std::string UsedVelocityArrayName;

private:
  vtkSPHTemporalInterpolator(const vtkSPHTemporalInterpolator&) = delete;
  void operator=(const vtkSPHTemporalInterpolator&) = delete;

  int RequestDataObject(vtkInformation* input, vtkInformation* output);
  int RequestInformation(vtkInformation* input, vtkInformation* output);
  int RequestUpdateExtent(vtkInformation* input, vtkInformation* output);
  int RequestData(vtkInformation* input, vtkInformation* output);
  bool FetchSteps(vtkInformation* input);
  bool FillBlocks(vtkDataObjectTree* first, vtkDataObjectTree* second, vtkDataObjectTree* output);
  bool Fill(size_t block, vtkDataObject* first, vtkDataObject* second, vtkPolyData* output);
  int Fail(const std::string& message);

  std::string ErrorMessage;
  std::string BlockName; // begins the messages about a block of composite data
  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif

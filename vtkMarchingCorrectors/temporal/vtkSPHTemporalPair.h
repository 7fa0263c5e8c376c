// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: the same particles at two times, and interpolation between them. */
#ifndef vtkSPHTemporalPair_h
#define vtkSPHTemporalPair_h

#include "vtkDataArray.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cstdint>
#include <string>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
/** The user's choices, and the ascending times of the two steps. */
struct vtkSPHTemporalChoice
{
  std::string IdArrayName;
  std::string VelocityArrayName;
  bool UseVelocities = true;
  double TimeScale = 1.0;
  double Times[2] = { 0.0, 1.0 };
  double Period[3] = { 0.0, 0.0, 0.0 }; // 0: not periodic
};

/** Copies points, point arrays and field data. If the set has cells, each point gets a vertex. */
void vtkSPHTemporalCopy(vtkPointSet* particles, vtkPolyData* output);

class vtkSPHTemporalPair
{
public:
  /**
   * Matches the particles of two steps. If the steps are the same as in the last call, keeps the
   * last match. Returns false if the particles cannot be matched; Error then says why.
   */
  bool Match(vtkPointSet* first, vtkPointSet* second, const vtkSPHTemporalChoice& choice);

  /** Makes the particles at a time between the steps, after a Match(). */
  void Interpolate(double time, vtkPolyData* output) const;

  std::string Error;
  std::vector<std::string> Warnings; // warnings of the last Match(); empty if it kept the match
  double Ratio = 0.0; // motion / motion by the velocities, if they do not fit; else 0
  std::string IdName, VelocityName;  // names of the arrays used

private:
  struct Step
  {
    vtkSmartPointer<vtkPointSet> Particles;
    vtkSmartPointer<vtkDataArray> Ids, Velocities; // null: not used
    std::vector<vtkIdType> Partners; // number of each particle in the other step; -1: it has none
  };

  bool MatchNumbers();
  bool FindIds();
  bool FindVelocities();
  bool Find(const std::string& role, const std::string& name, int components,
    vtkSmartPointer<vtkDataArray> Step::*member);
  void CheckVelocities();
  void WarnOfLostArrays();
  bool IsInBoth(vtkAbstractArray* array) const;
  std::string NameOfStep(int step) const;
  /** Returns the way along an axis to the nearest image of a point. way: the way to the point itself. */
  double Nearest(double way, int axis) const;

  Step Steps[2];
  vtkSPHTemporalChoice Choice;
  bool FollowsVelocities = false;
  std::vector<std::uint64_t> Signature; // state of the data that were matched
};
VTK_ABI_NAMESPACE_END

#endif

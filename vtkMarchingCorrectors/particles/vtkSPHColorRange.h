// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module and the program: the colour range that a picture has at first. */
#ifndef vtkSPHColorRange_h
#define vtkSPHColorRange_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkType.h"

#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
class vtkDataArray;
class vtkDataSet;

/**
 * Finds the range of values without the lowest and the highest 1 %. Values count by the area of a
 * surface, by the length of lines, or by the number of points of other data. So a few fast drops or
 * sharp corners do not decide all colours.
 */
class VTKMARCHINGCORRECTORS_EXPORT vtkSPHColorRange
{
public:
  /** isLeftOut, for data without polygons and lines: marks the points that do not count; empty: all count. */
  explicit vtkSPHColorRange(vtkDataSet* data, const std::vector<bool>& isLeftOut = {});

  /**
   * Finds the range of most values of a point array, or of its vectors' magnitudes. For iso values,
   * or if most values are equal, finds the range of all values. Returns false if no value is
   * finite.
   */
  bool Find(vtkDataArray* array, double range[2]) const;

private:
  std::vector<std::pair<vtkIdType, double>> Samples; // points and their shares
  vtkDataArray* IsoValues;
};
VTK_ABI_NAMESPACE_END

#endif

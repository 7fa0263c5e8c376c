// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHResample
 * @brief   the field of SPH particles on a slice, along a line or in a volume
 *
 * vtkSPHResample is a vtkSPHProbe that makes its own points; the particles are its only input:
 *
 *     SLICE (default)   quads that cover the part of a plane in the box of the fluid's particles
 *     LINE              points from Point1 to Point2, with their distance from the first as arc_length
 *     VOLUME            a vtkImageData of Bounds
 *
 * With FitBounds (the default) the slice goes through the middle of the fluid, the line goes through
 * the middle along the longest side of the fluid's box, and the volume is this box. All three have a
 * margin of 3 % of the longest side. A slice of particles in a plane always lies in their plane. Where there is
 * no fluid, arrays are NaN, see SetNaNOutside(), and a slice has no quads, see SetOnlyFluid().
 *
 * Blocks of composite data always form one set of particles. If the controller has several
 * processes, each has a part of the volume; a slice or line is on the first one.
 *
 * @sa
 * vtkSPHProbe vtkSPHAlgorithm vtkMarchingCorrectors vtkResampleToImage
 */

#ifndef vtkSPHResample_h
#define vtkSPHResample_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHProbe.h"

VTK_ABI_NAMESPACE_BEGIN
class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHResample : public vtkSPHProbe
{
public:
  static vtkSPHResample* New();
  vtkTypeMacro(vtkSPHResample, vtkSPHProbe);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum ShapeType
  {
    SLICE = 0,
    LINE = 1,
    VOLUME = 2
  };

  ///@{
  /** The kind of points, see ShapeType; SLICE by default. */
  vtkSPHClampMacro(Shape, int, SLICE, SLICE, VOLUME);
  void SetShapeToSlice() { this->SetShape(SLICE); }
  void SetShapeToLine() { this->SetShape(LINE); }
  void SetShapeToVolume() { this->SetShape(VOLUME); }
  ///@}

  /**
   * Fit Origin, Point1 and Point2, or Bounds to the fluid's particles instead of taking what is
   * set. On by default.
   */
  vtkSPHFlagMacro(FitBounds, 1);

  ///@{
  /** A point of a slice and its normal; the ends of a line; the bounds of a volume. Unit L. */
  vtkSPHVector3Macro(Origin, double, 0.0, 0.0, 0.0);
  vtkSPHVector3Macro(Normal, double, 0.0, 0.0, 1.0);
  vtkSPHVector3Macro(Point1, double, 0.0, 0.0, 0.0);
  vtkSPHVector3Macro(Point2, double, 1.0, 0.0, 0.0);
  vtkSPHVector6Macro(Bounds, double, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0);
  ///@}

  /** How many points a line has, or a slice along its longer side; at least 2, 500 by default. */
  vtkSPHClampMacro(Resolution, int, 500, 2, 100000);

  /**
   * How many points a volume has along x, y and z. 0 (the default): about a million points in all,
   * in cells that are about cubes. If particles lie in a plane, one point along the constant axis.
   */
  vtkSPHVector3Macro(Dimensions, int, 0, 0, 0);

  /** Leave out the quads of a slice that have a corner without fluid. On by default. */
  vtkSPHFlagMacro(OnlyFluid, 1);

protected:
  vtkSPHResample();
  ~vtkSPHResample() override = default;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  const char* GetOutputClassName(const char* inputClassName) override;
  void Process(vtkDataObject* input, vtkDataObject* output) override;
  bool TakesTogether() const override { return true; }

private:
  vtkSPHResample(const vtkSPHResample&) = delete;
  void operator=(const vtkSPHResample&) = delete;

  bool FindBounds(vtkPointSet* particles, double bounds[6]);
  vtkSmartPointer<vtkDataSet> MakePoints(const double bounds[6]);

  int UsedDimensions[3] = { 1, 1, 1 };
  int FlatAxis = -1;
};
VTK_ABI_NAMESPACE_END

#endif

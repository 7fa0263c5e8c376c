// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHProjection
 * @brief   column densities of SPH particles: an image of integrals along lines of sight
 *
 * vtkSPHProjection integrates the SPH sum of a scalar, sum V A W, along parallel lines of sight,
 * and gives the mean of the integrals over each pixel of an image, see mcor_project in mcor.h. The
 * image has all of the mass that falls into it.
 *
 * The scalar is a point array; vectors count by their magnitude or by one component, see
 * ScalarComponent. By default the scalar is the density, so that the array of the output is the
 * column density, "ColumnDensity": the sum of m W over the lines of sight, which needs masses, or
 * densities and volumes. Otherwise the array has the scalar's name. With WeightArrayName the array
 * is the mean of the scalar along the line of sight; NaN where there is nothing.
 *
 * If the direction is x, y or z, the image (vtkImageData) lies at the lower end of what is seen, as a
 * slice of the world. Else a direction matrix turns it. Its points are the centres of pixels. The
 * image shows the Box with UseBox, else the period, or all that particles reach.
 *
 * Blocks of composite data always are one set of particles. If the controller has several
 * processes, each has some of the particles, and each gets the part of the image that is asked for,
 * the same to the last bit as from one process.
 *
 * @sa
 * vtkSPHAlgorithm vtkSPHResample
 */

#ifndef vtkSPHProjection_h
#define vtkSPHProjection_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"

#include <string> // For a member

struct mcor_projection;
struct mcor_view;

VTK_ABI_NAMESPACE_BEGIN
class vtkImageData;

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHProjection : public vtkSPHAlgorithm
{
public:
  static vtkSPHProjection* New();
  vtkTypeMacro(vtkSPHProjection, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The direction of the lines of sight; its length and sign do not matter. 0, 0, 0 (the default):
   * the constant axis of particles in a plane, else z.
   */
  vtkSPHVector3Macro(Direction, double, 0.0, 0.0, 0.0);

  /** Pixels along the longer side of the image, 1 to 32768; 512 by default. */
  vtkSPHClampMacro(Resolution, int, 512, 1, 32768);

  ///@{
  /**
   * The part that is seen: x0, x1, y0, y1, z0, z1, unit L; sides may be infinite. mcor_view in
   * mcor.h says which particles count. Off by default.
   */
  vtkSPHFlagMacro(UseBox, 0);
  vtkSPHVector6Macro(Box, double, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0);
  ///@}

  /**
   * If an array is named, its values B are weights, and a pixel has the mean of the scalar A that it
   * sees: sum V B A / sum V B. With the array of masses, each particle counts by its mass. Empty (the
   * default): a pixel has the integral itself.
   */
  vtkSPHTextMacro(WeightArrayName, "");

  /**
   * The point array that is integrated. Empty (the default), or "(density)": the array of
   * SetInputArrayToProcess(0, ...), or the density if no array is chosen there.
   */
  vtkSPHTextMacro(ScalarArrayName, "");

  /** The component of a scalar that counts, if it has several; -1 (the default): the magnitude. */
  vtkSPHValueMacro(ScalarComponent, int, -1);

  /** Also leave solid particles out when volumes are computed from positions. Off by default. */
  vtkSPHChoiceFlagMacro(IgnoreSolids);

  vtkImageData* GetImage();

protected:
  vtkSPHProjection() = default;
  ~vtkSPHProjection() override = default;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  const char* GetOutputClassName(const char*) override { return "vtkImageData"; }
  void Process(vtkDataObject* input, vtkDataObject* output) override;
  bool TakesTogether() const override { return true; }

private:
  vtkSPHProjection(const vtkSPHProjection&) = delete;
  void operator=(const vtkSPHProjection&) = delete;

  mcor_view MakeView() const;
  void Fill(vtkImageData* image, const std::string& name, mcor_projection& found);
};
VTK_ABI_NAMESPACE_END

#endif

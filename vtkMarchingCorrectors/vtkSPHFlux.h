// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHFlux
 * @brief   what flows through sections of SPH particles
 *
 * vtkSPHFlux measures how much fluid flows through sections: it integrates the Shepard means of
 * velocity and density over the part of a section that is in fluid, see mcor_flux in mcor.h.
 * vtkSPHMeter says what is fluid.
 *
 * Sections come from the Add...() methods and from the cells of the second input: polygons, with
 * normals by the right-hand rule, or outwards if they are a closed surface; lines, if particles lie
 * in a plane. Cells with the same entry in the cell array "Name" are one section; without such an
 * array, all cells are one section. Without any section and without a second input, the disc of
 * Origin, Normal and Radius is used.
 *
 * In two dimensions a section is its line in the plane of the particles, and areas are lengths.
 *
 * The output is a vtkTable with a row for each section:
 *
 *     time         of the particles
 *     section      the name
 *     area         of the part of the section in fluid
 *     volume_flux  the integral of v . n over this part, n being the normal
 *     mass_flux    the integral of rho v . n over this part; NaN without densities
 *     velocity     volume_flux / area; NaN where the area is 0
 *
 * The density is the density array, the constant Density, or mass / volume if both are given.
 *
 * @sa
 * vtkSPHMeter vtkSPHGauge vtkMarchingCorrectors
 */

#ifndef vtkSPHFlux_h
#define vtkSPHFlux_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHMeter.h"

VTK_ABI_NAMESPACE_BEGIN
class vtkDataSet;

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHFlux : public vtkSPHMeter
{
public:
  static vtkSPHFlux* New();
  vtkTypeMacro(vtkSPHFlux, vtkSPHMeter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** More sections; may be nullptr. */
  void SetSectionsConnection(vtkAlgorithmOutput* sections)
  {
    this->SetInputConnection(1, sections);
  }
  void SetSectionsData(vtkDataObject* sections) { this->SetInputData(1, sections); }

  ///@{
  /**
   * Sections by name. Names must differ. mcor_section_shape in mcor.h says which way the normals
   * point. A rectangle has a corner and the ends of the two edges from this corner. The bounds of a
   * box are x0, x1, y0, y1, z0, z1. A line is for two dimensions. A surface has the polygons, or
   * lines, of a data set.
   */
  void AddRectangle(
    const char* name, const double corner[3], const double end1[3], const double end2[3]);
  void AddDisc(const char* name, const double center[3], const double normal[3], double radius);
  void AddBox(const char* name, const double bounds[6]);
  void AddLine(const char* name, const double point1[3], const double point2[3]);
  void AddSurface(const char* name, vtkDataSet* surface);
  void ClearSections() { this->ClearPlaces(); }
  int GetNumberOfSections() const { return static_cast<int>(this->Places.size()); }
  ///@}

  ///@{
  /** The centre, normal and radius of the disc that is used if there are no other sections. */
  vtkSPHVector3Macro(Origin, double, 0.0, 0.0, 0.0);
  vtkSPHVector3Macro(Normal, double, 1.0, 0.0, 0.0);
  vtkSPHValueMacro(Radius, double, 1.0);
  ///@}

  /** The point array of velocities. Empty (the default): found by name, also as vx, vy and vz. */
  vtkSPHTextMacro(VelocityArrayName, "");

protected:
  vtkSPHFlux() = default;
  ~vtkSPHFlux() override = default;

  const char* GetNoun() const override { return "section"; }
  const char* GetConsequence() const override { return "nothing flows"; }
  std::vector<Place> ListPlaces(vtkDataObject* more) override;
  vtkSPHWanted GetWanted() const override;
  int Measure(mcor_context* context, const mcor_input& input, const mcor_options& options,
    const std::vector<Place>& places, vtkTable* table, std::vector<bool>& outside,
    mcor_statistics& statistics) const override;

private:
  vtkSPHFlux(const vtkSPHFlux&) = delete;
  void operator=(const vtkSPHFlux&) = delete;
};
VTK_ABI_NAMESPACE_END

#endif

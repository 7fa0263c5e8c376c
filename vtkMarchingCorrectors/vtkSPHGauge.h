// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHGauge
 * @brief   where lines cross the free surface of SPH particles: water levels
 *
 * vtkSPHGauge measures the free surface of SPH particles along straight lines, as a wave gauge in a
 * tank does, see mcor_gauge in mcor.h. vtkSPHMeter says what is fluid.
 *
 * The lines come from AddGauge() and from the line cells of the second input, each from its first
 * point to its last. If there are none, and no second input, the only line goes from Point1 to
 * Point2. Gauges of the second input have the names of its cell array "Name", if there is one;
 * else their names are "line" and the number of the cell.
 *
 * The output is a vtkTable with a row for each gauge:
 *
 *     time        of the particles
 *     gauge       the name
 *     state       dry: no fluid on the line; full: fluid at its end; wet: else
 *     first       distance from the line's beginning to where fluid first ends
 *     last        distance to where fluid last ends; for a full gauge, the length of the line
 *     depth       length of the line that is in fluid
 *     crossings   how often the line goes through the surface
 *     x, y, z     the place of `last`
 *
 * For a dry gauge, first, last, x, y and z are NaN, and depth and crossings are 0. Lengths have the
 * unit of the positions.
 *
 * @sa
 * vtkSPHMeter vtkSPHFlux vtkMarchingCorrectors
 */

#ifndef vtkSPHGauge_h
#define vtkSPHGauge_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHMeter.h"

VTK_ABI_NAMESPACE_BEGIN
class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHGauge : public vtkSPHMeter
{
public:
  static vtkSPHGauge* New();
  vtkTypeMacro(vtkSPHGauge, vtkSPHMeter);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** More lines; may be nullptr. */
  void SetLinesConnection(vtkAlgorithmOutput* lines) { this->SetInputConnection(1, lines); }
  void SetLinesData(vtkDataObject* lines) { this->SetInputData(1, lines); }

  ///@{
  /** Gauges by name, each from one place to another. Names must differ. */
  void AddGauge(const char* name, double x0, double y0, double z0, double x1, double y1, double z1)
  {
    this->AddPlace(name, 0, { x0, y0, z0, x1, y1, z1 });
  }
  void ClearGauges() { this->ClearPlaces(); }
  int GetNumberOfGauges() const { return static_cast<int>(this->Places.size()); }
  ///@}

  ///@{
  /** The ends of the line that is used if there are no other lines. (0, 0, 0) and (0, 0, 1) by default. */
  vtkSPHVector3Macro(Point1, double, 0.0, 0.0, 0.0);
  vtkSPHVector3Macro(Point2, double, 0.0, 0.0, 1.0);
  ///@}

protected:
  vtkSPHGauge() = default;
  ~vtkSPHGauge() override = default;

  const char* GetNoun() const override { return "gauge"; }
  const char* GetConsequence() const override { return "all gauges are dry"; }
  std::vector<Place> ListPlaces(vtkDataObject* more) override;
  int Measure(mcor_context* context, const mcor_input& input, const mcor_options& options,
    const std::vector<Place>& places, vtkTable* table, std::vector<bool>& outside,
    mcor_statistics& statistics) const override;

private:
  vtkSPHGauge(const vtkSPHGauge&) = delete;
  void operator=(const vtkSPHGauge&) = delete;
};
VTK_ABI_NAMESPACE_END

#endif

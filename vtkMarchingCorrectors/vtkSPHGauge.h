// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHGauge
 * @brief   where lines cross the free surface of SPH particles: water levels
 *
 * vtkSPHGauge measures the free surface of SPH particles along straight lines, as a wave gauge in a tank
 * does. Fluid is where the sum of the fluid particles' weights is Level or more, as for the free surface
 * of vtkMarchingCorrectors; every crossing of that level is found and solved for, see mcor_gauge in
 * mcor.h. Solids do not count, and do not end the fluid.
 *
 * The lines are those of AddGauge() and the line cells of the second input, each from its first point to its
 * last. If there are none, it is the line from Point1 to Point2. Gauges of the second input have the names of
 * its cell array "Name", if there is one.
 *
 * The output is a vtkTable with a row for each gauge:
 *
 *     time        of the particles
 *     gauge       the name
 *     state       dry: no fluid on the line; full: fluid at its end; wet: else
 *     first       distance from the line's beginning to where fluid first ends
 *     last        distance to where it ends last; for a full gauge, the length of the line
 *     depth       length of the line that is in fluid
 *     crossings   how often the line goes through the surface
 *     x, y, z     the place of `last`
 *
 * For a dry gauge, first, last, x, y and z are NaN, and depth and crossings are 0. Lengths have the unit of the
 * positions.
 *
 * Blocks of composite data are one set of particles, always.
 *
 * If the controller has several processes, they share the work: each has some of the particles, and the lines
 * of all processes are measured. The first process gets the table, the same to the last bit as from one process;
 * the others get one without rows.
 *
 * @sa
 * vtkSPHAlgorithm vtkMarchingCorrectors vtkSPHProbe
 */

#ifndef vtkSPHGauge_h
#define vtkSPHGauge_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"

#include <array>  // For gauges
#include <string> // For gauges
#include <vector> // For gauges

struct mcor_gauge_line;
struct mcor_gauges;

VTK_ABI_NAMESPACE_BEGIN
class vtkDataSet;
class vtkTable;

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHGauge : public vtkSPHAlgorithm
{
public:
  static vtkSPHGauge* New();
  vtkTypeMacro(vtkSPHGauge, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Also leave solid particles out when volumes are computed from positions. Off by default.
   */
  vtkSPHFlagMacro(IgnoreSolids);

  /**
   * The table.
   */
  vtkTable* GetOutput();

  /**
   * More lines; may be nullptr.
   */
  void SetLinesConnection(vtkAlgorithmOutput* lines) { this->SetInputConnection(1, lines); }
  void SetLinesData(vtkDataObject* lines) { this->SetInputData(1, lines); }

  ///@{
  /**
   * Gauges by name, each from one place to another. Names must differ. Lengths have the unit of the
   * positions.
   */
  void AddGauge(const char* name, double x0, double y0, double z0, double x1, double y1, double z1);
  void ClearGauges();
  int GetNumberOfGauges() const;
  ///@}

  ///@{
  /**
   * The line that is used if there are no others. (0, 0, 0) and (0, 0, 1) by default.
   */
  vtkSetVector3Macro(Point1, double);
  vtkGetVector3Macro(Point1, double);
  vtkSetVector3Macro(Point2, double);
  vtkGetVector3Macro(Point2, double);
  ///@}

  /**
   * The weight sum at which the fluid ends, above 0. 0.5 by default.
   */
  vtkSPHValueMacro(Level, double);

  /**
   * The time in the table if the input has none. 0 by default.
   */
  vtkSPHValueMacro(Time, double);

protected:
  vtkSPHGauge();
  ~vtkSPHGauge() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  const char* GetOutputClassName(const char* inputClassName) override;
  void Process(vtkDataObject* input, vtkDataObject* output) override;
  bool TakesTogether() const override { return true; }

  double Point1[3] = { 0.0, 0.0, 0.0 };
  double Point2[3] = { 0.0, 0.0, 1.0 };
  double Level = 0.5;
  double Time = 0.0;

private:
  vtkSPHGauge(const vtkSPHGauge&) = delete;
  void operator=(const vtkSPHGauge&) = delete;

  struct Gauge
  {
    std::string Name;
    std::array<double, 6> Ends; // x, y, z of the one, then of the other
  };
  std::vector<Gauge> ListGauges() const;
  bool CheckNames(const std::vector<Gauge>& gauges);
  void AddLines(vtkDataSet* lines, std::vector<Gauge>& gauges) const;
  static std::vector<mcor_gauge_line> ListLines(const std::vector<Gauge>& gauges);
  void Measure(vtkSPHParticles& input, vtkPointSet* particles, const std::vector<Gauge>& gauges,
    vtkTable* output);
  void Fill(
    vtkTable* output, const std::vector<Gauge>& gauges, const mcor_gauges& found, bool hasFluid);

  // For many processes together.
  void ProcessDistributed(vtkPointSet* particles, vtkTable* output);
  void GaugeDistributed(
    vtkSPHRanksRun& run, vtkSPHParticles& mine, const std::vector<Gauge>& gauges, vtkTable* output);
  static std::vector<Gauge> Merge(vtkSPHRanks& ranks, const std::vector<Gauge>& mine);

  std::vector<Gauge> Gauges;
  vtkDataObject* Lines = nullptr; // while a run lasts
  double InputTime = 0.0;
};
VTK_ABI_NAMESPACE_END

#endif

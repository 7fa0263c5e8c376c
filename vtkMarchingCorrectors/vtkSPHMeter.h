// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHMeter
 * @brief   superclass of the filters that measure the fluid at places with names
 *
 * The output is a vtkTable with a row for each place, also if only a part of the table is requested.
 * Fluid is where the sum of the particles' weights is Level or more. Unless IgnoreSolids is on, solids
 * count in this sum, and the fluid ends where solids weigh more than fluid, as for the free surface of
 * vtkMarchingCorrectors with SOLIDS_WALL. Blocks of composite data are always one set of particles.
 *
 * If the controller has several processes, they share the work: each has some of the particles, and
 * the places of all processes are measured. The first process gets the table, the same to the last
 * bit as from one process; the tables of other processes have no rows.
 *
 * @sa
 * vtkSPHGauge vtkSPHFlux
 */

#ifndef vtkSPHMeter_h
#define vtkSPHMeter_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"

#include <string> // For places
#include <vector> // For places

struct mcor_context;
struct mcor_input;
struct mcor_statistics;

VTK_ABI_NAMESPACE_BEGIN
class vtkDataSet;
class vtkTable;
struct vtkSPHWanted;

class VTKMARCHINGCORRECTORS_EXPORT vtkSPHMeter : public vtkSPHAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkSPHMeter, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** Leave solid particles out of the sum of weights and of computed volumes. Off by default. */
  vtkSPHChoiceFlagMacro(IgnoreSolids);

  /** Returns the table with a row for each place. */
  vtkTable* GetOutput();

  /** The weight sum at which the fluid ends, above 0. 0.5 by default. */
  vtkSPHValueMacro(Level, double, 0.5);

  /** The time in the table if neither the input nor the pipeline's request has a time. 0 by default. */
  vtkSPHValueMacro(Time, double, 0.0);

protected:
  vtkSPHMeter();
  ~vtkSPHMeter() override = default;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  const char* GetOutputClassName(const char*) override { return "vtkTable"; }
  void Process(vtkDataObject* input, vtkDataObject* output) override;
  bool TakesTogether() const override { return true; }

  /** A place to measure at: points, or a centre, a normal and a radius. */
  struct Place
  {
    std::string Name;
    int Shape = 0;
    std::vector<double> Numbers;
  };

  void AddPlace(const char* name, int shape, std::vector<double> numbers);
  void ClearPlaces()
  {
    this->Places.clear();
    this->Modified();
  }

  /** Returns the cell's entry in the cell array "Name"; `usual` where there is no such array. */
  static std::string NameOf(vtkDataSet* data, vtkIdType cell, const std::string& usual);

  std::vector<Place> Places; // the places that were added

  ///@{
  /**
   * Each subclass gives its word for one place ("gauge"), its words for the consequence of no
   * fluid, its places on this process (more: the second input, or null), and the particle arrays
   * that it needs.
   */
  virtual const char* GetNoun() const = 0;
  virtual const char* GetConsequence() const = 0;
  virtual std::vector<Place> ListPlaces(vtkDataObject* more) = 0;
  virtual vtkSPHWanted GetWanted() const;
  ///@}

  /**
   * Calls the core, and returns its status. Adds the table's columns behind the columns of time and
   * name. outside: marks the places that no particle reaches.
   */
  virtual int Measure(mcor_context* context, const mcor_input& input, const mcor_options& options,
    const std::vector<Place>& places, vtkTable* table, std::vector<bool>& outside,
    mcor_statistics& statistics) const = 0;

private:
  vtkSPHMeter(const vtkSPHMeter&) = delete;
  void operator=(const vtkSPHMeter&) = delete;

  bool CheckNames(const std::vector<Place>& places);
  static std::vector<Place> Merge(vtkRun& run, const std::vector<Place>& mine);
};
VTK_ABI_NAMESPACE_END

#endif

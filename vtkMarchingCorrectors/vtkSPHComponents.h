// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHComponents
 * @brief   the pieces of a surface: drops, bubbles, their volumes and particles
 *
 * vtkSPHComponents divides a surface of vtkMarchingCorrectors into connected pieces: triangles that
 * share points are one piece, also across the sides of a period. Its first output is the surface
 * with the point and cell array "ComponentId", 0 for the piece of the largest area, and the cell
 * array "ComponentVolume". The second output is a vtkTable with a row for each piece.
 * Documentation/Guide/pieces.md explains its columns: component, iso, parent, closed, area, volume,
 * x, y, z, xmin, xmax, ymin, ymax, zmin, zmax, diameter, particles, mass, vx, vy, vz.
 *
 * A value that does not apply is NaN; a piece without a parent has -1. The last five columns need
 * the particles, the second input, and are filled for each closed piece with fluid inside. Pieces
 * below LeastVolume or LeastParticles are left out, with the cavities in them. Open pieces, which
 * have no volume and no particles, stay.
 *
 * With PeriodicBounds, a piece ends at a side of the period only where it has a cap there. A particle
 * counts in the piece that encloses an image of the particle.
 *
 * If the controller has several processes, each gets its part of the surface with ComponentId, and
 * the first one gets the table, the same as from one process; the tables of other processes have no
 * rows. The first process collects all points, triangles and particles.
 *
 * @sa
 * vtkMarchingCorrectors vtkConnectivityFilter vtkMassProperties
 */

#ifndef vtkSPHComponents_h
#define vtkSPHComponents_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkSPHAlgorithm.h"             // For macros
#include "vtkSmartPointer.h"             // For particles

#include <string> // For members
#include <vector> // For pieces

VTK_ABI_NAMESPACE_BEGIN
class vtkMultiProcessController;
class vtkSPHPieces;
class vtkSPHRanks;
class vtkTable;

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkSPHComponents : public vtkPolyDataAlgorithm
{
public:
  static vtkSPHComponents* New();
  vtkTypeMacro(vtkSPHComponents, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /** The particles; may be nullptr. Blocks of composite data are one set. */
  void SetParticlesConnection(vtkAlgorithmOutput* particles)
  {
    this->SetInputConnection(1, particles);
  }
  void SetParticlesData(vtkDataObject* particles) { this->SetInputData(1, particles); }
  ///@}

  /** Returns the table, the second output. */
  vtkTable* GetTable();

  /** Lower and upper sides of one period along each axis; 0 and 0 (the default): none. */
  vtkSPHVector6Macro(PeriodicBounds, double, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);

  ///@{
  /** Closed pieces of a smaller volume, or with fewer particles, are left out. 0 by default. */
  vtkSPHClampMacro(LeastVolume, double, 0.0, 0.0, VTK_DOUBLE_MAX);
  vtkSPHClampMacro(LeastParticles, vtkIdType, 0, 0, VTK_ID_MAX);
  ///@}

  ///@{
  /** Arrays of the particles; empty (the default): found by name. Mass, if above 0: one mass for all particles. */
  vtkSPHTextMacro(MassArrayName, "");
  vtkSPHValueMacro(Mass, double, 0.0);
  vtkSPHTextMacro(VelocityArrayName, "");
  ///@}

  ///@{
  /**
   * Particles with another value than FluidValue in this array are solid, and do not count. Empty
   * (the default): all count, or DetectFluid (off by default) finds the array, see vtkSPHAlgorithm.
   */
  vtkSPHTextMacro(FluidArrayName, "");
  vtkSPHValueMacro(FluidValue, double, 0.0);
  vtkSPHFlagMacro(DetectFluid, 0);
  ///@}

  ///@{
  /** The processes that share a run; VTK's global controller by default. */
  virtual void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

protected:
  vtkSPHComponents();
  ~vtkSPHComponents() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  vtkMultiProcessController* Controller = nullptr;

private:
  vtkSPHComponents(const vtkSPHComponents&) = delete;
  void operator=(const vtkSPHComponents&) = delete;

  struct Content;

  /// For each point and each triangle the number of its piece; -1: the piece is left out.
  struct Numbers
  {
    std::vector<vtkIdType> OfPoint, OfTriangle;
    std::vector<double> Volumes; ///< of the pieces that stay, by number
  };
  Numbers Split(vtkPolyData* mesh, vtkPointSet* particles, vtkTable* table) const;
  std::vector<Content> Count(const vtkSPHPieces& pieces, vtkPointSet* particles) const;
  std::vector<vtkIdType> Choose(
    const vtkSPHPieces& pieces, const std::vector<Content>& contents) const;
  static void Keep(vtkPolyData* mesh, const Numbers& numbers, vtkPolyData* output);
  static std::string FindProblem(vtkPolyData* mesh);

  // Functions for a surface that several processes share.
  std::string SplitDistributed(
    vtkPolyData* mesh, vtkPointSet* particles, vtkPolyData* output, vtkTable* table) const;
  vtkSmartPointer<vtkPointSet> GatherParticles(vtkSPHRanks& ranks, vtkPointSet* particles) const;
};
VTK_ABI_NAMESPACE_END

#endif

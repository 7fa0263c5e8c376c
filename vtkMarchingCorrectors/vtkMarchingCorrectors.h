// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkMarchingCorrectors
 * @brief   generate an isosurface directly from SPH particles
 *
 * vtkMarchingCorrectors generates a triangle mesh that is an isosurface of the continuous field of
 * smoothed particle hydrodynamics (SPH) data: every vertex is moved along its lattice edge until
 * the field has the iso value there. Nothing is resampled to an image, and the lattice is never
 * stored, so memory grows with the surface. The field is one of
 *
 *     Shepard (default)   sum_j V_j A_j W(x - x_j, s h_j) / sum_j V_j W(x - x_j, s h_j)
 *     sum                 sum_j V_j A_j W(x - x_j, s h_j)       (ShepardNormalizationOff)
 *     weight sum          sum_j V_j     W(x - x_j, s h_j)       (FreeSurfaceOn)
 *
 * with positions x_j, smoothing lengths h_j, volumes V_j, a scalar A_j, a kernel W and s =
 * HScaleFactor. What is beyond the fluid is trimmed, and all other point arrays are evaluated at
 * the vertices. See the paper "Marching Correctors - Fast and Precise Polygonal Isosurfaces of SPH
 * Data" by Schindler, Fuchs, Waser, Peikert. 6th International SPHERIC Workshop, Hamburg, 2011.
 *
 * The scalar is chosen with SetInputArrayToProcess(0, 0, 0, FIELD_ASSOCIATION_POINTS, name). By
 * default it is the active scalars, unless they do not vary or hold particle ids or types; then
 * velocities, the first vector, or the first scalar that varies. A vector is contoured by its
 * magnitude or by one component (see ScalarComponent). If a second vector is chosen with
 * SetInputArrayToProcess(1, ...), the dot product of the two is contoured. vtkSPHAlgorithm
 * describes how the particles' other quantities are found. All lengths are in the unit of the point
 * coordinates (L below).
 *
 * The output point data holds "Normals", the requested arrays (Compute...), the iso value (see
 * ComputeScalars) and all other point arrays (see InterpolateAttributes). Its active scalars are
 * velocities, the first vector, or the first scalar of the particles that varies on the surface. With
 * several iso values, the iso value comes last among these scalars. The output field data holds the
 * arrays of the input's field data, and "IsoValues", whose component has the name of the point array
 * that gives each point's iso value. GetRunStatistics() holds statistics of the run, "Device" and
 * "Platform", and for each parameter the value in use. Everything except the device, the platform
 * and the costs of the run depends only on the input and the properties.
 *
 * If processes share a run, see SetController(), each gets the part of the surface in its share of
 * space. "GlobalPointIds" and "GlobalCellIds" number points and triangles in the whole surface.
 * GetRunStatistics() describes the whole surface, and has "RankParticles", "RankCopies",
 * "RankBytesSent", "RankWork", "RankNodesEvaluated", "RankTriangles", "RankSeconds" and, for lengths
 * or densities by neighbours, "RankNeighbors", with one component per process.
 *
 * @warning
 * Every piece of the input is contoured by itself, unless processes share the surface. Ghosts and
 * other particles of a neighbouring piece are particles like all others: without them the surface
 * is trimmed at the cut, and with them both pieces have the surface there.
 *
 * @warning
 * An observer of the progress may change the filter while an update runs, but not the values in the
 * input's arrays; the change takes effect if Modified() is called after the update.
 *
 * @sa
 * vtkSPHAlgorithm vtkSPHInterpolator vtkContourFilter vtkFlyingEdges3D vtkContourValues
 */

#ifndef vtkMarchingCorrectors_h
#define vtkMarchingCorrectors_h

#include "vtkContourValues.h"            // Passes calls through
#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkNew.h"                      // For members
#include "vtkSPHAlgorithm.h"
#include "vtkTimeStamp.h" // For members

#include <limits> // For members

struct mcor_input;
struct mcor_statistics;
struct mcor_surface;

VTK_ABI_NAMESPACE_BEGIN
class vtkPointSet;

/** Declares the setters and getters of contour values; getters return `usual` if there are none. */
#define vtkSPHContoursMacro(name, number, values, usual)                                           \
  void Set##name(int i, double value) { this->values->SetValue(i, value); }                        \
  double Get##name(int i)                                                                          \
  {                                                                                                \
    return this->values->GetNumberOfContours() > 0 ? this->values->GetValue(i) : usual;            \
  }                                                                                                \
  void SetNumberOf##number(int count) { this->values->SetNumberOfContours(count); }                \
  vtkIdType GetNumberOf##number() { return this->values->GetNumberOfContours(); }

class VTKMARCHINGCORRECTORS_EXPORT VTK_MARSHALAUTO vtkMarchingCorrectors : public vtkSPHAlgorithm
{
public:
  static vtkMarchingCorrectors* New();
  vtkTypeMacro(vtkMarchingCorrectors, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum SeedModeType
  {
    COMPLETE = 0, ///< every cell that a bound cannot exclude
    PAIRS = 1     ///< cells between particle pairs on both sides of the iso value
  };

  enum CubeSizeModeType
  {
    UNIFORM = 0, ///< the cube size everywhere
    ADAPTIVE = 1 ///< cube sizes times powers of 2, as fine as the particles are
  };

  enum TopologyType
  {
    TOPOLOGY_TABLE = 0, ///< Marching Cubes' table alone
    TOPOLOGY_FIELD = 1  ///< the field decides on ambiguous faces and in ambiguous cells
  };

  enum BoundaryDetectionType
  {
    WEIGHT_SUM = 0, ///< sum_j V_j W(x - x_j, s h_j)
    EIGENVALUE = 1  ///< smallest eigenvalue of sum_j V_j (x_j - x) grad W(x - x_j, s h_j)^T
  };

  /** Value of FreeSurface that lets the particles decide. */
  enum
  {
    FREE_SURFACE_AUTO = -1
  };

  enum SolidsType
  {
    SOLIDS_WEIGHT = 0, ///< count in the weight sum used for trimming
    SOLIDS_IGNORE = 1, ///< play no part
    SOLIDS_WALL = 2,   ///< count in that weight sum, and the surface ends at them
    SOLIDS_AUTO = 3    ///< as SOLIDS_WALL for a scalar, as SOLIDS_WEIGHT for the free surface
  };

  /** Value of ScalarComponent that stands for the magnitude of a vector. */
  enum
  {
    MAGNITUDE = -1
  };

  ///@{
  /**
   * Contour values, in the unit of the scalar. Several values give several surfaces in one output.
   * By default there is none (NaN counts as none), and one surface is drawn at the median of the
   * scalar in the fluid, or at another middle value, see mcor_find_iso_value in mcor.h.
   */
  vtkSPHContoursMacro(Value, Contours, ContourValues, 0.0);
  double* GetValues() { return this->ContourValues->GetValues(); }
  void GetValues(double* contourValues) { this->ContourValues->GetValues(contourValues); }
  void GenerateValues(int numContours, double range[2])
  {
    this->ContourValues->GenerateValues(numContours, range);
  }
  void GenerateValues(int numContours, double rangeStart, double rangeEnd)
  {
    this->ContourValues->GenerateValues(numContours, rangeStart, rangeEnd);
  }
  ///@}

  ///@{
  /**
   * Which component of the scalar array to contour; MAGNITUDE (-1, the default; 3 in ParaView's panel)
   * is the Euclidean norm. Not used for arrays with one component.
   */
  vtkSPHValueMacro(ScalarComponent, int, MAGNITUDE);
  void SetScalarComponentToMagnitude() { this->SetScalarComponent(MAGNITUDE); }
  void SetPanelComponent(int component)
  {
    this->SetScalarComponent(component >= 3 ? static_cast<int>(MAGNITUDE) : component);
  }
  ///@}

  /**
   * Divide the SPH sum of the scalar by the sum of the weights (Shepard). On by default; off gives
   * the plain sum of the paper, which falls to 0 at a free surface, so that a sheet may arise there.
   */
  vtkSPHFlagMacro(ShepardNormalization, 1);

  /**
   * Contour the weight sum instead of a scalar: about 1 in the fluid, falling to 0 outside. When on,
   * the scalar, the contour values and the thresholds are not used. The default, FREE_SURFACE_AUTO:
   * on if neither a scalar nor a contour value is given, and mcor_has_free_surface() returns 1.
   */
  vtkSPHClampMacro(FreeSurface, int, FREE_SURFACE_AUTO, FREE_SURFACE_AUTO, 1);
  vtkBooleanMacro(FreeSurface, int);

  ///@{
  /**
   * The weight sum at which the free surface is drawn, no unit; 0.5 by default. The indexed forms
   * draw several surfaces in one run.
   */
  void SetFreeSurfaceValue(double value);
  double GetFreeSurfaceValue() { return this->GetFreeSurfaceValue(0); }
  vtkSPHContoursMacro(FreeSurfaceValue, FreeSurfaceValues, FreeSurfaceValues, 0.5);
  ///@}

  ///@{
  /**
   * CubeSizeFactor: the size of the virtual grid's cubes, divided by the smallest smoothing length
   * (unscaled). No unit, > 0, 0.5 by default; 0.5 to 1 is sensible. CubeSize sets the size itself,
   * unit L. If CubeSize is 0 (the default), CubeSizeFactor is used; the lattice may then differ
   * between time steps or pieces.
   */
  vtkSPHValueMacro(CubeSizeFactor, double, 0.5);
  vtkSPHValueMacro(CubeSize, double, 0.0);
  ///@}

  ///@{
  /**
   * UNIFORM: cubes of one size. ADAPTIVE (the default): where all smoothing lengths are at least 2,
   * 4, ... times the smallest one, cubes are 2, 4, ... times as large, see MCOR_CUBE_LEVELS in
   * mcor.h. The surface is closed where cubes of different sizes meet. CubeLevelLimit: the largest
   * cubes are at most 2 to this power times as large; 0 to 24 (the default).
   */
  vtkSPHClampMacro(CubeSizeMode, int, ADAPTIVE, UNIFORM, ADAPTIVE);
  void SetCubeSizeModeToUniform() { this->SetCubeSizeMode(UNIFORM); }
  void SetCubeSizeModeToAdaptive() { this->SetCubeSizeMode(ADAPTIVE); }
  vtkSPHClampMacro(CubeLevelLimit, int, 24, 0, 24);
  ///@}

  ///@{
  /**
   * Draw only the cells with their centres in a box; off by default. Box: x0, x1, y0, y1, z0, z1,
   * unit L; sides may be infinite. The result is exactly that part of the whole surface, so boxes
   * side by side make up the whole. The panel shows the box's lower corner and its lengths.
   */
  vtkSPHFlagMacro(UseBox, 0);
  vtkSPHVector6Macro(Box, double, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0);
  void SetPanelBoxPosition(double x, double y, double z)
  {
    const double* b = this->Box;
    this->SetBox(x, x + b[1] - b[0], y, y + b[3] - b[2], z, z + b[5] - b[4]);
  }
  void SetPanelBoxLength(double x, double y, double z)
  {
    const double* b = this->Box;
    this->SetBox(b[0], b[0] + x, b[2], b[2] + y, b[4], b[4] + z);
  }
  ///@}

  /**
   * Close the surface where values above the iso value meet the sides of the period, or of the cells
   * that UseBox draws: with flat triangles, in two dimensions with straight lines. Trimming and walls
   * may leave the surface open. Off by default. Cannot be combined with PAIRS or Filled.
   */
  vtkSPHFlagMacro(Capping, 0);

  /**
   * For particles in a plane: also fill the region above the lowest iso value, within the trimmed
   * fluid, with triangles that share the points of the lines. The other values divide the region
   * into bands. The cell array "BandValue" has a line's iso value, or the iso value at which a
   * triangle's band begins. The point array "IsoValue" has a line's iso value at the line's points;
   * at points between lines, the iso value at which the point's band begins. Off by default. An
   * update fails if the particles do not lie in a plane.
   */
  vtkSPHFlagMacro(Filled, 0);

  ///@{
  /**
   * How the march is seeded. COMPLETE, the default, misses nothing that Marching Cubes on the full
   * lattice would find; a free surface always has COMPLETE seeds. PAIRS is for comparisons with the
   * paper: it finds only parts of the surface that pass between two close particles, and is an error
   * with cubes of several sizes, a box, caps or several processes.
   */
  vtkSPHClampMacro(SeedMode, int, COMPLETE, COMPLETE, PAIRS);
  void SetSeedModeToComplete() { this->SetSeedMode(COMPLETE); }
  void SetSeedModeToPairs() { this->SetSeedMode(PAIRS); }
  ///@}

  ///@{
  /**
   * How the corners of a cell are connected where their values are ambiguous. TOPOLOGY_TABLE (the
   * default) keeps the higher values apart, and makes no tunnels through cells. TOPOLOGY_FIELD
   * evaluates the field in such cells, so that thin bridges and tunnels are where the field has them.
   */
  vtkSPHClampMacro(Topology, int, TOPOLOGY_TABLE, TOPOLOGY_TABLE, TOPOLOGY_FIELD);
  void SetTopologyToTable() { this->SetTopology(TOPOLOGY_TABLE); }
  void SetTopologyToField() { this->SetTopology(TOPOLOGY_FIELD); }
  ///@}

  /** For a quick look: vertices are interpolated linearly and not corrected, and normals come from the triangles. Off by default. */
  vtkSPHFlagMacro(Preview, 0);

  /**
   * A compact contour: vertices that belong to one node of the virtual grid become one vertex,
   * which is corrected along the gradient. The contour has a quarter fewer triangles, hardly any
   * slivers, and the same pieces. Vertices at borders, caps and periodic sides stay. Off by
   * default. Cannot be combined with Filled.
   */
  vtkSPHFlagMacro(Compact, 0);

  /** For smooth pictures: turns Compact on, and uses a Widening of 2 unless Widening is set. Off by default. */
  vtkSPHFlagMacro(Smooth, 0);

  /**
   * If above 1, each particle's smoothing length is multiplied by a factor: the greatest one, up to
   * this value, with which the particle stays inside the free surface. The surface of calm water
   * becomes flat; drops, threads and sheets stay. The array Widening holds the factor. From 1 (off,
   * the default) to 4; 2 is usual.
   */
  vtkSPHValueMacro(Widening, double, 1.0);

  /**
   * Writes the particles that a run with this filter's settings would take, with the arrays
   * Widening (the factors), WidenedSmoothingLength (the products) and, if volumes are computed,
   * WideningVolume. Returns false, and leaves `output` as it is, after an error, after a warning
   * that there is no fluid, if there are no particles, or if the run was cancelled. If several
   * processes share the filter's runs, all must call this together; each gets its own particles.
   */
  bool Widen(vtkPointSet* particles, vtkPolyData* output);

  /**
   * End the surface where the fluid ends (see VertexThreshold), and at walls (see Solids). On by
   * default. Off also keeps the triangles beyond these ends, except where NodeThreshold discards
   * cells. The free surface is not trimmed.
   */
  vtkSPHFlagMacro(Trim, 1);

  /** Cells with a node whose weight sum is lower than this are discarded. No unit, 0.1 by default. */
  vtkSPHValueMacro(NodeThreshold, double, 0.1);

  ///@{
  /**
   * Triangles are trimmed where the weight sum, or the EIGENVALUE of Marrone et al., is lower than
   * VertexThreshold. No unit; WEIGHT_SUM and 0.5 by default. Both are about 1 inside and fall to 0
   * outside, but the eigenvalue needs another threshold, such as 0.3: see mcor_boundary_detection
   * in mcor.h.
   */
  vtkSPHClampMacro(BoundaryDetection, int, WEIGHT_SUM, WEIGHT_SUM, EIGENVALUE);
  void SetBoundaryDetectionToWeightSum() { this->SetBoundaryDetection(WEIGHT_SUM); }
  void SetBoundaryDetectionToEigenvalue() { this->SetBoundaryDetection(EIGENVALUE); }
  vtkSPHValueMacro(VertexThreshold, double, 0.5);
  ///@}

  ///@{
  /**
   * How solid particles (see SetFluidArrayName) affect where the surface ends. SOLIDS_WEIGHT: the
   * surface continues behind the wall, where the weight sum includes the solids. SOLIDS_IGNORE: the
   * surface ends in front of the wall, where the weight of the fluid alone is VertexThreshold.
   * SOLIDS_WALL: the surface ends where the solids' share of the weight sum exceeds WallShare.
   * SOLIDS_AUTO (the default): see SolidsType.
   */
  void SetSolids(int solids);
  vtkGetMacro(Solids, int);
  ///@}

  /**
   * The solids' share of the weight sum at which the surface ends, above 0 and below 1; 0: it does
   * not end at solids. -1, the default: for a scalar, the median share at the solids that face the
   * fluid, so that the surface ends at these solids; for the free surface 0.5, about half way
   * between fluid particles and solids. GetRunStatistics() reports the share in use.
   */
  vtkSPHValueMacro(WallShare, double, -1.0);

  ///@{
  /**
   * Point arrays of the output; normals and scalars are on by default.
   * - Normals, "Normals": unit length, towards lower values.
   * - Scalars: the iso value. The array has the name of the contoured scalar, such as "Velocity_X" or
   *   "A_Dot_B"; for the free surface, with Filled, or if a computed array has this name, "IsoValue".
   * - Gradients, "Gradients": of the field, unit of the scalar / L.
   * - WeightSum, "WeightSum": the weight used for trimming, no unit.
   * - BoundaryEigenvalue, "BoundaryEigenvalue": no unit, see BoundaryDetection. It is also
   *   computed if BoundaryDetection is WEIGHT_SUM.
   * - Curvature, "MeanCurvature" and "GaussCurvature": of the field's own surface, unit 1 / L and
   *   1 / L^2; the mean curvature of a drop of radius R is 1 / R. In two dimensions there is no
   *   Gaussian curvature.
   * - CorrectionLength, "CorrectionLength": how far the correction moved the vertex, unit L.
   * - Residual, "Residual": field minus iso value at the vertex, unit of the scalar.
   * - BoundaryFlag, "BoundaryFlag": 0 inside, 1 on the trim boundary, 2 on the trim boundary, but only
   *   by linear interpolation, 4 next to a cell that NodeThreshold discarded, 8 on a cap but
   *   not on the surface, or inside a filled region.
   */
  vtkSPHFlagMacro(ComputeNormals, 1);
  vtkSPHFlagMacro(ComputeScalars, 1);
  vtkSPHFlagMacro(ComputeGradients, 0);
  vtkSPHFlagMacro(ComputeWeightSum, 0);
  vtkSPHFlagMacro(ComputeBoundaryEigenvalue, 0);
  vtkSPHFlagMacro(ComputeCurvature, 0);
  vtkSPHFlagMacro(ComputeCorrectionLength, 0);
  vtkSPHFlagMacro(ComputeResidual, 0);
  vtkSPHFlagMacro(ComputeBoundaryFlag, 0);
  ///@}

  /**
   * Interpolate all other point arrays to the surface: float and double arrays by Shepard's method;
   * integers, identifiers and strings from the nearest particle. An array that is not finite at a
   * fluid particle is left out, with a warning. On by default.
   */
  vtkSPHFlagMacro(InterpolateAttributes, 1);

  /**
   * Precision of the output points: vtkAlgorithm::DEFAULT_PRECISION (as the input points, the
   * default), SINGLE_PRECISION or DOUBLE_PRECISION.
   */
  vtkSPHClampMacro(
    OutputPointsPrecision, int, DEFAULT_PRECISION, SINGLE_PRECISION, DEFAULT_PRECISION);

  ///@{
  /**
   * The correction of a vertex stops where |field - iso value| is at most Tolerance times the range
   * of the scalar (no unit, > 0, 1e-6 by default) and the vertex is within 2e-5 cubes of the
   * surface, or after IterationLimit iterations (1 to 255, 30 by default).
   */
  vtkSPHValueMacro(Tolerance, double, 1e-6);
  vtkSPHClampMacro(IterationLimit, int, 30, 1, 255);
  ///@}

  ///@{
  /**
   * Values that the last update used for its only or last block, to be shown in a panel; empty or 0
   * after an error or without fluid. FluidScalarRange: the contoured scalar's range at fluid particles.
   * IsoValueArrayName: the point array that says which iso value each point has, if ComputeScalars
   * is on. SurfaceMeasures: the area and, if the surface is closed, the volume, in words; of lines,
   * length and area. EstimatedCells: about how many cubes of the virtual grid the fluid fills.
   */
  vtkGetVector2Macro(FluidScalarRange, double);
  vtkSPHToldMacro(UsedIsoValues);
  vtkSPHToldMacro(IsoValueArrayName);
  vtkSPHToldMacro(UsedSmoothingLength);
  vtkGetMacro(UsedCubeSize, double);
  vtkSPHToldMacro(SurfaceMeasures);
  vtkGetMacro(EstimatedCells, double);
  ///@}

  ///@{
  /**
   * Values that an update with the present properties and input would find: FluidScalarRange, the
   * default iso value (NaN: not known), the number of components of the chosen array (1 for a dot
   * product), whether there is a free surface, the dimension, EstimatedCells (of all blocks),
   * UsedFluid, the array that is contoured if none is chosen, and a warning of very many cells.
   * Values that are not known are 0 or empty. If processes share a run, one process cannot ask the
   * others without waiting for them. FluidScalarRange, EstimatedCells and UsedFluid are then those
   * of the last update, and the other values are not known.
   */
  double* GetNextScalarRange() VTK_SIZEHINT(2) { return this->LookAhead().ScalarRange; }
  double GetNextIsoValue() { return this->LookAhead().IsoValue; }
  int GetNextComponents() { return this->LookAhead().Components; }
  int GetNextFreeSurface() { return this->LookAhead().FreeSurface; }
  int GetNextDimension() { return this->LookAhead().Dimension; }
  double GetNextCells() { return this->LookAhead().Cells; }
  const char* GetNextFluid() { return this->LookAhead().Fluid.c_str(); }
  const char* GetNextArray() { return this->LookAhead().Array.c_str(); }
  const char* GetNextWarning() { return this->LookAhead().Warning.c_str(); }
  ///@}

protected:
  vtkMarchingCorrectors();
  ~vtkMarchingCorrectors() override = default;

  const char* GetOutputClassName(const char*) override { return "vtkPolyData"; }
  void Process(vtkDataObject* input, vtkDataObject* output) override;

  vtkNew<vtkContourValues> ContourValues;
  vtkNew<vtkContourValues> FreeSurfaceValues;

  int Solids = SOLIDS_AUTO;
  bool DrawsFreeSurface = false; // what FreeSurface says, or, if that is automatic, what was found

  double FluidScalarRange[2] = { 0.0, 0.0 };
  double UsedCubeSize = 0.0;
  double EstimatedCells = 0.0;

private:
  vtkMarchingCorrectors(const vtkMarchingCorrectors&) = delete;
  void operator=(const vtkMarchingCorrectors&) = delete;

  void ContourDistributed(vtkSharedRun& run, vtkSPHParticles& mine, vtkPolyData* output);
  bool TakeWidening(vtkRun& run, vtkSPHParticles& input);
  /** Finds the arrays Widening and, if volumes are computed, WideningVolume of this process's particles; and statistics. */
  bool FindWidening(vtkRun& run, vtkSPHParticles& mine, vtkPointData* found,
    mcor_statistics& statistics);
  void FinishDistributed(vtkSharedRun& run, vtkSPHParticles& input, mcor_options options,
    mcor_surface& surface, vtkPolyData* output);
  /** largestFloat: the greatest result of vtkMarchingCorrectorsOutput::FindLargestFloat() on any rank. */
  void WarnOf(const vtkSPHParticles& input, const mcor_surface& surface,
    const mcor_input& core, const mcor_options& options, double largestFloat);
  bool Take(vtkRun& run, vtkSPHParticles& input);
  void Extract(vtkRun& run, vtkSPHParticles& input, vtkPolyData* output);
  /** Makes the input from the run's own particles. wants: bits of mcor_want, which name the arrays to find. */
  std::unique_ptr<vtkSPHParticles> MakeInput(
    vtkRun& run, const mcor_options& options, unsigned wants);
  void FillOptions(mcor_options& options);
  void ChooseMode(vtkRun& run);
  /** What the next update would find. */
  struct vtkAhead
  {
    double ScalarRange[2] = { 0.0, 0.0 };
    double IsoValue = std::numeric_limits<double>::quiet_NaN();
    int Components = 0, Dimension = 0, FreeSurface = 0;
    double Cells = 0.0;
    std::string Fluid, Array, Warning;
  };
  vtkAhead& LookAhead();
  void WarnOfHugeRun();
  void Summarize(const vtkSPHParticles& input, const mcor_options& options,
    const mcor_statistics& statistics);

  vtkAhead Next;
  vtkTimeStamp LookTime; // when these values were found
};
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkMarchingCorrectors
 * @brief   generate an isosurface directly from SPH particles
 *
 * vtkMarchingCorrectors takes the particles of a smoothed particle hydrodynamics (SPH) simulation
 * and generates a triangle mesh that is an isosurface of the continuous SPH field itself: every
 * vertex is moved along its lattice edge until the field has the iso value there. No image is
 * resampled, and the lattice on which the surface is triangulated is never stored, so memory grows
 * with the surface. The work is done by an OpenCL device (a CPU through PoCL, or a GPU).
 *
 * With particle positions x_j, smoothing lengths h_j, volumes V_j, a scalar A_j and a kernel W, the
 * field is one of
 *
 *     Shepard (default)   sum_j V_j A_j W(x - x_j, s h_j) / sum_j V_j W(x - x_j, s h_j)
 *     sum                 sum_j V_j A_j W(x - x_j, s h_j)       (ShepardNormalizationOff)
 *     weight sum          sum_j V_j     W(x - x_j, s h_j)       (FreeSurfaceOn)
 *
 * where s is HScaleFactor. The algorithm has seven phases:
 *
 * -# Input. The arrays are found (see below), checked for NaN, infinite and illegal values and sent
 *    to the device.
 * -# Search grid. The particles are sorted into a regular grid. It is kept for other scalars and
 *    iso values of the same particles. Volumes are computed if no array gives them.
 * -# Seeds. Cells of the virtual grid through which the surface may pass are selected, see
 *    SeedMode.
 * -# Extraction. Marching Cubes on the seed cells, continued through intersected faces to their
 *    neighbors until no new cell appears. Each node is evaluated once, each intersected lattice
 *    edge gets one vertex.
 * -# Correction. Newton's method along the lattice edge, with the analytic derivative of the field
 *    and safeguarded by the edge's bracket, until the field is within Tolerance of the iso value.
 *    Normals from the analytic gradient, and all other point arrays, are evaluated at the vertices.
 * -# Trimming. Where the weight sum is low there is no fluid to speak of: cells with a node below
 *    NodeThreshold are discarded, triangles are trimmed where the weight sum is VertexThreshold. In
 *    place of the weight sum there, BoundaryDetection can name the boundary eigenvalue.
 * -# Output. The surface is downloaded once, and becomes a vtkPolyData.
 *
 * See the paper "Marching Correctors - Fast and Precise Polygonal Isosurfaces of SPH Data" by
 * Schindler, Fuchs, Waser, Peikert. 6th International SPHERIC Workshop, Hamburg, 2011.
 *
 * The scalar is chosen with SetInputArrayToProcess(0, 0, 0, FIELD_ASSOCIATION_POINTS, name). The default
 * are the active scalars, unless these do not vary, or number particles or their types; then velocities,
 * the first vector, or the first scalar that varies. A vector is contoured by its magnitude or by one component (see
 * ScalarComponent). If a second vector is chosen with SetInputArrayToProcess(1, ...), the dot
 * product of the two is contoured. In free-surface mode no scalar is needed.
 *
 * How the particles are described, and which of their arrays are found by their names, is told by
 * vtkSPHAlgorithm. GetRunStatistics() says what was chosen.
 *
 * The output point data holds "Normals", the arrays asked for ("Gradients", "WeightSum",
 * "BoundaryEigenvalue", "CorrectionLength", "Residual", "BoundaryFlag"), the iso value (see
 * ComputeScalars) and all other point arrays (see InterpolateAttributes). Active scalars are velocities, the
 * first vector or the first scalar of the particles that varies, or the iso value where there are several. The
 * output field data has "IsoValues", and what the input's has. GetRunStatistics() holds the statistics of the
 * run, one array each: "Device", "Platform", "FluidParticles",
 * "SolidParticles", "VirtualCells", "SeedCells", "SeedCellsNotIntersected", "LatticeOrigin",
 * "LatticeCells", "CellsUsed", "AmbiguousFaces", "JoinedFaces", "AmbiguousCells", "Tunnels",
 * "Points", "Triangles", "Area" and, of a closed surface, "Volume", "CapTriangles" (with Capping), "TrianglesBeforeTrimming", "CorrectionMean", "CorrectionMax",
 * "CorrectionStandardDeviation", "VerticesCorrected", "VerticesAboveTolerance", "IterationsMean",
 * "IterationsMax", "NewtonEvaluations", "ResidualMax", "PositionError", "TrimVertices", "TrimVerticesLinear",
 * "SmoothingLengthRange", "ScalarRange" (not for the free surface), and the parameters: "IsoValues", "Field", "Scalar", "SmoothingLengthArray",
 * "SmoothingLengthIsSupportRadius", "EstimateSmoothingLength", "VolumeArray", "MassArray" or "Mass",
 * "DensityArray" or "Density", "FluidArray", "FluidValue", "IgnoreSolids", "WallShare", "Kernel", "SeedMode",
 * "Topology", "Precision", "CubeSize", "Box", "PeriodicBounds" and "Capping" (where they are used), "CubeSizeFactor", "HScaleFactor", "NodeThreshold",
 * "BoundaryDetection", "VertexThreshold", "Tolerance", "IterationLimit", "Preview". Lengths (of the
 * correction, too) are in L, "LatticeOrigin" in cubes, "ResidualMax" in the unit of the scalar, at positions
 * that the device has rounded by up to "PositionError" (in L);
 * mcor_statistics in mcor.h says more of each. All of it, and the output, is a function of the input and the
 * properties, but for what the run cost, and the two numbers of complete seeds, which count the cells
 * examined: also those that KeepDeviceData kept.
 *
 * All lengths are in the unit of the point coordinates (L below).
 *
 * With MPI, where the Controller has more than one process, these share the surface: all update, each
 * with some of the particles (marks of vtkGhostType as duplicates are heeded) or none. Space is divided
 * among them, particles travel to where they are needed, and each process gets the part of the surface
 * in its share of space, to the last bit as one process would make it. "GlobalPointIds" and
 * "GlobalCellIds" are the numbers that points and triangles have there: put where these say, the parts are
 * that surface. GetRunStatistics() is of the whole, and has "RankParticles", "RankCopies", "RankBytesSent", "RankWork",
 * "RankNodesEvaluated",
 * "RankTriangles" and "RankSeconds", one component for each process. An error of one is an error of all.
 * Blocks that are taken apart are as many on all.
 *
 * @warning
 * Every piece is contoured by itself, unless processes share the surface. Particles of a neighbouring piece, also those marked
 * as ghosts, are particles like all others: without them the surface is trimmed at the cut, and with
 * them both pieces have the surface there.
 *
 * @warning
 * The `sum` field falls to zero at a free surface, so it has a second sheet along the whole free
 * surface wherever the iso value is lower than the scalar there. Shepard normalization has not.
 *
 * @warning
 * With SeedMode set to pairs, parts of the surface without a pair of close particles on both sides
 * of it are missed. This is the paper's selection, meant for previews and for comparison.
 *
 * @warning
 * The surface ends where trimming cuts it: it is a manifold with boundary, closed only where the
 * fluid closes it. In free-surface mode nothing is trimmed.
 *
 * @warning
 * With single precision output points, the rounding of the coordinates limits how well the field at
 * a vertex matches the iso value. Ask for double precision where this matters.
 *
 * @warning
 * In-place changes of input arrays are seen only if Modified() is called on the array or the data
 * set, as everywhere in VTK.
 *
 * @warning
 * An observer of the progress may change the filter while an update runs, but not the values in the
 * input's arrays. The update goes on as it began; as with all of VTK's filters, the change counts
 * when Modified() is called after it.
 *
 * @warning
 * The input is checked for sizes, types and values, but a reader that is given a damaged file may
 * crash before the filter is asked.
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
#include <vector> // For members

class vtkMarchingCorrectorsInput;
class vtkPointSet;
struct mcor_input;
struct mcor_statistics;
struct mcor_surface;
struct vtkMarchingCorrectorsChoice;
struct vtkMarchingCorrectorsRun;
struct vtkSPHRanksRoute;

class VTKMARCHINGCORRECTORS_EXPORT vtkMarchingCorrectors : public vtkSPHAlgorithm
{
public:
  static vtkMarchingCorrectors* New();
  vtkTypeMacro(vtkMarchingCorrectors, vtkSPHAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The modification time includes that of the contour values.
   */
  vtkMTimeType GetMTime() override;

  enum SeedModeType
  {
    COMPLETE = 0, ///< every cell that a bound cannot exclude
    PAIRS = 1     ///< cells between particle pairs on both sides of the iso value
  };

  enum CubeSizeModeType
  {
    UNIFORM = 0, ///< the cube size everywhere
    ADAPTIVE = 1 ///< that times a power of 2, as fine as the particles are
  };

  enum TopologyType
  {
    TOPOLOGY_TABLE = 0, ///< Marching Cubes' table alone
    TOPOLOGY_FIELD = 1  ///< as the field is on ambiguous faces and in ambiguous cells
  };

  enum BoundaryDetectionType
  {
    WEIGHT_SUM = 0, ///< sum_j V_j W(x - x_j, s h_j)
    EIGENVALUE = 1  ///< smallest one of sum_j V_j (x_j - x) (outer product) grad W(x - x_j, s h_j)
  };

  enum SolidsType
  {
    SOLIDS_WEIGHT = 0, ///< count in the weight sum used for trimming
    SOLIDS_IGNORE = 1, ///< play no part
    SOLIDS_WALL = 2,   ///< count there, and the surface ends at them
    SOLIDS_AUTO = 3    ///< as SOLIDS_WALL for a scalar, as SOLIDS_WEIGHT for the free surface
  };

  /**
   * Value of ScalarComponent that stands for the magnitude of a vector.
   */
  enum
  {
    MAGNITUDE = -1
  };

  ///@{
  /**
   * Methods to set/get contour values, in the unit of the scalar. Several values give several
   * surfaces in one output. By default there is none, and one surface is drawn at the median of the
   * scalar in the fluid; where all values are positive and range over three decades, at the middle of the
   * range in logarithms. "IsoValues" in the output field data tells it. NaN counts as none.
   */
  void SetValue(int i, double value) { this->ContourValues->SetValue(i, value); }
  double GetValue(int i)
  {
    return this->GetNumberOfContours() > 0 ? this->ContourValues->GetValue(i) : 0.0;
  }
  double* GetValues() { return this->ContourValues->GetValues(); }
  void GetValues(double* contourValues) { this->ContourValues->GetValues(contourValues); }
  void SetNumberOfContours(int number) { this->ContourValues->SetNumberOfContours(number); }
  vtkIdType GetNumberOfContours() { return this->ContourValues->GetNumberOfContours(); }
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
   * Which component of the scalar array to contour; MAGNITUDE (-1, the default) is the Euclidean
   * norm. Not used for arrays with one component.
   */
  vtkSetMacro(ScalarComponent, int);
  vtkGetMacro(ScalarComponent, int);
  void SetScalarComponentToMagnitude() { this->SetScalarComponent(MAGNITUDE); }
  ///@}

  /**
   * ScalarComponent for ParaView's panel, where 3 stands for the magnitude of a vector: its range
   * domains know no other number for it.
   */
  void SetPanelComponent(int component)
  {
    this->SetScalarComponent(component >= 3 ? static_cast<int>(MAGNITUDE) : component);
  }

  ///@{
  /**
   * Divide the SPH sum of the scalar by the sum of the weights (Shepard). On by default; off gives
   * the plain sum of the paper.
   */
  vtkSetMacro(ShepardNormalization, vtkTypeBool);
  vtkGetMacro(ShepardNormalization, vtkTypeBool);
  vtkBooleanMacro(ShepardNormalization, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Contour the weight sum instead of a scalar: about 1 in the fluid, falling to 0 outside. Off by
   * default. When on, the scalar, the contour values and the thresholds are not used.
   */
  vtkSetMacro(FreeSurface, vtkTypeBool);
  vtkGetMacro(FreeSurface, vtkTypeBool);
  vtkBooleanMacro(FreeSurface, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The weight sum at which the free surface is drawn, no unit; 0.5 by default. The indexed forms
   * draw several surfaces in one run.
   */
  void SetFreeSurfaceValue(double value);
  double GetFreeSurfaceValue() { return this->GetFreeSurfaceValue(0); }
  void SetFreeSurfaceValue(int i, double value) { this->FreeSurfaceValues->SetValue(i, value); }
  double GetFreeSurfaceValue(int i)
  {
    return this->GetNumberOfFreeSurfaceValues() > 0 ? this->FreeSurfaceValues->GetValue(i) : 0.5;
  }
  void SetNumberOfFreeSurfaceValues(int n) { this->FreeSurfaceValues->SetNumberOfContours(n); }
  vtkIdType GetNumberOfFreeSurfaceValues()
  {
    return this->FreeSurfaceValues->GetNumberOfContours();
  }
  ///@}

  ///@{
  /**
   * Size of the virtual grid's cubes, as a factor of the smallest smoothing length (unscaled). No
   * unit, > 0, 0.5 by default; 0.5 to 1 is sensible. Where smoothing lengths vary, the smallest
   * one, and with it the lattice, may differ between time steps, or pieces of a data set: set
   * CubeSize where they are to share one.
   */
  vtkSetMacro(CubeSizeFactor, double);
  vtkGetMacro(CubeSizeFactor, double);
  ///@}

  ///@{
  /**
   * Size of the virtual grid's cubes, unit L. 0 (the default): use CubeSizeFactor. Nodes lie at
   * multiples of this size, counted from the origin of the coordinates.
   */
  vtkSetMacro(CubeSize, double);
  vtkGetMacro(CubeSize, double);
  ///@}

  ///@{
  /**
   * Whether cubes are alike, see CubeSizeModeType; ADAPTIVE by default: where all particles
   * that reach a brick of 4^3 cubes have at least 2, 4, ... times the smallest smoothing length, its
   * cubes are as many times larger; bricks that touch differ by a factor of 2 at most. The surface is
   * closed across sizes, and has triangles in proportion to the particles. With one smoothing length
   * for all, the same as UNIFORM. TOPOLOGY_FIELD decides between cubes that no finer one touches.
   * CubeLevelLimit: the highest power of 2, 0 to 24; 24 by default. The statistics have
   * CellsOfLevel, TrianglesOfLevel, FlatLoops, and HighestLevel, to which periods may limit it.
   */
  vtkSetClampMacro(CubeSizeMode, int, UNIFORM, ADAPTIVE);
  vtkGetMacro(CubeSizeMode, int);
  void SetCubeSizeModeToUniform() { this->SetCubeSizeMode(UNIFORM); }
  void SetCubeSizeModeToAdaptive() { this->SetCubeSizeMode(ADAPTIVE); }
  vtkSetClampMacro(CubeLevelLimit, int, 0, 24);
  vtkGetMacro(CubeLevelLimit, int);
  ///@}

  ///@{
  /**
   * How space is divided where processes share a surface, see SetController(): so that each has as
   * much work as can be expected (BY_WORK, the default): surface costs more than what is within the
   * fluid; or as many particles (BY_PARTICLES). The surface is the same, to the last bit.
   */
  enum PartitionType
  {
    BY_PARTICLES = 0,
    BY_WORK
  };
  vtkSetClampMacro(Partition, int, BY_PARTICLES, BY_WORK);
  vtkGetMacro(Partition, int);
  void SetPartitionToByParticles() { this->SetPartition(BY_PARTICLES); }
  void SetPartitionToByWork() { this->SetPartition(BY_WORK); }
  ///@}

  ///@{
  /**
   * Whether only the cells in a box are drawn; off by default. Box: x0, x1, y0, y1, z0, z1, unit L;
   * sides may be infinite. Cells whose centres are in it are exactly those of the whole surface, so
   * that boxes side by side make it up; only the particles that reach them are evaluated (with pairs
   * as seeds all are, but for the correction). The lattice is that of all particles.
   */
  vtkSetMacro(UseBox, vtkTypeBool);
  vtkGetMacro(UseBox, vtkTypeBool);
  vtkBooleanMacro(UseBox, vtkTypeBool);
  vtkSetVector6Macro(Box, double);
  vtkGetVector6Macro(Box, double);
  ///@}

  ///@{
  /**
   * Close the surface at periodic sides and at those of the box's cells, off by default: by flat triangles around what
   * is above the iso value, which share the points of the surface's border. The free surface with SOLIDS_WALL is closed
   * at the walls, too. What encloses the body is then closed, unless trimming leaves it open. Not with PAIRS.
   */
  vtkSetMacro(Capping, vtkTypeBool);
  vtkGetMacro(Capping, vtkTypeBool);
  vtkBooleanMacro(Capping, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Box as its lower corner and its lengths, as ParaView's box widget has it.
   */
  void SetPanelBoxPosition(double x, double y, double z);
  void SetPanelBoxLength(double x, double y, double z);
  ///@}

  ///@{
  /**
   * How the march is seeded, see SeedModeType; COMPLETE by default, which misses nothing that
   * Marching Cubes on the full lattice would find. In free-surface mode it is always COMPLETE: no
   * pair of particles lies on both sides of the fluid's surface.
   */
  vtkSetClampMacro(SeedMode, int, COMPLETE, PAIRS);
  vtkGetMacro(SeedMode, int);
  void SetSeedModeToComplete() { this->SetSeedMode(COMPLETE); }
  void SetSeedModeToPairs() { this->SetSeedMode(PAIRS); }
  ///@}

  ///@{
  /**
   * How the corners of a cell are connected where their values alone leave it open, see
   * TopologyType. TOPOLOGY_TABLE (the default) keeps the higher values apart on ambiguous faces,
   * and makes no tunnels through cells. TOPOLOGY_FIELD evaluates the field there, so that bridges
   * and tunnels as thin as a cube are those of the field. The surface is a manifold with both.
   */
  vtkSetClampMacro(Topology, int, TOPOLOGY_TABLE, TOPOLOGY_FIELD);
  vtkGetMacro(Topology, int);
  void SetTopologyToTable() { this->SetTopology(TOPOLOGY_TABLE); }
  void SetTopologyToField() { this->SetTopology(TOPOLOGY_FIELD); }
  ///@}

  ///@{
  /**
   * Quick look: vertices by linear interpolation, no correction, normals of the triangles. Off by
   * default.
   */
  vtkSetMacro(Preview, vtkTypeBool);
  vtkGetMacro(Preview, vtkTypeBool);
  vtkBooleanMacro(Preview, vtkTypeBool);
  ///@}

  ///@{
  /**
   * End the surface where the fluid ends, by VertexThreshold, and at walls where that was chosen. On
   * by default. Off keeps the triangles beyond; what NodeThreshold discards stays discarded. The free
   * surface does not need it.
   */
  vtkSetMacro(Trim, vtkTypeBool);
  vtkGetMacro(Trim, vtkTypeBool);
  vtkBooleanMacro(Trim, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Cells with a node whose weight sum is lower are discarded. No unit, 0.1 by default.
   */
  vtkSetMacro(NodeThreshold, double);
  vtkGetMacro(NodeThreshold, double);
  ///@}

  ///@{
  /**
   * What tells trimming where the fluid ends, see BoundaryDetectionType; WEIGHT_SUM by default.
   * The eigenvalue is that of Marrone et al., "Fast free-surface detection and level-set function
   * definition in SPH solvers", J. Comput. Phys. 229, 2010: the smallest one of the inverse of the
   * renormalization matrix (its symmetric part). Both are about 1 inside and fall to 0 outside, but
   * the eigenvalue needs another VertexThreshold: 0.3 trims about where a weight sum of 0.5 does;
   * 0.75 within the fluid, 0.9 smoothing lengths from a flat surface. Near 0.5 the border is
   * ragged, as the eigenvalue stays there over a depth of half a smoothing length.
   */
  vtkSetClampMacro(BoundaryDetection, int, WEIGHT_SUM, EIGENVALUE);
  vtkGetMacro(BoundaryDetection, int);
  void SetBoundaryDetectionToWeightSum() { this->SetBoundaryDetection(WEIGHT_SUM); }
  void SetBoundaryDetectionToEigenvalue() { this->SetBoundaryDetection(EIGENVALUE); }
  ///@}

  ///@{
  /**
   * Triangles are trimmed where the weight sum (or the eigenvalue, see BoundaryDetection) is lower.
   * No unit, 0.5 by default.
   */
  vtkSetMacro(VertexThreshold, double);
  vtkGetMacro(VertexThreshold, double);
  ///@}

  ///@{
  /**
   * What solid particles (see SetFluidArrayName) do to the surface's end. SOLIDS_AUTO, the default: the
   * surface of a scalar ends at the wall, as with SOLIDS_WALL; the free surface runs on, as with
   * SOLIDS_WEIGHT. SOLIDS_WEIGHT: it runs on behind the wall, as the weight sum does. SOLIDS_IGNORE:
   * it ends before the wall, where the fluid's weight is VertexThreshold. SOLIDS_WALL: it ends
   * where the solids' share of the weight sum becomes greater than WallShare; so does the free surface,
   * which then is open along walls.
   */
  void SetSolids(int solids);
  vtkGetMacro(Solids, int);
  ///@}

  ///@{
  /**
   * Where the surface ends at solids: their share of the weight sum there, above 0 and below 1; 0: it does
   * not end at them. -1, the default: measured, as the solids' share at those solids that face the fluid,
   * in the median, so that the surface of a scalar ends there; the free surface, which keeps in front of
   * them, takes 0.5. With 0.5 it ends where solids weigh more than the fluid, about half way between the
   * particles of the wall and those of the fluid; a greater share is farther into the wall.
   * GetRunStatistics() has the one in use.
   */
  vtkSetMacro(WallShare, double);
  vtkGetMacro(WallShare, double);
  ///@}

  ///@{
  /**
   * Compute "Normals": unit length, on the side of lower values, from the analytic gradient of the
   * field (in previews from the triangles). On by default.
   */
  vtkSetMacro(ComputeNormals, vtkTypeBool);
  vtkGetMacro(ComputeNormals, vtkTypeBool);
  vtkBooleanMacro(ComputeNormals, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "Gradients": the gradient of the field, unit of the scalar / L. Off by default.
   */
  vtkSetMacro(ComputeGradients, vtkTypeBool);
  vtkGetMacro(ComputeGradients, vtkTypeBool);
  vtkBooleanMacro(ComputeGradients, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Add the iso value as a point array. For a scalar array it takes the name of this array; else
   * the name is that of the vector and the component or "Magnitude" ("Velocity_X"), of both
   * vectors for a dot product ("A_Dot_B"), or "IsoValue" in free-surface mode and where a computed
   * array ("Normals", ...) has that name. On by default.
   */
  vtkSetMacro(ComputeScalars, vtkTypeBool);
  vtkGetMacro(ComputeScalars, vtkTypeBool);
  vtkBooleanMacro(ComputeScalars, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "WeightSum": the weight used for trimming, no unit. Off by default.
   */
  vtkSetMacro(ComputeWeightSum, vtkTypeBool);
  vtkGetMacro(ComputeWeightSum, vtkTypeBool);
  vtkBooleanMacro(ComputeWeightSum, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "BoundaryEigenvalue", no unit: see BoundaryDetection, whose choice does not matter
   * here. Off by default.
   */
  vtkSetMacro(ComputeBoundaryEigenvalue, vtkTypeBool);
  vtkGetMacro(ComputeBoundaryEigenvalue, vtkTypeBool);
  vtkBooleanMacro(ComputeBoundaryEigenvalue, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "CorrectionLength": the distance that the correction moved the vertex, unit L. Off by
   * default.
   */
  vtkSetMacro(ComputeCorrectionLength, vtkTypeBool);
  vtkGetMacro(ComputeCorrectionLength, vtkTypeBool);
  vtkBooleanMacro(ComputeCorrectionLength, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "Residual": field minus iso value at the vertex, unit of the scalar. Off by default.
   */
  vtkSetMacro(ComputeResidual, vtkTypeBool);
  vtkGetMacro(ComputeResidual, vtkTypeBool);
  vtkBooleanMacro(ComputeResidual, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Compute "BoundaryFlag": 0 inside, 1 on the trim boundary, 2 on the trim boundary where the
   * vertex stayed at the linear cut, 4 next to a cell that NodeThreshold discarded, 8 of a cap
   * alone. Off by default.
   */
  vtkSetMacro(ComputeBoundaryFlag, vtkTypeBool);
  vtkGetMacro(ComputeBoundaryFlag, vtkTypeBool);
  vtkBooleanMacro(ComputeBoundaryFlag, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Interpolate all other point arrays to the surface. float and double arrays by Shepard's method
   * with the kernel; integers, identifiers and strings from the nearest particle. Names, component
   * names and types are kept. An array that is NaN or infinite at a fluid particle is left out, with
   * a warning; one that has the name of an array that is computed (or of the iso value) gives way to
   * it. On by default.
   */
  vtkSetMacro(InterpolateAttributes, vtkTypeBool);
  vtkGetMacro(InterpolateAttributes, vtkTypeBool);
  vtkBooleanMacro(InterpolateAttributes, vtkTypeBool);
  ///@}

  ///@{
  /**
   * Precision of the output points: vtkAlgorithm::DEFAULT_PRECISION (as the input points, the
   * default), SINGLE_PRECISION or DOUBLE_PRECISION.
   */
  vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
  vtkGetMacro(OutputPointsPrecision, int);
  ///@}

  ///@{
  /**
   * The correction stops where |field - iso value| is at most Tolerance times the range of the
   * scalar, and the vertex within 2e-5 cubes of the surface: a higher tolerance than the default
   * changes little. No unit, > 0, 1e-6 by default.
   */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * Most iterations of the correction per vertex, 1 to 255, 30 by default.
   */
  vtkSetClampMacro(IterationLimit, int, 1, 255);
  vtkGetMacro(IterationLimit, int);
  ///@}

  ///@{
  /**
   * What the last update used, for a panel; of the last block of composite data. Empty, or 0, where
   * nothing was drawn. The range is that of what was contoured (a component, magnitude or dot product)
   * at the fluid particles, 0 to 0 for the free surface.
   */
  vtkGetVector2Macro(FluidScalarRange, double);
  vtkGetCharFromStdStringMacro(UsedIsoValues);
  vtkGetCharFromStdStringMacro(UsedSmoothingLength);
  vtkGetCharFromStdStringMacro(UsedVolume);
  vtkGetMacro(UsedCubeSize, double);
  ///@}

  /**
   * The area of the last update's surface and, if it is closed, its volume, in words, for a panel; empty where nothing was drawn. As
   * numbers: "Area" and "Volume" of GetRunStatistics().
   */
  vtkGetCharFromStdStringMacro(SurfaceMeasures);

  /**
   * About how many cubes of the virtual grid the fluid fills, known before the last update began:
   * the measure of what it may take. From a billion on, a warning says so. 0: not known.
   */
  vtkGetMacro(EstimatedCells, double);

  ///@{
  /**
   * What an update with the properties and the input as they are now would find: the range that
   * FluidScalarRange would have, the iso value that would be taken if none were given (NaN: not known), the
   * cells of EstimatedCells (of all blocks), what UsedFluid would be, how many components the chosen array has (1 for a dot product), and the array that is taken where
   * nobody has chosen one. The input is read as it is, and not updated. 0 to 0, 0, or empty, where it is not
   * known: without particles, or without a scalar. Where processes share a run these are the last update's: one process alone has but some of
   * the particles, and to ask the others could be to wait for ever.
   */
  double* GetNextScalarRange() VTK_SIZEHINT(2);
  double GetNextIsoValue();
  int GetNextComponents();
  double GetNextCells();
  const char* GetNextFluid();
  const char* GetNextArray();
  ///@}

protected:
  vtkMarchingCorrectors();
  ~vtkMarchingCorrectors() override;

  const char* GetOutputClassName(const char* inputClassName) override;
  void Process(vtkDataObject* input, vtkDataObject* output) override;

  vtkNew<vtkContourValues> ContourValues;
  vtkNew<vtkContourValues> FreeSurfaceValues;
  int ScalarComponent = MAGNITUDE;
  vtkTypeBool ShepardNormalization = 1;
  vtkTypeBool FreeSurface = 0;

  double CubeSizeFactor = 0.5;
  double CubeSize = 0.0;
  vtkTypeBool UseBox = 0;
  double Box[6] = { 0.0, 1.0, 0.0, 1.0, 0.0, 1.0 };
  vtkTypeBool Capping = 0;
  int SeedMode = COMPLETE;
  int CubeSizeMode = ADAPTIVE;
  int CubeLevelLimit = 24;
  int Partition = BY_WORK;
  int Topology = TOPOLOGY_TABLE;
  vtkTypeBool Preview = 0;
  vtkTypeBool Trim = 1;
  double NodeThreshold = 0.1;
  int BoundaryDetection = WEIGHT_SUM;
  double VertexThreshold = 0.5;
  int Solids = SOLIDS_AUTO;
  double WallShare = -1.0;

  vtkTypeBool ComputeNormals = 1;
  vtkTypeBool ComputeGradients = 0;
  vtkTypeBool ComputeScalars = 1;
  vtkTypeBool ComputeWeightSum = 0;
  vtkTypeBool ComputeBoundaryEigenvalue = 0;
  vtkTypeBool ComputeCorrectionLength = 0;
  vtkTypeBool ComputeResidual = 0;
  vtkTypeBool ComputeBoundaryFlag = 0;
  vtkTypeBool InterpolateAttributes = 1;
  int OutputPointsPrecision = DEFAULT_PRECISION;
  double Tolerance = 1e-6;
  int IterationLimit = 30;

  double FluidScalarRange[2] = { 0.0, 0.0 };
  std::string UsedIsoValues;
  std::string UsedSmoothingLength;
  std::string UsedVolume;
  double UsedCubeSize = 0.0;
  std::string SurfaceMeasures;
  double EstimatedCells = 0.0;
  double NextScalarRange[2] = { 0.0, 0.0 };
  double NextIsoValue = std::numeric_limits<double>::quiet_NaN();
  int NextComponents = 0;
  double NextCells = 0.0;
  std::string NextFluid, NextArray;

private:
  vtkMarchingCorrectors(const vtkMarchingCorrectors&) = delete;
  void operator=(const vtkMarchingCorrectors&) = delete;

  void ProcessDistributed(vtkPointSet* particles, vtkPolyData* output);
  std::vector<double> ListIsoValuesDistributed(
    vtkSPHRanks& ranks, const vtkMarchingCorrectorsInput& input);
  void EstimateDistributed(vtkSPHRanks& ranks, const mcor_input& own, const mcor_options& options);
  void ExtractDistributed(vtkSPHRanks& ranks, vtkMarchingCorrectorsChoice& choice, vtkPolyData* own,
    const vtkSPHRanksRoute& route, mcor_options options, std::int64_t count, vtkPolyData* output);
  void FinishDistributed(
    vtkSPHRanks& ranks, const vtkMarchingCorrectorsRun& run, vtkPolyData* output);
  void WarnOf(const vtkMarchingCorrectorsInput& input, const mcor_surface& surface,
    const mcor_input& core, const mcor_options& options);
  void Extract(vtkMarchingCorrectorsInput& input, mcor_options& options, vtkPolyData* output);
  void FillChoice(vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles);
  void FillRequests(vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles);
  void FillOptions(mcor_options& options);
  void ClearSummary();
  void LookAhead();
  void LookAhead(vtkPointSet* particles, const mcor_options& options);
  void WarnOfHugeRun();
  void Summarize(
    const mcor_input& input, const mcor_options& options, const mcor_statistics& statistics);
  std::vector<double> ListIsoValues(const vtkMarchingCorrectorsInput& input);

  vtkTimeStamp LookTime; // of the last look ahead
};

#endif

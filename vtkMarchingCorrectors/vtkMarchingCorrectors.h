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
 * The scalar is chosen with SetInputArrayToProcess(0, 0, 0, FIELD_ASSOCIATION_POINTS, name); the
 * active scalars are the default. A vector is contoured by its magnitude or by one component (see
 * ScalarComponent). If a second vector is chosen with SetInputArrayToProcess(1, ...), the dot
 * product of the two is contoured. In free-surface mode no scalar is needed.
 *
 * Smoothing lengths, volumes, masses and densities are point arrays, found by their usual names
 * (in this order; case, blanks, "_" and "-" do not matter) unless they are named, given as a
 * constant or DetectArrays is off:
 *
 *     smoothing length   SmoothingLength SmoothingLengths hsml h
 *     volume             Volume Volumes ParticleVolume vol
 *     mass               Mass Masses ParticleMass m
 *     density            Density Densities ParticleDensity rho
 *
 * The volume of a particle is the volume array; else mass / density; else, with masses alone, m_j
 * over the mass density that they sum up to; else 1 / sum_k W(x_j - x_k, h_j). What was chosen is
 * retrievable (GetUsedSmoothingLengthArrayName() and its kin) and stands in the output field data.
 * In place of any array name, "(automatic)" and "(none)" mean the same as an empty one.
 *
 * The output point data holds "Normals", the arrays asked for ("Gradients", "WeightSum",
 * "BoundaryEigenvalue", "CorrectionLength", "Residual", "BoundaryFlag"), the iso value (see
 * ComputeScalars) and all other point arrays (see InterpolateAttributes). The output field data
 * holds the statistics of the run, one array each: "Device", "Platform", "FluidParticles",
 * "SolidParticles", "VirtualCells", "SeedCells", "SeedCellsNotIntersected", "LatticeOrigin",
 * "LatticeCells", "CellsUsed", "AmbiguousFaces", "JoinedFaces", "AmbiguousCells", "Tunnels",
 * "Points", "Triangles", "TrianglesBeforeTrimming", "CorrectionMean", "CorrectionMax",
 * "CorrectionStandardDeviation", "VerticesCorrected", "VerticesAboveTolerance", "IterationsMean",
 * "IterationsMax", "NewtonEvaluations", "ResidualMax", "TrimVertices", "TrimVerticesLinear",
 * "SmoothingLengthRange", "ScalarRange" (not for the free surface), and the parameters: "IsoValues", "Field", "Scalar", "SmoothingLengthArray",
 * "SmoothingLengthIsSupportRadius", "EstimateSmoothingLength", "VolumeArray", "MassArray" or "Mass",
 * "DensityArray" or "Density", "FluidArray", "FluidValue", "IgnoreSolids", "Kernel", "SeedMode",
 * "Topology", "Precision", "CubeSize", "CubeSizeFactor", "HScaleFactor", "NodeThreshold",
 * "BoundaryDetection", "VertexThreshold", "Tolerance", "IterationLimit", "Preview". Lengths (of the
 * correction, too) are in L, "LatticeOrigin" in cubes, "ResidualMax" in the unit of the scalar;
 * mcor_statistics in mcor.h says more of each. All of the output is a function of the input and the
 * properties, but for the two numbers of complete seeds, which count the cells examined: also those
 * that KeepDeviceData kept. What a run cost is told by GetRunStatistics().
 *
 * All lengths are in the unit of the point coordinates (L below).
 *
 * Composite data give composite data: each block that is a point set is contoured by itself, in its
 * place. A block that fails leaves its place empty; the error names it.
 *
 * @warning
 * Every piece or block is contoured by itself. Particles of a neighbouring piece, also those marked
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
 * vtkSPHInterpolator vtkContourFilter vtkFlyingEdges3D vtkContourValues
 */

#ifndef vtkMarchingCorrectors_h
#define vtkMarchingCorrectors_h

#include "vtkContourValues.h"            // Passes calls through
#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkNew.h"                      // For members
#include "vtkPolyDataAlgorithm.h"
#include "vtkSmartPointer.h" // For members

#include <memory> // For the device state
#include <string> // For members
#include <vector> // For members

class vtkDataObjectTree;
class vtkFieldData;
class vtkMarchingCorrectorsInput;
class vtkPointSet;
struct mcor_options;
struct vtkMarchingCorrectorsChoice;
struct vtkMarchingCorrectorsRequest;

class VTKMARCHINGCORRECTORS_EXPORT vtkMarchingCorrectors : public vtkPolyDataAlgorithm
{
public:
  static vtkMarchingCorrectors* New();
  vtkTypeMacro(vtkMarchingCorrectors, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * The modification time includes that of the contour values.
   */
  vtkMTimeType GetMTime() override;

  enum KernelType
  {
    CUBIC_SPLINE = 0,   ///< M4, support radius 2 h
    QUADRATIC = 1,      ///< support radius 2 h
    M_PRIME_4 = 2,      ///< M'4 as a tensor product, support 2 h along each axis
    QUINTIC_SPLINE = 3, ///< M6, support radius 3 h
    WENDLAND_C2 = 4     ///< support radius 2 h
  };

  enum SeedModeType
  {
    COMPLETE = 0, ///< every cell that a bound cannot exclude
    PAIRS = 1     ///< cells between particle pairs on both sides of the iso value
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
   * surfaces in one output. By default there is none, and one surface is drawn in the middle of the
   * fluid's scalar range, the 2 % lowest and highest values left out; where that was is told by
   * "IsoValues" in the output field data.
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
   * The point array of smoothing lengths (unit L, > 0). Empty (the default): found by name.
   */
  vtkSetStdStringFromCharMacro(SmoothingLengthArrayName);
  vtkGetCharFromStdStringMacro(SmoothingLengthArrayName);
  ///@}

  ///@{
  /**
   * One smoothing length for all particles, unit L. 0 (the default): use the array. If the points
   * have no smoothing length at all, set this, or EstimateSmoothingLength.
   */
  vtkSetMacro(SmoothingLength, double);
  vtkGetMacro(SmoothingLength, double);
  ///@}

  ///@{
  /**
   * Estimate one smoothing length for all particles: 1.3 times their median spacing. For positions
   * without further data. Goes before array and constant. Off by default. The estimated value is
   * the "SmoothingLengthRange" of the output field data.
   */
  vtkSetMacro(EstimateSmoothingLength, vtkTypeBool);
  vtkGetMacro(EstimateSmoothingLength, vtkTypeBool);
  vtkBooleanMacro(EstimateSmoothingLength, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The array or constant holds the support radius of the kernel (where it becomes 0) instead of
   * the smoothing length. Off by default.
   */
  vtkSetMacro(SmoothingLengthIsSupportRadius, vtkTypeBool);
  vtkGetMacro(SmoothingLengthIsSupportRadius, vtkTypeBool);
  vtkBooleanMacro(SmoothingLengthIsSupportRadius, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The point arrays of particle volumes (unit L^3, > 0), masses (> 0) and densities (> 0). Empty
   * (the default): found by name. Volumes are not searched for if a mass or density is set. Masses
   * and densities may have any units that give volumes in L^3; a density is used with masses only.
   */
  vtkSetStdStringFromCharMacro(VolumeArrayName);
  vtkGetCharFromStdStringMacro(VolumeArrayName);
  vtkSetStdStringFromCharMacro(MassArrayName);
  vtkGetCharFromStdStringMacro(MassArrayName);
  vtkSetStdStringFromCharMacro(DensityArrayName);
  vtkGetCharFromStdStringMacro(DensityArrayName);
  ///@}

  ///@{
  /**
   * One mass (or density) for all particles. 0 (the default): use the array.
   */
  vtkSetMacro(Mass, double);
  vtkGetMacro(Mass, double);
  vtkSetMacro(Density, double);
  vtkGetMacro(Density, double);
  ///@}

  ///@{
  /**
   * Find smoothing length, volume, mass and density arrays by their usual names. On by default.
   */
  vtkSetMacro(DetectArrays, vtkTypeBool);
  vtkGetMacro(DetectArrays, vtkTypeBool);
  vtkBooleanMacro(DetectArrays, vtkTypeBool);
  ///@}

  ///@{
  /**
   * The arrays used by the last run; empty where none was: a constant, or computed.
   */
  vtkGetCharFromStdStringMacro(UsedSmoothingLengthArrayName);
  vtkGetCharFromStdStringMacro(UsedVolumeArrayName);
  vtkGetCharFromStdStringMacro(UsedMassArrayName);
  vtkGetCharFromStdStringMacro(UsedDensityArrayName);
  ///@}

  ///@{
  /**
   * The kernel W, see KernelType; CUBIC_SPLINE by default. Use the kernel of the simulation.
   */
  vtkSetClampMacro(Kernel, int, CUBIC_SPLINE, WENDLAND_C2);
  vtkGetMacro(Kernel, int);
  void SetKernelToCubicSpline() { this->SetKernel(CUBIC_SPLINE); }
  void SetKernelToQuadratic() { this->SetKernel(QUADRATIC); }
  void SetKernelToMPrime4() { this->SetKernel(M_PRIME_4); }
  void SetKernelToQuinticSpline() { this->SetKernel(QUINTIC_SPLINE); }
  void SetKernelToWendlandC2() { this->SetKernel(WENDLAND_C2); }
  ///@}

  ///@{
  /**
   * The kernel by name: "cubic", "quadratic", "mprime4", "quintic" or "wendland". Returns false,
   * and changes nothing, if there is no such kernel.
   */
  bool SetKernelByName(const char* name);
  const char* GetKernelName() const;
  ///@}

  ///@{
  /**
   * The kernels use this factor times the smoothing length; volumes do not change. No unit, > 0,
   * 1 by default. Less than 1 gives less smoothing.
   */
  vtkSetMacro(HScaleFactor, double);
  vtkGetMacro(HScaleFactor, double);
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
   * The point array and the value in it that mark fluid particles; all others are solid. The field
   * uses fluid particles only. Empty (the default): all particles are fluid. FluidValue is 0 by
   * default.
   */
  vtkSetStdStringFromCharMacro(FluidArrayName);
  vtkGetCharFromStdStringMacro(FluidArrayName);
  vtkSetMacro(FluidValue, double);
  vtkGetMacro(FluidValue, double);
  ///@}

  ///@{
  /**
   * Leave solid particles out of the weight sum used for trimming too. Off by default: they count
   * there, so that the surface reaches the wall.
   */
  vtkSetMacro(IgnoreSolids, vtkTypeBool);
  vtkGetMacro(IgnoreSolids, vtkTypeBool);
  vtkBooleanMacro(IgnoreSolids, vtkTypeBool);
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
   * the name is that of the vector and the component or "Magnitude" ("Velocity_Magnitude"), of both
   * vectors for a dot product ("A_Dot_B"), or "IsoValue" in free-surface mode and where a computed
   * array ("Normals", ...) has that name. It becomes the active scalars. On by default.
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
   * vertex stayed at the linear cut, 4 next to a cell that NodeThreshold discarded. Off by default.
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
   * Arrays that InterpolateAttributes leaves out, by name. None by default.
   */
  void AddExcludedArray(const std::string& name);
  void ClearExcludedArrays();
  int GetNumberOfExcludedArrays() const;
  const char* GetExcludedArray(int i) const;
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
   * Precision of the field evaluation on the device: vtkAlgorithm::SINGLE_PRECISION (the default)
   * or DOUBLE_PRECISION, which some devices lack.
   */
  vtkSetClampMacro(Precision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
  vtkGetMacro(Precision, int);
  ///@}

  ///@{
  /**
   * The OpenCL device: a number or a part of a device's or platform's name as in ListDevices().
   * Empty (the default): PoCL, else the first one.
   */
  vtkSetStdStringFromCharMacro(Device);
  vtkGetCharFromStdStringMacro(Device);
  ///@}

  /**
   * The sentence that says why the last run failed; empty if it did not. It is also reported as a
   * VTK error. For composite data, one line for each block that failed, which it names.
   */
  vtkGetCharFromStdStringMacro(ErrorMessage);

  /**
   * What the last update cost, one array each: "Seconds" (one component per phase, one for building
   * the OpenCL program, and the total, by name), "DeviceBytesPeak", "Bricks", "NodesEvaluated" (those kept from earlier updates counted)
   * and "MarchRounds". Empty where nothing ran. The next update makes another field data and leaves
   * this one as it is.
   */
  vtkFieldData* GetRunStatistics();

  /**
   * The OpenCL devices at hand, one line each: "number: device (platform)". Empty if there is none.
   */
  static std::string ListDevices();

  /**
   * Drop what is kept on the device between runs. The next run takes as long as the first.
   */
  void ReleaseDeviceMemory();

  ///@{
  /**
   * Most device memory in use and kept between updates by this filter, in MiB; each filter has
   * memory of its own. 0, the default, means all that there is. An update that would need more
   * fails with a sentence that says how much.
   */
  vtkSetClampMacro(DeviceMemoryLimit, int, 0, VTK_INT_MAX);
  vtkGetMacro(DeviceMemoryLimit, int);
  ///@}

  ///@{
  /**
   * Keep on the device what the next update may reuse: the search grid and the node values. On by
   * default. Off, everything is given back as soon as an update does not need it any more: for one
   * that is the only one.
   */
  vtkSetMacro(KeepDeviceData, vtkTypeBool);
  vtkGetMacro(KeepDeviceData, vtkTypeBool);
  vtkBooleanMacro(KeepDeviceData, vtkTypeBool);
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

protected:
  vtkMarchingCorrectors();
  ~vtkMarchingCorrectors() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  vtkNew<vtkContourValues> ContourValues;
  vtkNew<vtkContourValues> FreeSurfaceValues;
  int ScalarComponent = MAGNITUDE;
  vtkTypeBool ShepardNormalization = 1;
  vtkTypeBool FreeSurface = 0;

  std::string SmoothingLengthArrayName;
  double SmoothingLength = 0.0;
  vtkTypeBool EstimateSmoothingLength = 0;
  vtkTypeBool SmoothingLengthIsSupportRadius = 0;
  std::string VolumeArrayName;
  std::string MassArrayName;
  std::string DensityArrayName;
  double Mass = 0.0;
  double Density = 0.0;
  vtkTypeBool DetectArrays = 1;
  std::string UsedSmoothingLengthArrayName;
  std::string UsedVolumeArrayName;
  std::string UsedMassArrayName;
  std::string UsedDensityArrayName;

  int Kernel = CUBIC_SPLINE;
  double HScaleFactor = 1.0;
  double CubeSizeFactor = 0.5;
  double CubeSize = 0.0;
  int SeedMode = COMPLETE;
  int Topology = TOPOLOGY_TABLE;
  vtkTypeBool Preview = 0;
  double NodeThreshold = 0.1;
  int BoundaryDetection = WEIGHT_SUM;
  double VertexThreshold = 0.5;
  std::string FluidArrayName;
  double FluidValue = 0.0;
  vtkTypeBool IgnoreSolids = 0;

  vtkTypeBool ComputeNormals = 1;
  vtkTypeBool ComputeGradients = 0;
  vtkTypeBool ComputeScalars = 1;
  vtkTypeBool ComputeWeightSum = 0;
  vtkTypeBool ComputeBoundaryEigenvalue = 0;
  vtkTypeBool ComputeCorrectionLength = 0;
  vtkTypeBool ComputeResidual = 0;
  vtkTypeBool ComputeBoundaryFlag = 0;
  vtkTypeBool InterpolateAttributes = 1;
  std::vector<std::string> ExcludedArrays;
  int OutputPointsPrecision = DEFAULT_PRECISION;
  int Precision = SINGLE_PRECISION;
  std::string Device;
  double Tolerance = 1e-6;
  int IterationLimit = 30;
  int DeviceMemoryLimit = 0;
  vtkTypeBool KeepDeviceData = 1;

private:
  vtkMarchingCorrectors(const vtkMarchingCorrectors&) = delete;
  void operator=(const vtkMarchingCorrectors&) = delete;

  int RequestDataObject(vtkInformationVector** inputVector, vtkInformationVector* outputVector);
  int ExtractBlocks(vtkDataObjectTree* input, vtkDataObjectTree* output);
  int ExtractFrom(vtkPointSet* particles, vtkPolyData* output);
  int Extract(vtkMarchingCorrectorsInput& input, mcor_options& options, vtkPolyData* output);
  vtkMarchingCorrectorsRequest FindRequest(int index, vtkPointSet* particles);
  void FillChoice(vtkMarchingCorrectorsChoice& choice, vtkPointSet* particles);
  void FillOptions(mcor_options& options) const;
  std::vector<double> ListIsoValues(const vtkMarchingCorrectorsInput& input);
  void SetUsedNames(const vtkMarchingCorrectorsInput& input);
  int Fail(const std::string& message);

  std::string ErrorMessage;
  std::string BlockName; // begins the messages about a block of composite data
  vtkSmartPointer<vtkFieldData> RunStatistics;
  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkSPHAlgorithm
 * @brief   superclass of the filters that evaluate the field of SPH particles
 *
 * All these filters describe particles, choose the OpenCL device and report on a run in the same
 * way. All lengths are in the unit of the point coordinates (L below).
 *
 * Smoothing lengths, volumes, masses and densities are point arrays. Unless they are named or given
 * as a constant, or DetectArrays is off, they are found by their usual names, such as hsml or rho,
 * see mcor_name_priority in mcor.h. As an array name, "(automatic)" and "(none)" mean the same as
 * an empty one. The volume of a particle is taken from the volume array; else it is mass / density;
 * else it is computed from the particles' distances and masses, see mcor_input in mcor.h.
 *
 * The blocks of composite data form one set of particles, with the arrays that all blocks have; or
 * each block is processed by itself, see SetBlocks(). If a block then fails, its place in the
 * output stays empty, and the error names the block.
 *
 * @sa
 * vtkMarchingCorrectors
 */

#ifndef vtkSPHAlgorithm_h
#define vtkSPHAlgorithm_h

#include "vtkMarchingCorrectorsModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"
#include "vtkSPHParticlesChoice.h" // For superclass

#include <cstddef> // For sizes
#include <memory>  // For the device state
#include <set>

struct mcor_options;

VTK_ABI_NAMESPACE_BEGIN
class vtkDataObjectTree;
class vtkFieldData;
class vtkMultiProcessController;
class vtkPointSet;
class vtkSPHParticles;
struct vtkSPHRequest;

///@{
/**
 * Declare SetX() and GetX() of a setting, and XOn() and XOff() of a flag. Macros without Choice in
 * their names also declare the member X, with its default. A text that a run sets has only GetX().
 */
#define vtkSPHChoiceMacro(name, type)                                                              \
  vtkSetMacro(name, type);                                                                         \
  vtkGetMacro(name, type)
#define vtkSPHChoiceTextMacro(name)                                                                \
  vtkSetStdStringFromCharMacro(name);                                                              \
  vtkGetCharFromStdStringMacro(name)
#define vtkSPHChoiceFlagMacro(name)                                                                \
  vtkSPHChoiceMacro(name, vtkTypeBool);                                                            \
  vtkBooleanMacro(name, vtkTypeBool)
#define vtkSPHMemberMacro(...)                                                                     \
protected:                                                                                         \
  __VA_ARGS__;                                                                                     \
                                                                                                   \
public:
#define vtkSPHValueMacro(name, type, usual)                                                        \
  vtkSPHMemberMacro(type name = usual) vtkSPHChoiceMacro(name, type)
#define vtkSPHTextMacro(name, usual)                                                               \
  vtkSPHMemberMacro(std::string name = usual) vtkSPHChoiceTextMacro(name)
#define vtkSPHToldMacro(name) vtkSPHMemberMacro(std::string name) vtkGetCharFromStdStringMacro(name)
#define vtkSPHFlagMacro(name, usual)                                                               \
  vtkSPHMemberMacro(vtkTypeBool name = usual) vtkSPHChoiceFlagMacro(name)
#define vtkSPHClampMacro(name, type, usual, least, most)                                           \
  vtkSPHMemberMacro(type name = usual) vtkSetClampMacro(name, type, least, most);                  \
  vtkGetMacro(name, type)
#define vtkSPHVector3Macro(name, type, x, y, z)                                                    \
  vtkSPHMemberMacro(type name[3] = { x, y, z }) vtkSetVector3Macro(name, type);                    \
  vtkGetVector3Macro(name, type)
#define vtkSPHVector6Macro(name, type, x0, x1, y0, y1, z0, z1)                                     \
  vtkSPHMemberMacro(type name[6] = { x0, x1, y0, y1, z0, z1 }) vtkSetVector6Macro(name, type);     \
  vtkGetVector6Macro(name, type)
///@}

class VTKMARCHINGCORRECTORS_EXPORT vtkSPHAlgorithm
  : public vtkPolyDataAlgorithm
  , protected vtkSPHParticlesChoice
{
public:
  vtkAbstractTypeMacro(vtkSPHAlgorithm, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum BlocksType
  {
    TOGETHER = 0, ///< all blocks are one set of particles
    APART = 1     ///< each block is a set by itself
  };

  enum KernelType
  {
    CUBIC_SPLINE = 0,   ///< M4, support radius 2 h
    QUADRATIC = 1,      ///< support radius 2 h
    M_PRIME_4 = 2,      ///< M'4 as a tensor product, support 2 h along each axis
    QUINTIC_SPLINE = 3, ///< M6, support radius 3 h
    WENDLAND_C2 = 4,    ///< support radius 2 h
    QUARTIC_SPLINE = 5, ///< M5, support radius 2.5 h
    WENDLAND_C4 = 6,    ///< support radius 2 h
    WENDLAND_C6 = 7,    ///< support radius 2 h
    SINC_6 = 8          ///< (sin x / x)^6, x = pi r / (2 h), support radius 2 h
  };

  ///@{
  /**
   * The point array of smoothing lengths (unit L, > 0). If the name is empty (the default), the array
   * is found by its usual name. SmoothingLength is one value for all particles; if it is 0 (the
   * default), the array is used.
   */
  vtkSPHChoiceTextMacro(SmoothingLengthArrayName);
  vtkSPHChoiceMacro(SmoothingLength, double);
  ///@}

  enum EstimateType
  {
    ESTIMATE_SPACING = 0,  ///< one for all particles, from their median spacing
    ESTIMATE_NEIGHBORS = 1 ///< one for each particle
  };

  ///@{
  /**
   * Estimate the smoothing lengths, even if there is an array or a constant. Off by default.
   * ESTIMATE_SPACING (the default): one for all particles, 1.3 times their median spacing.
   * ESTIMATE_NEIGHBORS: for each particle the h with h^d sum W(x - x_j, h) = NeighborRatio^d, d
   * being the dimension, as Phantom, GADGET and SWIFT define it; NeighborRatio is 1.3 by default.
   */
  vtkSPHChoiceFlagMacro(EstimateSmoothingLength);
  vtkSetClampMacro(SmoothingLengthEstimate, int, ESTIMATE_SPACING, ESTIMATE_NEIGHBORS);
  vtkGetMacro(SmoothingLengthEstimate, int);
  vtkSPHChoiceMacro(NeighborRatio, double);
  ///@}

  /**
   * Take the array or constant as the support radius of the kernel, where the kernel becomes 0, not as
   * the smoothing length. Off by default.
   */
  vtkSPHChoiceFlagMacro(SmoothingLengthIsSupportRadius);

  ///@{
  /**
   * The point arrays of particle volumes (unit L^3, > 0), masses (> 0) and densities (> 0). Arrays
   * without a name (the default) are found by their usual names. A volume array that is found is used
   * unless mass and density are both set, or ComputeVolumes is on. Mass and Density are one value for
   * all particles; if they are 0 (the default), the arrays are used.
   */
  vtkSPHChoiceTextMacro(VolumeArrayName);
  vtkSPHChoiceTextMacro(MassArrayName);
  vtkSPHChoiceTextMacro(DensityArrayName);
  vtkSPHChoiceMacro(Mass, double);
  vtkSPHChoiceMacro(Density, double);
  ///@}

  /**
   * One volume for all particles, unit L^3, in two dimensions L^2. Used if there is no array of
   * volumes, and mass or density is missing. 0 (the default): volumes are then computed.
   */
  vtkSPHChoiceMacro(ParticleVolume, double);

  /**
   * Compute volumes, even if there are arrays for them. Drops, jets and sheets then keep their
   * surface. Off by default.
   */
  vtkSPHChoiceFlagMacro(ComputeVolumes);

  ///@{
  /**
   * Periodic sides: x0, x1, y0, y1, z0, z1, unit L; all 0 by default. Where x0 < x1, the particles
   * repeat along x with the period x1 - x0. A surface covers one period, and is open at its sides.
   * The cube size is reduced so that a period is a whole number of cubes.
   */
  vtkSetVector6Macro(PeriodicBounds, double);
  vtkGetVector6Macro(PeriodicBounds, double);
  ///@}

  /**
   * Take the period from the particles' field data instead of PeriodicBounds: from "PeriodicBounds"
   * of six bounds, "BoxSize" of one or three lengths, or "box" and "boundaryType", see
   * mcor_find_period in mcor.h. With several processes, any of them may have the array. An update
   * fails if no period is found, or if processes have different periods. Off by default.
   */
  vtkSPHChoiceFlagMacro(DetectPeriod);

  /** Find smoothing length, volume, mass and density arrays by their usual names. On by default. */
  vtkSPHChoiceFlagMacro(DetectArrays);

  ///@{
  /**
   * The arrays used by the last run; empty for a constant or a computed quantity. UsedVolume: the
   * source of volumes in words, such as "array Mass / array Density".
   */
  vtkSPHToldMacro(UsedSmoothingLengthArrayName);
  vtkSPHToldMacro(UsedVolumeArrayName);
  vtkSPHToldMacro(UsedMassArrayName);
  vtkSPHToldMacro(UsedDensityArrayName);
  vtkSPHToldMacro(UsedVolume);
  ///@}

  ///@{
  /** The kernel W, see KernelType; CUBIC_SPLINE by default. Use the kernel of the simulation. */
  vtkSetClampMacro(Kernel, int, CUBIC_SPLINE, SINC_6);
  vtkGetMacro(Kernel, int);
  void SetKernelToCubicSpline() { this->SetKernel(CUBIC_SPLINE); }
  void SetKernelToQuadratic() { this->SetKernel(QUADRATIC); }
  void SetKernelToMPrime4() { this->SetKernel(M_PRIME_4); }
  void SetKernelToQuinticSpline() { this->SetKernel(QUINTIC_SPLINE); }
  void SetKernelToWendlandC2() { this->SetKernel(WENDLAND_C2); }
  void SetKernelToQuarticSpline() { this->SetKernel(QUARTIC_SPLINE); }
  void SetKernelToWendlandC4() { this->SetKernel(WENDLAND_C4); }
  void SetKernelToWendlandC6() { this->SetKernel(WENDLAND_C6); }
  void SetKernelToSinc6() { this->SetKernel(SINC_6); }
  ///@}

  ///@{
  /**
   * The kernel's short name, such as "cubic"; null: there is no kernel of this number.
   * SetKernelByName() returns false, and changes nothing, if there is no such kernel.
   */
  bool SetKernelByName(const char* name);
  const char* GetKernelName() const { return vtkSPHAlgorithm::GetKernelName(this->Kernel); }
  static const char* GetKernelName(int kernel);
  ///@}

  /**
   * The kernels use this factor times the smoothing length; volumes do not change. No unit, > 0,
   * 1 by default. Less than 1 gives less smoothing.
   */
  vtkSPHValueMacro(HScaleFactor, double, 1.0);

  ///@{
  /**
   * The dimension. 2: the particles lie in a plane of constant x, y or z, sums are two-dimensional,
   * volumes are areas, and vtkMarchingCorrectors makes lines. DIMENSION_AUTO (the default): 2 if
   * exactly one coordinate is the same for all particles, else 3.
   */
  enum DimensionType
  {
    DIMENSION_AUTO = 0,
    DIMENSION_2 = 2,
    DIMENSION_3 = 3
  };
  vtkSetClampMacro(Dimension, int, DIMENSION_AUTO, DIMENSION_3);
  vtkGetMacro(Dimension, int);
  ///@}

  /**
   * Returns 2 or 3: the dimension that an update would use for these particles. Collective if
   * processes share the update.
   */
  int FindDimension(vtkPointSet* particles);

  ///@{
  /**
   * The point array and the value (0 by default) that mark fluid particles, which alone make the
   * field; all other particles are solid. Empty (the default): all particles are fluid.
   */
  vtkSPHChoiceTextMacro(FluidArrayName);
  vtkSPHChoiceMacro(FluidValue, double);
  ///@}

  /**
   * If no fluid array is named, look for something that clearly tells fluid from walls: an array
   * such as ParticleType that holds 0 and 1, or the codes of DualSPHysics; or, if blocks are
   * TOGETHER, blocks' names such as "walls". If off (the default), a warning names what was found.
   */
  vtkSPHChoiceFlagMacro(DetectFluid);

  /** What marked fluid in the last run, such as "ParticleType = 0"; empty: all was fluid. */
  vtkSPHToldMacro(UsedFluid);

  ///@{
  /**
   * Leave out particles that are not within x0, x1, y0, y1, z0, z1 (unit L; sides may be infinite),
   * as if they were not there. All 0 (the default): none are left out.
   */
  vtkSetVector6Macro(Within, double);
  vtkGetVector6Macro(Within, double);
  ///@}

  ///@{
  /**
   * Leave out particles whose value in this point array is not from `low` to `high`, as if they
   * were not there. An array may have several ranges: a value in any one of them passes. If there
   * are several arrays, a particle must pass in all of them. None by default.
   */
  void AddOnly(const char* name, double low, double high)
  {
    this->Only.push_back({ name ? name : "", low, high });
    this->Modified();
  }
  void ClearOnly()
  {
    if (!this->Only.empty())
    {
      this->Only.clear();
      this->Modified();
    }
  }
  ///@}

  /** Returns the particles that Within and AddOnly() keep: the set itself if they keep all. */
  vtkSmartPointer<vtkPointSet> TakePresent(vtkPointSet* particles) const;

  /**
   * Finds the fluid's box. Leaves out a few particles (at each side at most 8, or 0.1 % if this is
   * more) whose distance from the box of the other particles exceeds that box's longest side. Returns
   * false, and writes nothing, if no particle is fluid. densest: see GetNextDensest(); may be null.
   * Collective if processes share a run.
   */
  bool FindFluidBounds(vtkPointSet* particles, double bounds[6], double* densest = nullptr);

  ///@{
  /**
   * Whether the blocks of composite data form one set of particles (TOGETHER, the default), or each
   * is processed by itself (APART), as the blocks of a probe's points always are.
   */
  vtkSPHClampMacro(Blocks, int, TOGETHER, TOGETHER, APART);
  void SetBlocksToTogether() { this->SetBlocks(TOGETHER); }
  void SetBlocksToApart() { this->SetBlocks(APART); }
  ///@}

  ///@{
  /** Point arrays that are not interpolated, by name. None by default. */
  void AddExcludedArray(const std::string& name)
  {
    this->ExcludedArrays.push_back(name);
    this->Modified();
  }
  void ClearExcludedArrays()
  {
    this->ExcludedArrays.clear();
    this->Modified();
  }
  int GetNumberOfExcludedArrays() const { return static_cast<int>(this->ExcludedArrays.size()); }
  const char* GetExcludedArray(int i) const;
  ///@}

  /**
   * Precision of the field evaluation on the device: vtkAlgorithm::SINGLE_PRECISION (the default)
   * or DOUBLE_PRECISION, which some devices lack.
   */
  vtkSPHClampMacro(Precision, int, SINGLE_PRECISION, SINGLE_PRECISION, DOUBLE_PRECISION);

  /**
   * The OpenCL device: a number or a part of a device's or platform's name as in ListDevices().
   * Empty (the default): the built-in device if it can do the run, else a GPU, else another.
   */
  vtkSPHTextMacro(Device, "");

  ///@{
  /**
   * The processes that share a run; VTK's global controller by default. With MPI and more than one
   * process, all must update together, each with some of the particles or none; vtkGhostType marks
   * duplicates, which are left out. Results are the same as from one process, to the last bit. If one
   * process fails, all do. If blocks are APART, all processes must have the same number of blocks.
   */
  virtual void SetController(vtkMultiProcessController* controller);
  vtkGetObjectMacro(Controller, vtkMultiProcessController);
  ///@}

  /** Why the last run failed: the sentences of its VTK errors, one a line; empty: it did not fail. */
  vtkSPHToldMacro(ErrorMessage);

  /** How many errors and warnings the last run has reported. */
  vtkGetMacro(MessageCount, int);

  ///@{
  /**
   * One array for each number of the last update: "FlatLoops" is flat_loops of mcor_statistics in
   * mcor.h, and so on; "Seconds" has a named component for each phase, for building the OpenCL
   * program, and in total. GetStatistics() returns text, a line "Name: values" for each. If blocks
   * are APART, costs are summed over blocks (of peaks, the greatest is kept), and all else is of
   * the last block. Empty if nothing ran. The next update makes a new object; this one stays.
   */
  vtkFieldData* GetRunStatistics();
  const char* GetStatistics();
  ///@}

#ifndef __VTK_WRAP__
  /** Sets the function that names settings in the messages of all filters, see mcor_word in mcor.h. Default: the panels' labels. */
  static void SetWord(int (*word)(void*, const char*, const char*, char*, std::size_t));
#endif

  /** Lists the OpenCL devices, one a line: "number: device (platform)". Empty: there is none. */
  static std::string ListDevices();

  /** Frees the memory on the device, now or at the end of the present run. The next run must send the particles again. */
  void ReleaseDeviceMemory();

  ///@{
  /**
   * Values with which a panel begins, from the input's particles. Bounds: see FindFluidBounds(); 0 if unknown.
   * Densest: for each of x, y and z, a point on the densest line along this axis. Estimate: 1 if
   * the particles have no smoothing lengths. Blocks: the names for FluidArrayName that choose a
   * block, one a line.
   */
  double* GetNextBounds() VTK_SIZEHINT(6) { return this->FindNextBounds(false); }
  double* GetNextDensest() VTK_SIZEHINT(9) { return this->FindNextBounds(true); }
  int GetNextEstimate();
  const char* GetNextBlocks();
  ///@}

  /**
   * The colour ranges of the output's point arrays: for each array a line with the lowest value,
   * the highest value and the name. A range holds the values on 98 % of the area or length, or at
   * 98 % of the points that are no walls. Empty for composite data, and if processes share a run.
   */
  const char* GetColorRanges();

  /** Maximum device memory that this filter uses and keeps, in MiB; 0 (the default): no limit. */
  vtkSPHClampMacro(DeviceMemoryLimit, int, 0, 0, VTK_INT_MAX);

  /** Keep the search grid and the node values on the device for the next update. On by default. */
  vtkSPHFlagMacro(KeepDeviceData, 1);

protected:
  vtkSPHAlgorithm();
  ~vtkSPHAlgorithm() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  int FillOutputPortInformation(int port, vtkInformation* info) override;
  vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

  /** Requests all of an input, whatever part of the output is wanted. */
  static void AskForAll(vtkInformation* input);

  /** Returns the class of Process()'s output for an input of class `inputClassName` (not composite). */
  virtual const char* GetOutputClassName(const char* inputClassName) { return inputClassName; }

  /** Does the work, for the whole input or one of its blocks. */
  virtual void Process(vtkDataObject* input, vtkDataObject* output) = 0;

  /** Whether all blocks at port 0 are one set of particles. */
  virtual bool TakesTogether() const { return this->Blocks == TOGETHER; }
  /** Whether the output has the input's blocks even if all blocks are one set of particles. */
  virtual bool KeepsBlocks() const { return false; }

  /**
   * Returns the result of vtkSPHTakeVertices(), which is kept while the input is the same.
   * Collective if processes share a run.
   */
  vtkDataObject* TakeVertices(vtkDataObject* data);
  /** Reports how many points of the data are not particles. Collective if processes share a run. */
  void WarnOfMesh(vtkDataObject* data, vtkDataObject* taken);

  /**
   * Returns the particles of an input as one set: of a point set, or of all blocks of composite
   * data. The set is kept while the input is the same. Returns null for other data.
   */
  vtkSmartPointer<vtkPointSet> TakeParticles(vtkDataObject* data);
  /** Calls TakeParticles() before an update. If the data are empty, updates the input first, unless
   * processes share a run. */
  vtkSmartPointer<vtkPointSet> TakeParticlesAhead(vtkDataObject* data);
  /** Makes one set of particles of the result of TakeVertices(), as TakeParticles() does. */
  vtkSmartPointer<vtkPointSet> JoinParticles(vtkDataObject* data);

  /** Reports an error, naming the block, and keeps its sentence. */
  void Fail(const std::string& message);

  /** Reports a warning, naming the block. */
  void Warn(const std::string& message);

  /**
   * Reports a warning, naming the block, unless this run has given a warning of the same kind.
   * kind: a value of mcor_warning or of the enumeration below.
   */
  void WarnOnce(int kind, const std::string& message);
  enum
  {
    WARN_TYPE_ARRAY = 100, ///< an array that tells fluid from solids is not used
    WARN_WALL_BLOCK,       ///< a block of walls is taken by itself
    WARN_LOST_ARRAYS,      ///< some blocks lack arrays
    WARN_UNUSED,           ///< a setting has no effect
    WARN_SINGLE_POINTS     ///< single precision is too coarse for the output's points
  };

  /** Returns the array chosen by SetInputArrayToProcess(index, ...). */
  vtkSPHRequest FindRequest(int index, vtkPointSet* particles);

  /** Whether processes share a run; always false in a build without MPI. */
  bool IsShared() const;

  /** Returns the input that has the particles; null: there is none. */
  vtkDataObject* GetParticles();
  virtual int GetParticlesPort() { return 0; }

  void FillOptions(mcor_options& options) const;

  void SetUsedNames(const vtkSPHParticles* particles, bool isUsable = true);
  bool IsAborted();

  vtkSmartPointer<vtkPointSet> Particles; // of a second input, as one set; during a run
  std::string NextBlocks, ColorRanges;
  vtkMultiProcessController* Controller = nullptr;

  int MessageCount = 0;
  std::set<int> Warned;  // kinds of warnings that this run has given
  std::string BlockName; // text before messages about a block of composite data
  vtkSmartPointer<vtkFieldData> RunStatistics;
  std::string Statistics;
  class vtkInternals;
  class vtkRun;
  class vtkSharedRun;
  std::unique_ptr<vtkInternals> Internals;

private:
  vtkSPHAlgorithm(const vtkSPHAlgorithm&) = delete;
  void operator=(const vtkSPHAlgorithm&) = delete;

  /** Makes a data object of this class, from `like` if `like` has this class. */
  static vtkSmartPointer<vtkDataObject> NewOutput(
    const std::string& className, vtkDataObject* like);
  /** Finds the six bounds of the fluid or, if `densest` is set, a point on the densest line along each axis; 0: unknown. */
  double* FindNextBounds(bool densest);
  void ProcessBlocks(vtkDataObjectTree* input, vtkDataObjectTree* output);
  bool AgreeOnBlocks(vtkDataObjectTree* blocks);
  void ProcessJoined(vtkDataObjectTree* input, vtkDataObject* output);

  double NextPlaces[2][9] = {}; // what FindNextBounds() has found
};
VTK_ABI_NAMESPACE_END

#endif

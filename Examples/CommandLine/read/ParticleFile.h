// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleFile_h
#define ParticleFile_h

#include "vtkSmartPointer.h"

#include <map>
#include <string>
#include <vector>

struct stat;
class vtkDataObject;
class vtkDataSet;
class vtkPointSet;
struct vtkSPHPeriod;

/// Returns the endings of the files that ReadParticles knows: ".vtp, .vtu, ... or .vtk".
std::string ParticleFileEndings();

/// The words that --only NAME=WORD chooses, by the names of their arrays. An array of texts with such a
/// name is read as the numbers of these words, from 1 on, and 0 for all others.
std::map<std::string, std::vector<std::string>>& ChosenWords();

/// Reads particles and their arrays from files that each hold a part of them. Arrays that are not
/// in all of them are left out, and so are particles that a part marks as another one's
/// (vtkGhostType). Throws std::runtime_error with one sentence if a file cannot be read, is
/// damaged, or there are no points, which a step of a film may lack; where VTK's reader crashes
/// over it, the program ends with a sentence. Names of arrays are made fit to print.
vtkSmartPointer<vtkPointSet> ReadParticles(
  const std::vector<std::string>& files, bool mayBeEmpty = false);

/// The times of the steps that one file holds, which are read as FILE#0, FILE#1, ... where there
/// are several; none where it tells of none. Of FILE#2 that is one time. Throws std::runtime_error.
std::vector<double> ListTimes(const std::string& name);

/// Returns the time between steps that all of these files store as `dt`; 0: they store none, or differ.
double StoredTimeStep(const std::vector<std::string>& files);

/// Reads the particles that --walls names, as one set; null: none. Throws std::runtime_error.
vtkSmartPointer<vtkPointSet> ReadWalls(const std::vector<std::string>& files);

/// Opens these files, and those that hold their parts, before they are read, so that IsSource() knows
/// them. What is wrong with one is told where it is read.
void OpenSources(const std::vector<std::string>& files);

/// Whether this is a file that the run has opened to read: by its device and inode, whatever its name
/// is. Every writer asks.
bool IsSource(const struct stat& file);

/// Particles that files hold at one time. Where any of the data have vertices, points of meshes
/// without vertices are no particles, so cells are kept until all is read.
struct ParticleSets
{
  std::vector<std::string> Files;
  std::vector<vtkSmartPointer<vtkPointSet>> Sets; ///< empty: a step without particles is refused
  bool HaveVertices = false;
  bool IsList = false; ///< pieces may hold copies of other pieces' particles
};

/// The part that this one of `count` processes reads: some pieces of a file that lists pieces, those
/// behind the pieces of the processes before it; another file is the first one's.
ParticleSets ReadParticlesPart(const std::string& file, int rank, int count);

/// Returns the particles, which may be none.
vtkSmartPointer<vtkPointSet> JoinSets(const ParticleSets& sets);

/// Reads a data set of any class with the same care; only names are changed.
vtkSmartPointer<vtkDataSet> ReadDataSet(const std::string& file);

/// Joins parts to one set of particles, with the arrays that all of them have. Leaves out particles
/// that a part marks as copies of another part's ("vtkGhostType").
vtkSmartPointer<vtkPointSet> JoinParts(const std::vector<vtkSmartPointer<vtkPointSet>>& parts);

/// The array that AddWalls() makes: 0 for fluid, 1 for walls.
extern const char* const WallArrayName;

/// The fluid, followed by the walls; the fluid itself where `walls` is null. It keeps the fluid's
/// arrays of numbers. One that walls lack has the fluid's median there: solids take part in no
/// field, so only the smoothing length, and what volumes are made of, count. Throws
/// std::runtime_error.
vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls);

/// The period for "--periodic auto", if one was found without a problem. Throws std::runtime_error where nothing was.
std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem);

/// Returns a hint if --periodic is not given and there is a period, else "".
std::string HintOfPeriod(vtkDataObject* particles);

/// Returns the text of --list-arrays: a line for each array of the particles, and one for each thing that a run would
/// find.
std::string DescribeArrays(vtkPointSet& particles);

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ParticleFile_h
#define ParticleFile_h

#include "vtkSmartPointer.h"

#include <map>
#include <string>
#include <utility>
#include <vector>

struct stat;
class vtkDataObject;
class vtkDataSet;
class vtkFieldData;
class vtkPointSet;
struct vtkSPHPeriod;

// All functions that read throw std::runtime_error with one sentence.

/// Lists the names of arrays; "" stands for an array without a name.
std::vector<std::string> NamesOf(vtkFieldData* data);

/// Adds an array of these numbers, one in each tuple, to field data, or to a table's row.
void AddNumbers(vtkFieldData* data, const std::string& name, const std::vector<double>& numbers);

/// Returns the endings of the files that ReadParticles knows: ".vtp, .vtu, ... or .ply".
std::string ParticleFileEndings();

/// The words that --only NAME=WORD chooses, by array name. An array of texts that has a listed name is read as numbers:
/// 1, 2, ... for the words in their order, 0 for other words.
std::map<std::string, std::vector<std::string>>& ChosenWords();

/// Reads files that each hold a part of the particles, and joins the parts, see ReadSets() and
/// JoinSets(). Throws if there are no points, unless `mayBeEmpty`. Makes names of arrays fit to print.
vtkSmartPointer<vtkPointSet> ReadParticles(
  const std::vector<std::string>& files, bool mayBeEmpty = false, bool isSilent = false);

/// Lists the times of the steps in a file; empty if the file tells no times. The steps can be read
/// as FILE#0, FILE#1, ...; for such a name, lists only this step's time.
std::vector<double> ListTimes(const std::string& name);

/// Returns the time between steps that these files store as `dt`; 0: a file stores none, or the files differ.
double StoredTimeStep(const std::vector<std::string>& files);

/// Reads the particles that --walls names, as one set; null if there are none.
vtkSmartPointer<vtkPointSet> ReadWalls(const std::vector<std::string>& files);

/// Checks these files, and the files of their parts, before they are read, so that IsSource() knows
/// them. Errors are reported later, when a file is read.
void OpenSources(const std::vector<std::string>& files);

/// Whether this is a file that the run reads, see CheckRegularFile(). Device and inode decide, not the
/// name. No output may replace such a file.
bool IsSource(const struct stat& file);

/// Particles of files at one time. Cells are kept until all files are read: if one file has
/// vertices, the points of meshes without vertices are no particles.
struct ParticleSets
{
  std::vector<std::pair<std::string, vtkSmartPointer<vtkPointSet>>>
    Sets; ///< files that have points
  bool HaveVertices = false;
  bool AreParts =
    false; ///< the files are parts of one set, which may hold copies of other parts' particles
};

/// Reads the files that belong to process `rank` of `count`: each process gets successive files. A
/// list of pieces stands for its pieces, a file of a GADGET snapshot for all files of this snapshot.
ParticleSets ReadSets(const std::vector<std::string>& files, int rank = 0, int count = 1);

/// Joins the sets to one, with the arrays that all of them have; there may be no particles. Leaves out
/// particles that a part marks as copies of another part's particles (vtkGhostType). Unless `isSilent`, prints a note
/// on arrays that are left out.
vtkSmartPointer<vtkPointSet> JoinSets(const ParticleSets& sets, bool isSilent = false);

/// Reads a data set of any class, as carefully as ReadParticles().
vtkSmartPointer<vtkDataSet> ReadDataSet(const std::string& file);

/// Name of the array that AddWalls() makes: 0 for fluid, 1 for walls.
extern const char* const WallArrayName;

/// Returns the fluid, followed by the walls; the fluid itself if it is empty or `walls` is null. Keeps
/// the fluid's arrays of numbers. Throws if one of them has the name WallArrayName. If walls lack an
/// array, they get the fluid's median: for solids, only the smoothing length and the arrays that give
/// volumes matter.
vtkSmartPointer<vtkPointSet> AddWalls(vtkPointSet* fluid, vtkPointSet* walls);

/// Returns the period for "--periodic auto". Fails with the problem, or because no period was found.
std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem);

/// Returns a hint for a run without --periodic if the data tell a period or a tilted cell, else "".
std::string HintOfPeriod(vtkDataObject* particles);

/// Returns the text of --list-arrays: a line for each array of the particles, and a line for each setting that a run
/// would take from the particles, such as the smoothing length.
std::string DescribeArrays(vtkPointSet& particles);

#endif

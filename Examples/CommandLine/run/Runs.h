// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Runs_h
#define Runs_h

#include "Extra.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

#include <string>
#include <vector>

class ColorScale;
class Sharing;
class vtkDataSet;
class vtkImageData;
class vtkPointSet;
class vtkSPHAlgorithm;
struct Job;

/// The runs of the program. All return false if a step failed, after its error was printed, and throw UsageError or
/// std::runtime_error with one sentence.

/// Extracts the surface. Writes the surface and the table of its pieces: both, or none. Then writes the widened particles,
/// the statistics and the picture, one after the other; an error ends the run.
bool MakeSurface(Sharing& sharing);

/// Makes a surface, or an image of a projection, for each time of a film. If the output is a .pvd file,
/// also makes this list of the steps. If a step fails, makes the other steps.
bool MakeFilm(Sharing& sharing);

/// Measures, at each time of the input, the free surface along lines; or the flux through sections, and the fluxes' integrals
/// since the first time. Writes a table of the steps that did not fail; for a grid of gauges, an image.
bool MakeMeterTable(Sharing& sharing);

/// Writes a table of the field at the points of a file at each time. The table has the steps that did not fail.
bool MakePointTable(Sharing& sharing);

/// Writes a data set with the field at the points of a file, a slice or a line, or an image of the
/// field's integrals along lines of sight.
bool MakeField(Sharing& sharing);

/// The functions below are parts of the runs above.

/// Makes the settings that depend on the input, for one of the job's filters. Returns the
/// particles, with the arrays of --derive and, unless the filter is the surface's, with the
/// smoothing lengths of --widen or --smooth. Throws std::runtime_error with one sentence if an array
/// is missing.
vtkSmartPointer<vtkPointSet> SetUpParticles(
  vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* input);

/// Runs a filter once, and shows its progress after the words `before`. Returns its seconds. Throws
/// std::runtime_error with the filter's sentence.
double Update(vtkSPHAlgorithm* filter, const Sharing& sharing, const std::string& before = "");

struct Run
{
  vtkSmartPointer<vtkPolyData> Surface;
  vtkSmartPointer<vtkFieldData> Statistics; // arrays of the surface, and of what the run cost
  std::vector<std::string> Warnings;        // sentences that the user should know
  vtkSmartPointer<vtkTable> Pieces;         // table of the surface's pieces; null: not wanted
  double WallSeconds = 0.0; // of the whole filter, which are more than those of its phases
};

/// Extracts the surface of the particles once. If the table `pieces` is wanted: gives the surface the
/// array ComponentId, drops the pieces that are to be left out, and adds to the table a row for each
/// remaining piece. Throws as Update() does.
Run Extract(Sharing& sharing, vtkPointSet* particles, std::string& pieces, double time = 0.0,
  const std::string& progress = "");

/// Widens the range of `colors` for the surface. Adds warnings to the run: of arrays that the surface's
/// file cannot hold and, with `hasHints`, of a period that the data tell, but the run does not use.
void Inspect(const Job& job, const std::string& file, Run& run, vtkPointSet* particles,
  ColorScale& colors, bool hasHints);

/// Returns the bytes of a .png file that shows a surface, points with the field, or an image of the
/// field, with the edges of the box around `frame`.
std::string Draw(const Job& job, const std::string& file, vtkDataSet* data, vtkDataSet* frame,
  const Picture& picture, ColorScale& colors);

/// Writes the picture of the job's only output, if it is wanted.
void WritePicture(const Job& job, vtkDataSet* data, vtkDataSet* frame, ColorScale& colors);

/// Evaluates the field at `points`, or projects the field if `points` is null. Returns the filter's
/// seconds.
double Evaluate(
  Sharing& sharing, vtkPointSet* particles, vtkDataSet* points, const std::string& progress);

/// Returns the image of the projection, on the first process. Throws if no particle lies in the image.
vtkImageData* SeenImage(const Job& job);

/// Returns a text such as "640 x 480 x 1 pixels".
std::string DescribeSize(vtkImageData* image);

/// Returns the numbers of an array of a run; none if the run has no such array. NumberOf() returns the
/// first one, or `none`.
std::vector<double> NumbersOf(vtkFieldData* run, const std::string& name);
double NumberOf(vtkFieldData* run, const std::string& name, double none = 0.0);

/// Chooses the first form whose names in braces, such as {Area} or {ScalarRange:1}, all have values in
/// the run, else the last form. Returns it with the values in place of the names; a name without a value
/// becomes nothing. The value of a quantity that came from an array is the array's name. Numbers that
/// are not whole get six digits.
std::string Fill(vtkFieldData* run, const std::vector<std::string>& forms);

/// Describes a run's field data in four or five lines; with `atLength` in more lines, for users who know the method;
/// with `onlySeconds` in one line, which gives the run's seconds. Returns "" if the run had no particles to use.
std::string DescribeRun(vtkFieldData* run, bool atLength, bool onlySeconds);

/// Returns the statistics of the last of `runs` as JSON, with the seconds of each run.
std::string StatisticsAsJson(const Job& job, const std::vector<Run>& runs,
  const std::vector<std::string>& warnings, double peakResidentBytes);

/// Returns the report of a step of a film. inputs: the step's files; result: the surface's file or, if `run` is null, why
/// there is none.
std::string StepAsJson(double time, const std::vector<std::string>& inputs,
  const std::string& result, vtkFieldData* run, double wallSeconds);

/// Returns the report of a film. run: the last run that went well, or null.
std::string FilmAsJson(const Job& job, const std::vector<std::string>& steps, vtkFieldData* run);

/// Returns the most memory that this process has had so far; 0 if the system does not tell.
double PeakResidentBytes();

/// The part of Extract() for pieces: sets run.Pieces, and adds them to the table `text`. In films, the
/// table has a column of times.
void AddPieces(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time);

/// Adds a row for each iso value to the text of a table of a film's numbers: its triangles, area,
/// volume and pieces, and what gauges read. Does nothing if no table is wanted. Throws
/// std::runtime_error.
void AddFilmNumbers(
  std::string& text, const Sharing& sharing, Run& run, vtkPointSet* particles, double time);

#endif

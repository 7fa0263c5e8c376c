// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Runs_h
#define Runs_h

#include "vtkFieldData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cstddef>
#include <string>
#include <vector>

class ColorScale;
class MessageCapture;
class Picture;
class Sharing;
class vtkImageData;
class vtkPointSet;
class vtkSPHAlgorithm;
class vtkSPHMeter;
class vtkTable;
struct Job;

/// Whether standard error is a terminal whose user has not asked for silence.
bool ShowsProgress(const Job& job);

/// Makes the settings that depend on the input, for one of the job's filters. Returns the
/// particles, with the arrays derived from theirs. Throws std::runtime_error with one sentence
/// where an array is lacking.
vtkSmartPointer<vtkPointSet> SetUpParticles(
  vtkSPHAlgorithm* filter, const Job& job, vtkPointSet* input);

/// Does SetUpParticles() for the surface, which gets the particles as its input.
void SetUpSurface(const Job& job, vtkPointSet* input);

/// Arrays of the particles that are not interpolated because the surface's file could not hold
/// them.
std::vector<std::string> ArraysWithoutPlace(const Job& job, vtkPointSet* particles);

struct Run
{
  vtkSmartPointer<vtkPolyData> Surface;
  vtkSmartPointer<vtkFieldData> Statistics; // of the surface, and of what the run cost
  double WallSeconds = 0.0;
};

/// Runs a filter once, and shows its progress after the words `before`. Returns its seconds. Throws
/// std::runtime_error with the filter's sentence.
double Update(vtkSPHAlgorithm* filter, const Job& job, MessageCapture* messages,
  const std::string& before = "");

/// Runs the surface once. Throws as Update().
Run Extract(const Job& job, MessageCapture* messages, const std::string& before = "");

/// The particles of the last run with the factors of their smoothing lengths. Throws
/// std::runtime_error.
vtkSmartPointer<vtkPolyData> Widen(const Job& job, MessageCapture* messages);

/// Sentences that the user should know of a run that went well.
std::vector<std::string> Warnings(const Run& run, MessageCapture* messages);

/// Adds a hint if --periodic is not given and the particles' field data tell of a period.
void AddHintOfPeriod(const Job& job, vtkPointSet* particles, std::vector<std::string>& warnings);

/// Lists the runs of the program beside that of a single surface. All throw UsageError or
/// std::runtime_error with one sentence.

/// Makes one surface, or projection, for each time of a film, and the .pvd file that lists them.
/// Names a step that fails, does the others, and returns false then.
bool MakeFilm(const Job& job, MessageCapture* messages, Sharing& sharing);

/// Measures the free surface along lines, or what flows through sections and what has flowed since
/// the first time, at each time of the input, and writes the table, or, of a grid of gauges, an
/// image. False if a step failed, of which all was said; the table has the others.
///@{
bool MakeGaugeTable(const Job& job, MessageCapture* messages, Sharing& sharing);
bool MakeFluxTable(const Job& job, MessageCapture* messages, Sharing& sharing);
///@}

/// Adds the gauges of the options to the job's filter. Returns how many there are.
std::size_t AddGauges(const Job& job);

/// The meter's table; shows its progress behind the words `progress`.
vtkTable* MeasureWith(vtkSPHMeter* meter, const Job& job, vtkPointSet* particles, double time,
  MessageCapture* messages, const std::string& progress);

/// Evaluates the field at the points of a file, of a slice or of a line, and writes their data set
/// with the arrays.
void ProbePoints(const Job& job, MessageCapture* messages, Sharing& sharing);

/// Projects particles once. Returns the seconds.
double Project(const Job& job, vtkPointSet* particles, MessageCapture* messages, Sharing& sharing,
  const std::string& before);

/// The image of this projection, on the first process. Throws where no particle is seen.
vtkImageData* SeenImage(const Job& job);

/// The bytes of a .png file of that image.
std::string DrawProjection(const Job& job, const std::string& file, Picture& picture,
  ColorScale& colors, MessageCapture* messages);

/// Projects the particles, and writes the image.
void ProjectParticles(const Job& job, MessageCapture* messages, Sharing& sharing);

/// The table of the pieces of the surfaces of a run, or of the steps of a film, which have a column
/// of times.
class ComponentTable
{
public:
  explicit ComponentTable(const Job& job)
    : Options(&job)
  {
  }

  /// Does nothing if no table is wanted. Else gives the run's surface the array ComponentId,
  /// without the pieces that are to be left out, and the table a row for each piece. Throws
  /// std::runtime_error.
  void Add(Run& run, vtkPointSet* particles, MessageCapture* messages, double time = 0.0);

  const std::string& Text() const { return this->Lines; }

private:
  const Job* Options;
  std::string Lines;
};

/// A table of a film's numbers, a row for each step: the surface's triangles, area, volume and
/// pieces, and what gauges read.
class FilmNumbers
{
public:
  explicit FilmNumbers(const Job& job);

  /// Adds a row. Does nothing if no table is wanted. Throws std::runtime_error.
  void Add(const Run& run, vtkPointSet* particles, MessageCapture* messages, double time,
    std::vector<std::string>& warnings);

  const std::string& Text() const { return this->Lines; }

private:
  const Job& Options;
  std::string Lines;
};

#endif

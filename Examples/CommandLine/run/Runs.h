// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Runs_h
#define Runs_h

#include <cstddef>
#include <string>

class ColorScale;
class MessageCapture;
class Picture;
class Sharing;
class vtkImageData;
class vtkPointSet;
class vtkSPHMeter;
class vtkTable;
struct Job;

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

#endif

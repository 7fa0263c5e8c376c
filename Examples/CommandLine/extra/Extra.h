// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Extra_h
#define Extra_h

#include "vtkSmartPointer.h"

#include <memory>
#include <string>
#include <vector>

class ColorScale;
class vtkDataObject;
class vtkDataSet;
struct PictureOptions;

/// Pictures of a surface, or of what was probed, inside the outline of a frame. Of several, as of a
/// film's steps, each shows the place of all before it: the eye moves back where something would be
/// cut off, and else not at all.
class Picture
{
public:
  /// For LoadExtra().NewPicture(). Throws std::runtime_error with one sentence where this VTK
  /// renders through an X server and there is none: VTK itself would abort.
  static std::unique_ptr<Picture> New(const PictureOptions& options);
  virtual ~Picture() = default;

  /// The bytes of a .png file, which the sentence of a std::runtime_error names. A slice is seen
  /// along this axis.
  virtual std::string Draw(const std::string& file, vtkDataSet* data, vtkDataSet* frame,
    const ColorScale& colors, int sliceAxis = -1) = 0;
};

/// Names what needs many libraries, VTK's rendering and HDF5. These take longer to load than a
/// small run takes, so this is a library of its own.
struct Extra
{
  std::unique_ptr<Picture> (*NewPicture)(const PictureOptions& options);

  /// Points of a .vtkhdf file at one of its steps, and the times of these. Throws
  /// std::runtime_error.
  vtkSmartPointer<vtkDataObject> (*ReadHdf)(const std::string& file, std::size_t step);
  std::vector<double> (*ListHdfTimes)(const std::string& file);

  /// A .stl, .ply or .obj file.
  vtkSmartPointer<vtkDataObject> (*ReadSurface)(const std::string& file);
};

extern "C" __attribute__((visibility("default"))) const Extra MarchingCorrectorsExtra;

// The functions of a .vtkhdf file, in that library. An unstructured grid without steps is read as a
// whole by VTK's reader, whose older versions know nothing else. Files whose values lie in other
// files, too, are refused; the times are none where there are no steps.
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t step);
std::vector<double> ListHdfTimes(const std::string& file);

/// Loads the library. Throws std::runtime_error where it cannot be loaded.
const Extra& LoadExtra();

#endif

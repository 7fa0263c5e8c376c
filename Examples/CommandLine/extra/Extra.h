// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Extra_h
#define Extra_h

#include "vtkSmartPointer.h"

#include <memory>
#include <string>
#include <vector>

class Picture;
class vtkDataObject;
struct PictureOptions;

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

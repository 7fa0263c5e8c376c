// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Extra_h
#define Extra_h

#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class ColorScale;
class vtkDataObject;
class vtkDataSet;
struct PictureOptions;

/// Draws a picture of a surface, or of a probed data set, with the edges of the box around `frame`;
/// returns the bytes of a .png file. In a series, such as a film's steps, the view has room for all
/// pictures so far: the eye moves back if something would be cut off, and otherwise stays.
/// file: the picture's name, for the sentence of a std::runtime_error. sliceAxis: the axis along
/// which the viewer looks at a slice; below 0: there is no slice.
using Picture = std::function<std::string(const std::string& file, vtkDataSet* data,
  vtkDataSet* frame, const ColorScale& colors, int sliceAxis)>;

// Functions that need large libraries: VTK's rendering, and HDF5. Loading these libraries takes longer than
// a small run, so the functions are in a library of their own. All throw std::runtime_error with one
// sentence.

/// Makes the function that draws. The options must live as long as this function. Fails if this VTK renders
/// through an X server and finds none: VTK itself would abort.
Picture NewPicture(const PictureOptions& options);

/// ReadHdf() returns the points of one step of a .vtkhdf file; ListHdfTimes() returns the times of the steps,
/// none for a file without steps. VTK's reader is not used for poly data and for steps, because old
/// versions of VTK know neither. A file is refused if some of its values lie in other files.
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t step);
std::vector<double> ListHdfTimes(const std::string& file);

/// The functions that the library offers: the three above, and one that reads a .stl, .ply or .obj file.
struct Extra
{
  decltype(&::NewPicture) NewPicture;
  decltype(&::ReadHdf) ReadHdf;
  decltype(&::ListHdfTimes) ListHdfTimes;
  vtkSmartPointer<vtkDataObject> (*ReadSurface)(const std::string& file);
};

extern "C" __attribute__((visibility("default"))) const Extra MarchingCorrectorsExtra;

/// Loads the library. Throws std::runtime_error if that fails.
const Extra& LoadExtra();

#endif

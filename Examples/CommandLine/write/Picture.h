// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Picture_h
#define Picture_h

#include <memory>
#include <string>

class ColorScale;
class MessageCapture;
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
    const ColorScale& colors, MessageCapture* messages, int sliceAxis = -1) = 0;
};

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef Picture_h
#define Picture_h

#include "vtkBoundingBox.h"

#include <memory>
#include <string>

class ColorScale;
class MessageCapture;
class vtkDataSet;
struct PictureOptions;

/// Pictures of a surface, or of what was probed, inside the outline of a frame. Of several, as of a film's
/// steps, each shows the place of all before it: the eye moves back where something would be cut off, and
/// else not at all.
class Picture
{
public:
  /// Throws std::runtime_error with one sentence where this VTK renders through an X server and there is
  /// none: VTK itself would abort.
  explicit Picture(const PictureOptions& options);
  ~Picture();
  Picture(const Picture&) = delete;
  void operator=(const Picture&) = delete;

  /// The bytes of a .png file, which the sentence of a std::runtime_error names. A slice is seen along this
  /// axis.
  std::string Draw(const std::string& file, vtkDataSet* data, vtkDataSet* frame,
    const ColorScale& colors, MessageCapture* messages, int sliceAxis = -1);

private:
  class Scene;
  const PictureOptions& Options;
  std::unique_ptr<Scene> Drawn;
  vtkBoundingBox Seen;
};

#endif

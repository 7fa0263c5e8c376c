// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef ColorScale_h
#define ColorScale_h

#include "vtkLookupTable.h"
#include "vtkNew.h"

#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;
struct PictureOptions;

/// Refuses an array to colour by that is none of these. Throws std::runtime_error.
void CheckColorName(const std::string& name, const std::vector<std::string>& names);

/// The colours of --color-by: those of a picture, and of a .ply file's points.
class ColorScale
{
public:
  explicit ColorScale(const PictureOptions& options);

  /// Widens the range by the values of most of this data set's area, unless a range was given: a film's colours
  /// cover all steps so far. Throws std::runtime_error if the data set has points but no such
  /// array.
  void Include(vtkDataSet* data);

  /// The array of the data set that colours its points, or its cells; nullptr if there is none.
  vtkDataArray* ArrayOf(vtkDataSet* data) const;
  vtkDataArray* CellArrayOf(vtkDataSet* data) const;

  /// Suggests an array if none was wanted: the one that tells several iso values of the surface
  /// apart, if there are several.
  void Suggest(vtkDataSet* surface, const std::string& isoValueArray);

  const std::string& GetName() const { return this->Name; } ///< empty: no array was asked for
  void SetName(const std::string& name) { this->Name = name; }
  vtkLookupTable* GetTable() const { return this->Table; }

  /// Returns red, green and blue of the array's values.
  std::vector<unsigned char> Map(vtkDataArray* array) const;

private:
  std::string Name;
  const bool IsGiven;
  bool HasRange;
  vtkNew<vtkLookupTable> Table;
};

#endif

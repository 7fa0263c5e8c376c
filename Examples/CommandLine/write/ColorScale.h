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

/// Throws std::runtime_error if `name`, the array to colour by, is not one of `names`.
void CheckColorName(const std::string& name, const std::vector<std::string>& names);

/// The colours of --color-by, for a picture and for a .ply file's points.
class ColorScale
{
public:
  explicit ColorScale(const PictureOptions& options);

  /// Unless the user gave a range, widens the colours' range until it has the values on most of this data set's
  /// area or, for an array of cells, all values. A film's colours thus cover all steps so far. Throws
  /// std::runtime_error if the data set has points, but the array to colour by is missing or holds texts.
  void Include(vtkDataSet* data);

  /// Returns the array of the data set that colours its points, or its cells; nullptr: none does.
  vtkDataArray* ArrayOf(vtkDataSet* data) const;
  vtkDataArray* CellArrayOf(vtkDataSet* data) const;

  /// If no array was wanted, and there are several iso values, colours by iso value; or by band, for filled regions.
  void Suggest(vtkDataSet* surface, const std::string& isoValueArray);

  const std::string& GetName() const { return this->Name; } ///< empty: no array was asked for
  void SetName(const std::string& name) { this->Name = name; }
  vtkLookupTable* GetTable() const { return this->Table; }

  /// Returns red, green and blue for each of the array's values.
  std::vector<unsigned char> Map(vtkDataArray* array) const;

private:
  std::string Name;
  const bool IsGiven;
  bool HasRange;
  vtkNew<vtkLookupTable> Table;
};

#endif

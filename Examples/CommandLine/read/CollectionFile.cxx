// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "OptionValue.h"
#include "SafeText.h"

#include "vtkSmartPointer.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLUtilities.h"

#include <algorithm>
#include <filesystem>

namespace
{

namespace fs = std::filesystem;

std::string AttributeOf(vtkXMLDataElement* element, const char* name)
{
  const char* value = element->GetAttribute(name);
  return value ? value : "";
}

/// The element below the root of a VTK XML file that has this name.
vtkSmartPointer<vtkXMLDataElement> ReadElement(const std::string& file, const char* name)
{
  CheckRegularFile(file);
  vtkSmartPointer<vtkXMLDataElement> root;
  ReadWithCare(file,
    [&file, &root] { root.TakeReference(vtkXMLUtilities::ReadElementFromFile(file.c_str())); });
  if (!root)
  {
    FailToRead(file, "it is not XML, or damaged");
  }
  vtkXMLDataElement* found = root->FindNestedElementWithName(name);
  if (!found)
  {
    FailToRead(file, std::string("it has no element ") + name);
  }
  return found;
}

std::string Resolved(const std::string& list, const std::string& file)
{
  return (fs::path(list).parent_path() / file).string(); // an absolute name stays as it is
}

}

std::vector<CollectionEntry> ReadCollection(
  const std::string& file, std::vector<std::string>& warnings)
{
  const vtkSmartPointer<vtkXMLDataElement> list = ReadElement(file, "Collection");
  std::vector<CollectionEntry> entries;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* element = list->GetNestedElement(i);
    if (std::string(element->GetName()) != "DataSet")
    {
      continue;
    }
    const std::string time = AttributeOf(element, "timestep"), name = AttributeOf(element, "file");
    double value = 0.0;
    if (name.empty() || (!time.empty() && !ParseNumber(time, value)))
    {
      FailToRead(file,
        name.empty() ? "entry " + std::to_string(i) + " names no file"
                     : "the time of " + name + " is '" + time + "', not a number");
    }
    const std::string part = AttributeOf(element, "part");
    entries.push_back({ value, Resolved(file, name),
      part.empty() ? "" : AttributeOf(element, "group") + " part " + part });
  }
  if (entries.empty())
  {
    FailToRead(file, "it lists no files");
  }
  std::stable_sort(entries.begin(), entries.end(),
    [](const CollectionEntry& a, const CollectionEntry& b) { return a.Time < b.Time; });
  // A run that was repeated into the same folder adds its steps to the list: the last ones count.
  std::vector<CollectionEntry> kept;
  std::size_t again = 0;
  double first = 0.0;
  for (const CollectionEntry& entry : entries)
  {
    const auto same = std::find_if(kept.begin(), kept.end(),
      [&entry](const CollectionEntry& other)
      {
        return other.Time == entry.Time &&
          (other.File == entry.File || (!entry.Part.empty() && other.Part == entry.Part));
      });
    if (same == kept.end())
    {
      kept.push_back(entry);
      continue;
    }
    *same = entry;
    first = again == 0 ? entry.Time : first;
    ++again;
  }
  if (again > 0)
  {
    warnings.push_back(file + " lists " + std::to_string(again) +
      (again == 1 ? " file" : " files") +
      " of a time and a part that it had before, the first at time " + DigitsOf(first) +
      "; the later ones were taken");
  }
  return kept;
}

std::vector<std::string> ReadPieces(const std::string& file)
{
  const bool isPolyData = file.back() == 'p';
  const vtkSmartPointer<vtkXMLDataElement> list =
    ReadElement(file, isPolyData ? "PPolyData" : "PUnstructuredGrid");
  std::vector<std::string> pieces;
  for (int i = 0; i < list->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* element = list->GetNestedElement(i);
    const std::string name = AttributeOf(element, "Source");
    if (std::string(element->GetName()) == "Piece" && !name.empty())
    {
      pieces.push_back(Resolved(file, name));
    }
  }
  if (pieces.empty())
  {
    FailToRead(file, "it lists no pieces");
  }
  return pieces;
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Text.h"

#include "vtkSPHSay.h"
#include "vtkSmartPointer.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLUtilities.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace
{

namespace fs = std::filesystem;

std::string AttributeOf(vtkXMLDataElement* element, const char* name)
{
  const char* value = element->GetAttribute(name);
  return value ? value : "";
}

/// Returns the elements called `name` in the element called `list` below the root of a VTK XML file.
std::vector<vtkSmartPointer<vtkXMLDataElement>> ReadElements(
  const std::string& file, const char* list, const std::string& name)
{
  CheckRegularFile(file);
  vtkSmartPointer<vtkXMLDataElement> root;
  ReadWithCare(file,
    [&file, &root] { root.TakeReference(vtkXMLUtilities::ReadElementFromFile(file.c_str())); });
  RequireToRead(root, file, "it is not XML, or damaged");
  vtkXMLDataElement* found = root->FindNestedElementWithName(list);
  RequireToRead(found, file, std::string("it has no element ") + list);
  std::vector<vtkSmartPointer<vtkXMLDataElement>> elements;
  for (int i = 0; i < found->GetNumberOfNestedElements(); ++i)
  {
    vtkXMLDataElement* element = found->GetNestedElement(i);
    elements.insert(elements.end(), element->GetName() == name ? 1 : 0, element);
  }
  return elements;
}

/// Splits JSON into signs, numbers, words and texts. A text keeps only its first quotation mark.
std::vector<std::string> Tokens(const std::string& text)
{
  std::vector<std::string> tokens;
  for (std::size_t at = 0; (at = text.find_first_not_of(" \t\r\n", at)) != std::string::npos;)
  {
    std::string token(1, text[at++]);
    if (token != "\"")
    {
      const bool isSign = std::string("{}[]:,").find(token) != std::string::npos;
      const std::size_t end =
        isSign ? at : std::min(text.find_first_of(" \t\r\n{}[]:,\"", at), text.size());
      tokens.push_back(token + text.substr(at, end - at));
      at = end;
      continue;
    }
    for (; at < text.size() && text[at] != '"'; ++at)
    {
      const bool isMasked = text[at] == '\\' && at + 1 < text.size();
      at += isMasked ? 1 : 0;
      if (!isMasked || text[at] != 'u')
      {
        token += text[at];
        continue;
      }
      const auto code = std::strtoul(text.substr(at + 1, 4).c_str(), nullptr, 16);
      at += std::min<std::size_t>(4, text.size() - 1 - at);
      const int bits = code < 0x80 ? 0 : code < 0x800 ? 6 : 12; // bits in the bytes behind the first one
      token += static_cast<char>((bits == 0 ? 0 : bits == 6 ? 0xC0 : 0xE0) | code >> bits);
      for (int shift = bits - 6; shift >= 0; shift -= 6)
      {
        token += static_cast<char>(0x80 | (code >> shift & 0x3F));
      }
    }
    tokens.push_back(token);
    at += 1;
  }
  return tokens;
}

std::string Resolved(const std::string& list, const std::string& file)
{
  return (fs::path(list).parent_path() / file).string(); // an absolute name stays as it is
}

/// Reads ParaView's {"files": [{"name": "a.vtk", "time": 0}, ...]}.
std::vector<CollectionEntry> ReadSeries(const std::string& file)
{
  CheckRegularFile(file);
  const std::vector<std::string> tokens = Tokens(std::string(*BytesOf(file)));
  const auto at = [&tokens](std::size_t i) { return i < tokens.size() ? tokens[i] : ""; };
  std::vector<CollectionEntry> entries;
  const std::size_t begin =
    static_cast<std::size_t>(std::find(tokens.begin(), tokens.end(), "\"files") - tokens.begin());
  std::size_t i = begin + 2;
  bool isGood = at(begin + 1) == ":" && at(i) == "[";
  while (isGood && at(i) != "]")
  {
    CollectionEntry entry = { 0.0, "", "" };
    bool hasTime = false;
    isGood = at(i + 1) == "{";
    for (i += 2; at(i - 1) != "}" && isGood; i += 4) // at KEY : VALUE, then a comma or the end
    {
      hasTime = hasTime || (at(i) == "\"time" && ParseNumber(at(i + 2), entry.Time));
      entry.File = at(i) == "\"name" && at(i + 2).size() > 1 ? at(i + 2).substr(1) : entry.File;
      isGood = at(i + 1) == ":" && (at(i + 3) == "," || at(i + 3) == "}");
    }
    isGood = isGood && hasTime && !entry.File.empty() && (at(i) == "," || at(i) == "]");
    entry.File = Resolved(file, entry.File);
    entries.push_back(entry);
  }
  Require(isGood && !entries.empty(), vtkSPHSay(MCOR_SAY(NO_SERIES), file.c_str()));
  return entries;
}

/// Reads the entries of a .pvd file.
std::vector<CollectionEntry> ReadEntries(const std::string& file)
{
  std::vector<CollectionEntry> entries;
  for (vtkXMLDataElement* element : ReadElements(file, "Collection", "DataSet"))
  {
    const std::string time = AttributeOf(element, "timestep"), name = AttributeOf(element, "file"),
                      part = AttributeOf(element, "part");
    double value = 0.0;
    RequireToRead(
      !name.empty(), file, "entry " + std::to_string(entries.size()) + " names no file");
    RequireToRead(time.empty() || ParseNumber(time, value), file,
      "the time of " + name + " is '" + time + "', not a number");
    entries.push_back({ value, Resolved(file, name),
      part.empty() ? "" : AttributeOf(element, "group") + " part " + part });
  }
  RequireToRead(!entries.empty(), file, "it lists no files");
  return entries;
}

}

std::vector<CollectionEntry> ReadCollection(
  const std::string& file, std::vector<std::string>& warnings)
{
  const bool isSeries = EndsWith(file, ".series");
  std::vector<CollectionEntry> entries = isSeries ? ReadSeries(file) : ReadEntries(file);
  std::stable_sort(entries.begin(), entries.end(),
    [](const CollectionEntry& a, const CollectionEntry& b) { return a.Time < b.Time; });
  // A run that is repeated in a folder adds its steps to the list again: the last entries count.
  std::vector<CollectionEntry> kept;
  std::vector<double> again;
  for (const CollectionEntry& entry : entries)
  {
    const auto ofTime = std::lower_bound(kept.begin(), kept.end(), entry.Time,
      [](const CollectionEntry& other, double time) { return other.Time < time; });
    const auto same = std::find_if(isSeries ? kept.end() : ofTime, kept.end(),
      [&entry](const CollectionEntry& other)
      { return other.File == entry.File || (!entry.Part.empty() && other.Part == entry.Part); });
    if (same == kept.end())
    {
      kept.push_back(entry);
      continue;
    }
    *same = entry;
    again.push_back(entry.Time);
  }
  if (!again.empty())
  {
    warnings.push_back(
      vtkSPHSay(MCOR_SAY(LISTED_TWICE), file.c_str(), static_cast<long long>(again.size()),
        again.size() == 1 ? "file" : "files", DigitsOf(again.front()).c_str()));
  }
  return kept;
}

std::vector<std::string> ReadPieces(const std::string& file)
{
  const bool isPolyData = file.back() == 'p';
  std::vector<std::string> pieces;
  for (vtkXMLDataElement* element :
    ReadElements(file, isPolyData ? "PPolyData" : "PUnstructuredGrid", "Piece"))
  {
    const std::string name = AttributeOf(element, "Source");
    pieces.insert(pieces.end(), name.empty() ? 0 : 1, Resolved(file, name));
  }
  RequireToRead(!pieces.empty(), file, "it lists no pieces");
  return pieces;
}

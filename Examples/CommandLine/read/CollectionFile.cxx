// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "FileName.h"
#include "OptionValue.h"
#include "SafeText.h"

#include "vtkSPHSay.h"
#include "vtkSmartPointer.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLUtilities.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace
{

namespace fs = std::filesystem;

std::string AttributeOf(vtkXMLDataElement* element, const char* name)
{
  const char* value = element->GetAttribute(name);
  return value ? value : "";
}

/// Returns the element of this name below the root of a VTK XML file.
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

/// Splits JSON into signs, numbers and words, and texts, which begin with a quotation mark here.
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
      if (isMasked && text[at] == 'u') // the code of a character outside of ASCII
      {
        const auto code = std::strtoul(text.substr(at + 1, 4).c_str(), nullptr, 16);
        at += std::min<std::size_t>(4, text.size() - 1 - at);
        token += code < 0x80 ? std::string(1, static_cast<char>(code))
          : code < 0x800     ? std::string{ static_cast<char>(0xC0 | code >> 6) }
                             : std::string{ static_cast<char>(0xE0 | code >> 12),
                             static_cast<char>(0x80 | (code >> 6 & 0x3F)) };
        token += code < 0x80 ? "" : std::string(1, static_cast<char>(0x80 | (code & 0x3F)));
        continue;
      }
      token += text[at];
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

/// Reads ParaView's {"files": [{"name": "a.vtk", "time": 0}, ...]}, in the order of time.
std::vector<CollectionEntry> ReadSeries(const std::string& file)
{
  CheckRegularFile(file);
  std::ifstream stream(file, std::ios::binary);
  const std::vector<std::string> tokens =
    Tokens({ std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>() });
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
  if (!isGood || entries.empty())
  {
    throw std::runtime_error(vtkSPHSay(MCOR_SAY(NO_SERIES), file.c_str()));
  }
  std::stable_sort(entries.begin(), entries.end(),
    [](const CollectionEntry& a, const CollectionEntry& b) { return a.Time < b.Time; });
  return entries;
}

}

std::vector<CollectionEntry> ReadCollection(
  const std::string& file, std::vector<std::string>& warnings)
{
  if (EndsWith(file, ".series"))
  {
    return ReadSeries(file);
  }
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
  // A run that is repeated in a folder adds its steps to the list again: the last entries count.
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
    warnings.push_back(vtkSPHSay(MCOR_SAY(LISTED_TWICE), file.c_str(),
      static_cast<long long>(again), again == 1 ? "file" : "files", DigitsOf(first).c_str()));
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

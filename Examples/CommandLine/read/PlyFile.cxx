// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Text.h"
#include "TextTable.h"

#include "vtkSPHSay.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>

namespace
{

/// How a type of numbers is stored in the file.
struct NumberKind
{
  std::size_t Size;
  double (*Read)(const char* bytes); ///< bytes in this machine's order
  bool IsWhole;
};

template <typename T>
NumberKind KindOf()
{
  return { sizeof(T),
    [](const char* bytes)
    {
      T value;
      std::memcpy(&value, bytes, sizeof(T));
      return static_cast<double>(value);
    },
    std::is_integral_v<T> };
}

const std::map<std::string, NumberKind> NumberKinds = {
  { "char", KindOf<std::int8_t>() },
  { "int8", KindOf<std::int8_t>() },
  { "uchar", KindOf<std::uint8_t>() },
  { "uint8", KindOf<std::uint8_t>() },
  { "short", KindOf<std::int16_t>() },
  { "int16", KindOf<std::int16_t>() },
  { "ushort", KindOf<std::uint16_t>() },
  { "uint16", KindOf<std::uint16_t>() },
  { "int", KindOf<std::int32_t>() },
  { "int32", KindOf<std::int32_t>() },
  { "uint", KindOf<std::uint32_t>() },
  { "uint32", KindOf<std::uint32_t>() },
  { "float", KindOf<float>() },
  { "float32", KindOf<float>() },
  { "double", KindOf<double>() },
  { "float64", KindOf<double>() },
};

/// An element of the head, such as the vertices, with its properties.
struct Element
{
  std::string Name;
  vtkTypeInt64 Count = 0;
  std::vector<std::string> Names;
  std::vector<NumberKind> Kinds;
  bool HasLists = false;
};

/// Reads the head. `form` is ascii, binary_little_endian or binary_big_endian.
std::vector<Element> ReadHead(Lines& lines, std::string& form)
{
  std::vector<Element> elements;
  lines.Need("its head");
  RequireToRead(lines.Get() == "ply", lines.File, "it is no .ply file");
  for (lines.Need("the end of its head"); Trimmed(lines.Get()) != "end_header";
       lines.Need("the end of its head"))
  {
    const std::vector<View> words = Split(lines.Get(), ' ');
    const View first = words.empty() ? "comment" : words[0];
    Element* last = elements.empty() ? nullptr : &elements.back();
    vtkTypeInt64 count = 0;
    const auto kind = NumberKinds.find(words.size() == 3 ? std::string(words[1]) : "");
    if (first == "format" && words.size() > 1)
    {
      form = words[1];
    }
    else if (first == "element" && words.size() == 3 && ToInteger(words[2], count) && count >= 0)
    {
      elements.push_back({ std::string(words[1]), count, {}, {}, false });
    }
    else if (first == "property" && last && kind != NumberKinds.end())
    {
      last->Names.emplace_back(words[2]);
      last->Kinds.push_back(kind->second);
    }
    else if (first == "property" && last && words.size() > 1 && words[1] == "list")
    {
      last->HasLists = true;
    }
    else
    {
      Require(first == "comment" || first == "obj_info",
        vtkSPHSay(MCOR_SAY(PLY_HEAD), lines.File.c_str(),
          Printable(std::string(Trimmed(lines.Get()))).c_str()));
    }
  }
  return elements;
}

/// Takes rows of bytes from the beginning of `bytes` into columns.
void TakeRows(
  const std::string& file, View& bytes, const Element& element, bool isSwapped, Table& table)
{
  for (vtkTypeInt64 i = 0; i < element.Count; ++i)
  {
    for (std::size_t c = 0; c < table.size(); ++c)
    {
      const NumberKind& kind = element.Kinds[c];
      char number[8];
      if (bytes.copy(number, kind.Size) < kind.Size)
      {
        FailToRead(
          file, "it ends before all of its " + std::to_string(element.Count) + " vertices");
      }
      bytes.remove_prefix(kind.Size);
      if (isSwapped)
      {
        std::reverse(number, number + kind.Size);
      }
      table[c].Numbers.push_back(kind.Read(number));
      if (kind.IsWhole)
      {
        table[c].Whole.push_back(static_cast<vtkTypeInt64>(table[c].Numbers.back()));
      }
    }
  }
}
}

vtkSmartPointer<vtkDataObject> ReadPly(const std::string& file, std::size_t)
{
  Lines lines(file);
  std::string form;
  const std::vector<Element> elements = ReadHead(lines, form);
  const bool isText = form == "ascii";
  const std::uint16_t one = 1;
  const bool isLittle = *reinterpret_cast<const char*>(&one) == 1;
  RequireToRead(isText || form == "binary_little_endian" || form == "binary_big_endian", file,
    "its format '" + form + "' is not known");
  View bytes = lines.GetRest();
  for (const Element& element : elements)
  {
    const bool isVertex = element.Name == "vertex";
    RequireToRead(!element.Names.empty() || element.HasLists || element.Count == 0, file,
      "its element " + element.Name + " has no properties");
    Require(!element.HasLists || (!isVertex && element.Count == 0),
      vtkSPHSay(MCOR_SAY(PLY_LISTS), file.c_str(), element.Name.c_str()));
    const std::set<std::string> names(element.Names.begin(), element.Names.end());
    Require(!isVertex || names.size() == element.Names.size(),
      vtkSPHSay(MCOR_SAY(PLY_NAMES), file.c_str()));
    Table table = TableOf(element.Names);
    if (!isText)
    {
      TakeRows(file, bytes, element, isLittle == (form == "binary_big_endian"), table);
    }
    for (vtkTypeInt64 i = 0; isText && i < element.Count; ++i)
    {
      lines.Need("all of its vertices");
      AddRow(table, lines, Split(lines.Get(), ' '), ' ');
    }
    if (isVertex)
    {
      return ParticlesOf(file, table, {});
    }
  }
  FailToRead(file, "it has no vertices");
}

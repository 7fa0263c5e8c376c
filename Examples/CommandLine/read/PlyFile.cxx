// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "SafeText.h"
#include "TextTable.h"

#include "vtkSPHSay.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>

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
  std::vector<View> words;
  lines.Need("its head");
  if (lines.Get() != "ply")
  {
    FailToRead(lines.File, "it is no .ply file");
  }
  for (lines.Need("the end of its head"); Trimmed(lines.Get()) != "end_header";
       lines.Need("the end of its head"))
  {
    Split(lines.Get(), ' ', words);
    const std::string first(words.empty() ? "comment" : words[0]);
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
    else if (first != "comment" && first != "obj_info")
    {
      throw std::runtime_error(vtkSPHSay(MCOR_SAY(PLY_HEAD), lines.File.c_str(),
        Printable(std::string(Trimmed(lines.Get()))).c_str()));
    }
  }
  return elements;
}

/// Reads rows of bytes into columns.
void ReadBytes(
  Lines& lines, std::ifstream& stream, const Element& element, bool isSwapped, Table& table)
{
  std::size_t width = 0;
  for (const NumberKind& kind : element.Kinds)
  {
    width += kind.Size;
  }
  std::string row(width, '\0');
  for (vtkTypeInt64 i = 0; i < element.Count; ++i)
  {
    if (!stream.read(&row[0], static_cast<std::streamsize>(width)))
    {
      FailToRead(
        lines.File, "it ends before all of its " + std::to_string(element.Count) + " vertices");
    }
    char* bytes = &row[0];
    for (std::size_t c = 0; c < table.size(); ++c)
    {
      const NumberKind& kind = element.Kinds[c];
      if (isSwapped)
      {
        std::reverse(bytes, bytes + kind.Size);
      }
      table[c].Numbers.push_back(kind.Read(bytes));
      if (kind.IsWhole)
      {
        table[c].Whole.push_back(static_cast<vtkTypeInt64>(table[c].Numbers.back()));
      }
      bytes += kind.Size;
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
  if (!isText && form != "binary_little_endian" && form != "binary_big_endian")
  {
    FailToRead(file, "its format '" + form + "' is not known");
  }
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(lines.Here().Offset);
  for (const Element& element : elements)
  {
    const bool isVertex = element.Name == "vertex";
    if (element.Names.empty() && !element.HasLists && element.Count > 0)
    {
      FailToRead(file, "its element " + element.Name + " has no properties");
    }
    if (element.HasLists && (isVertex || element.Count > 0))
    {
      throw std::runtime_error(vtkSPHSay(MCOR_SAY(PLY_LISTS), file.c_str(), element.Name.c_str()));
    }
    if (isVertex &&
      std::set<std::string>(element.Names.begin(), element.Names.end()).size() <
        element.Names.size())
    {
      throw std::runtime_error(vtkSPHSay(MCOR_SAY(PLY_NAMES), file.c_str()));
    }
    Table table = TableOf(element.Names);
    if (!isText)
    {
      ReadBytes(lines, stream, element, isLittle == (form == "binary_big_endian"), table);
    }
    std::vector<View> cells;
    for (vtkTypeInt64 i = 0; isText && i < element.Count; ++i)
    {
      lines.Need("all of its vertices");
      Split(lines.Get(), ' ', cells);
      AddRow(table, lines, cells, ' ');
    }
    if (isVertex)
    {
      return ParticlesOf(file, table, {});
    }
  }
  FailToRead(file, "it has no vertices");
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkSPHSay.h"
#include "vtkSetGet.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <set>

const std::vector<PlyType> PlyTypes = { { "char", VTK_SIGNED_CHAR }, { "uchar", VTK_UNSIGNED_CHAR },
  { "short", VTK_SHORT }, { "ushort", VTK_UNSIGNED_SHORT }, { "int", VTK_INT },
  { "uint", VTK_UNSIGNED_INT }, { "float", VTK_FLOAT }, { "double", VTK_DOUBLE },
  { "char", VTK_CHAR }, { "int8", VTK_SIGNED_CHAR }, { "uint8", VTK_UNSIGNED_CHAR },
  { "int16", VTK_SHORT }, { "uint16", VTK_UNSIGNED_SHORT }, { "int32", VTK_INT },
  { "uint32", VTK_UNSIGNED_INT }, { "float32", VTK_FLOAT }, { "float64", VTK_DOUBLE } };

namespace
{

/// An element of the head, such as the vertices, with its properties.
struct Element
{
  std::string Name;
  vtkTypeInt64 Count = 0;
  Table Columns;
  std::vector<int> Types; ///< of VTK
  bool HasLists = false;
};

/// Reads the head. form: becomes the name of the file's format, such as ascii or binary_little_endian.
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
    const auto type = std::find_if(PlyTypes.begin(), PlyTypes.end(),
      [&words](const PlyType& each) { return words.size() == 3 && each.first == words[1]; });
    if (first == "format" && words.size() > 1)
    {
      form = words[1];
    }
    else if (first == "element" && words.size() == 3 && ToInteger(words[2], count) && count >= 0)
    {
      elements.push_back({ std::string(words[1]), count, {}, {}, false });
    }
    else if (first == "property" && last && type != PlyTypes.end())
    {
      last->Columns.emplace_back(std::string(words[2]));
      last->Types.push_back(type->second);
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

template <typename T>
double NumberIn(const char* bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

/// Moves the element's rows from the beginning of `bytes` into its columns. isSwapped: the rows are not in this machine's byte order.
void TakeRows(const std::string& file, View& bytes, Element& element, bool isSwapped)
{
  std::vector<std::size_t> sizes;
  std::transform(element.Types.begin(), element.Types.end(), std::back_inserter(sizes),
    [](int type) { return vtkAbstractArray::GetDataTypeSize(type); });
  for (vtkTypeInt64 i = 0; i < element.Count; ++i)
  {
    for (std::size_t c = 0; c < element.Columns.size(); ++c)
    {
      const int type = element.Types[c];
      const std::size_t size = sizes[c];
      char number[8];
      double value = 0.0;
      if (bytes.copy(number, size) < size)
      {
        FailToRead(
          file, "it ends before all of its " + std::to_string(element.Count) + " vertices");
      }
      bytes.remove_prefix(size);
      std::reverse(number, number + (isSwapped ? size : 0));
      switch (type)
      {
        vtkTemplateMacro(value = NumberIn<VTK_TT>(number));
      }
      element.Columns[c].Numbers.push_back(value);
      if (type != VTK_FLOAT && type != VTK_DOUBLE)
      {
        element.Columns[c].Whole.push_back(static_cast<vtkTypeInt64>(value));
      }
    }
  }
}
}

vtkSmartPointer<vtkDataObject> ReadPly(const std::string& file, std::size_t)
{
  Lines lines(file);
  std::string form;
  std::vector<Element> elements = ReadHead(lines, form);
  const bool isText = form == "ascii";
  const std::uint16_t one = 1;
  const bool isLittle = *reinterpret_cast<const char*>(&one) == 1;
  RequireToRead(isText || form == "binary_little_endian" || form == "binary_big_endian", file,
    "its format '" + form + "' is not known");
  View bytes = lines.GetRest();
  for (Element& element : elements)
  {
    const bool isVertex = element.Name == "vertex";
    RequireToRead(!element.Columns.empty() || element.HasLists || element.Count == 0, file,
      "its element " + element.Name + " has no properties");
    Require(!element.HasLists || (!isVertex && element.Count == 0),
      vtkSPHSay(MCOR_SAY(PLY_LISTS), file.c_str(), element.Name.c_str()));
    Table& table = element.Columns;
    std::set<std::string> names;
    for (const Column& column : table)
    {
      Require(names.insert(column.Name).second || !isVertex,
        vtkSPHSay(MCOR_SAY(PLY_NAMES), file.c_str()));
    }
    if (!isText)
    {
      TakeRows(file, bytes, element, isLittle == (form == "binary_big_endian"));
    }
    for (vtkTypeInt64 i = 0; isText && i < element.Count; ++i)
    {
      lines.Need("all of its vertices");
      AddRow(table, lines, Split(lines.Get(), ' '), ' ');
    }
    if (isVertex)
    {
      return ParticlesOf(file, table, FindPositions(file, table));
    }
  }
  FailToRead(file, "it has no vertices");
}

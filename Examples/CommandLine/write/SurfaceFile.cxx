// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"

#include "ColorScale.h"
#include "Failures.h"
#include "Formats.h"
#include "ParticleFile.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkTriangle.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <sstream>
#include <vector>

namespace
{

namespace fs = std::filesystem;

/// Writes a value with its least significant byte first, on every machine.
template <typename T>
void Put(char*& next, T value)
{
  const std::uint16_t one = 1;
  std::memcpy(next, &value, sizeof(value));
  if (*reinterpret_cast<const unsigned char*>(&one) != 1)
  {
    std::reverse(next, next + sizeof(value));
  }
  next += sizeof(value);
}

/// Calls use(count, points) for each cell.
template <typename F>
void ForCells(vtkCellArray* cells, const F& use)
{
  vtkIdType count = 0;
  const vtkIdType* points = nullptr;
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i)
  {
    cells->GetCellAtId(i, count, points);
    use(count, points);
  }
}

/// Writes binary .stl, little endian: triangles, each with its normal. VTK's writers of .stl and .obj
/// are not used, because they write only to files.
void WriteStl(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  bytes = "binary STL by marching-correctors";
  bytes.resize(80, ' ');
  const vtkIdType triangles = surface->GetNumberOfPolys();
  bytes.resize(84 + 50 * static_cast<std::size_t>(triangles));
  char* next = &bytes[80];
  Put(next, static_cast<std::uint32_t>(triangles));
  ForCells(surface->GetPolys(),
    [&next, surface](vtkIdType, const vtkIdType* corners)
    {
      double vectors[4][3]; // the normal, and the corners
      for (int k = 0; k < 3; ++k)
      {
        surface->GetPoint(corners[k], vectors[k + 1]);
      }
      vtkTriangle::ComputeNormal(vectors[1], vectors[2], vectors[3], vectors[0]);
      for (const auto& vector : vectors)
      {
        for (const double value : vector)
        {
          Put(next, static_cast<float>(value));
        }
      }
      Put(next, std::uint16_t(0));
    });
}

/// Writes .obj. With nine digits, every float is read back exactly.
void WriteObj(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  const auto addVectors = [&bytes](const char* word, vtkDataArray* vectors)
  {
    for (vtkIdType i = 0; vectors && i < vectors->GetNumberOfTuples(); ++i)
    {
      char line[96];
      double v[3];
      vectors->GetTuple(i, v);
      std::snprintf(line, sizeof(line), "%s %.9g %.9g %.9g\n", word, v[0], v[1], v[2]);
      bytes += line;
    }
  };
  const auto addCells = [&bytes](const char* word, vtkCellArray* cells, bool haveNormals)
  {
    ForCells(cells,
      [&](vtkIdType count, const vtkIdType* points)
      {
        bytes += word;
        for (vtkIdType k = 0; k < count; ++k)
        {
          const std::string number = std::to_string(points[k] + 1);
          bytes += " " + number + (haveNormals ? "//" + number : "");
        }
        bytes += "\n";
      });
  };
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  bytes = "# by marching-correctors\n";
  addVectors("v", surface->GetPoints() ? surface->GetPoints()->GetData() : nullptr);
  addVectors("vn", normals);
  surface->GetNumberOfPolys() > 0 ? addCells("f", surface->GetPolys(), normals)
                                  : addCells("l", surface->GetLines(), false);
}

/// A component of an array, under a name that no other column has, because readers go by names.
struct Column
{
  vtkAbstractArray* Array;
  int Component;
  std::string Name;
};

/// Adds a column for each component of an array. If there are several components, the columns' names are
/// the array's name, the mark and a letter; or a number, if there are not enough letters.
void AddColumns(std::vector<Column>& columns, vtkAbstractArray* array, const std::string& name,
  const std::string& mark, const std::vector<std::string>& letters = {})
{
  const auto width = static_cast<std::size_t>(array->GetNumberOfComponents());
  for (std::size_t c = 0; c < width; ++c)
  {
    const std::string letter = width <= letters.size() ? letters[c] : std::to_string(c);
    std::string own = width == 1 ? name : name + mark + letter;
    while (std::any_of(
      columns.begin(), columns.end(), [&own](const Column& column) { return column.Name == own; }))
    {
      own += "_";
    }
    columns.push_back({ array, static_cast<int>(c), own });
  }
}

/// Returns the type of .ply files that holds the array's values. 64-bit integers, for which .ply has
/// no type, become doubles.
PlyType FindPlyType(vtkAbstractArray* array)
{
  const int type = array->GetDataType() == VTK_BIT ? VTK_UNSIGNED_CHAR : array->GetDataType();
  const auto found = std::find_if(
    PlyTypes.begin(), PlyTypes.end(), [type](const PlyType& each) { return each.second == type; });
  return found == PlyTypes.end() ? PlyType("double", VTK_DOUBLE) : *found;
}

void PutAs(int type, char*& next, double value)
{
  switch (type)
  {
    vtkTemplateMacro(Put(next, static_cast<VTK_TT>(value)));
  }
}

/// Writes .ply, with a property for each component of each array of numbers. VTK's writer leaves
/// out such arrays. A vector has NAME_x, NAME_y and NAME_z, as Blender and splashsurf name them.
void WritePly(vtkPolyData* surface, const ColorScale& scale, std::string& bytes)
{
  const std::vector<std::string> axes = { "x", "y", "z" };
  vtkNew<vtkFloatArray> nowhere; // for a surface without points
  nowhere->SetNumberOfComponents(3);
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  vtkNew<vtkUnsignedCharArray> colors;
  vtkDataArray* colored = scale.ArrayOf(surface);
  std::vector<unsigned char> mapped = colored ? scale.Map(colored) : std::vector<unsigned char>();
  colors->SetNumberOfComponents(3);
  colors->SetArray(mapped.data(), static_cast<vtkIdType>(mapped.size()), 1);
  std::vector<Column> columns;
  vtkPoints* places = surface->GetPoints();
  AddColumns(columns, places ? places->GetData() : nowhere.Get(), "", "", axes);
  if (normals)
  {
    AddColumns(columns, normals, "n", "", axes);
  }
  if (colored)
  {
    AddColumns(columns, colors, "", "", { "red", "green", "blue" });
  }
  for (vtkAbstractArray* array : vtkSPHListArrays(surface->GetPointData()))
  {
    std::string name = array->GetName();
    std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c <= ' '; }, '_');
    if (vtkDataArray::SafeDownCast(array) && array != normals) // there is no place for texts
    {
      AddColumns(columns, array, name, "_", axes);
    }
  }
  const vtkIdType points = surface->GetNumberOfPoints(), triangles = surface->GetNumberOfPolys();
  std::ostringstream head;
  std::vector<int> types;
  std::size_t size = 0;
  head << "ply\nformat binary_little_endian 1.0\ncomment by marching-correctors\nelement vertex "
       << points;
  for (const Column& column : columns)
  {
    const auto [name, type] = FindPlyType(column.Array);
    types.push_back(type);
    size += vtkAbstractArray::GetDataTypeSize(type);
    head << "\nproperty " << name << " " << column.Name;
  }
  head << "\nelement face " << triangles
       << "\nproperty list uchar uint vertex_indices\nend_header\n";
  bytes = head.str();
  const std::size_t begin = bytes.size();
  bytes.resize(
    begin + size * static_cast<std::size_t>(points) + 13 * static_cast<std::size_t>(triangles));
  char* next = &bytes[begin];
  for (vtkIdType i = 0; i < points; ++i)
  {
    for (std::size_t c = 0; c < columns.size(); ++c)
    {
      auto* array = static_cast<vtkDataArray*>(columns[c].Array);
      PutAs(types[c], next, array->GetComponent(i, columns[c].Component));
    }
  }
  ForCells(surface->GetPolys(),
    [&next](vtkIdType, const vtkIdType* corners)
    {
      Put(next, static_cast<std::uint8_t>(3));
      for (int k = 0; k < 3; ++k)
      {
        Put(next, static_cast<std::uint32_t>(corners[k]));
      }
    });
}

/// Writes lines: a row for each point of each line, a column for each component.
void WriteCsv(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  std::vector<Column> columns = { { nullptr, 0, "Line" } };
  if (surface->GetPoints())
  {
    AddColumns(columns, surface->GetPoints()->GetData(), "", "", { "X", "Y", "Z" });
  }
  // Vectors come first, so that v:0 names a component of v, even if an array of one component has the
  // name v:0.
  for (const bool isVector : { true, false })
  {
    for (vtkAbstractArray* array : vtkSPHListArrays(surface->GetPointData()))
    {
      if ((array->GetNumberOfComponents() > 1) == isVector)
      {
        AddColumns(columns, array, array->GetName(), ":");
      }
    }
  }
  for (const Column& column : columns)
  {
    bytes += (column.Array ? "," : "") + TableField(column.Name);
  }
  bytes += "\n";
  vtkIdType line = 0;
  ForCells(surface->GetLines(),
    [&](vtkIdType count, const vtkIdType* points)
    {
      for (vtkIdType k = 0; k < count; ++k)
      {
        for (const Column& column : columns)
        {
          bytes += column.Array ? "," + TableField(column.Array, points[k], column.Component)
                                : std::to_string(line);
        }
        bytes += "\n";
      }
      ++line;
    });
}

/// Writes the element of a .pvtp file that describes the arrays of the pieces, as VTK's writers do. The
/// element names the arrays that have a role, such as the normals. VTK's name of a type has the number
/// of bits, as in Float32.
void Describe(std::ostream& text, const std::string& element, vtkDataSetAttributes* arrays)
{
  text << "    <" << element;
  for (int role = 0; role < vtkDataSetAttributes::NUM_ATTRIBUTES; ++role)
  {
    vtkAbstractArray* array = arrays->GetAbstractAttribute(role);
    if (array && array->GetName())
    {
      text << ' ' << vtkDataSetAttributes::GetAttributeTypeAsString(role) << "=\""
           << EscapedForXml(array->GetName()) << '"';
    }
  }
  text << ">\n";
  for (vtkAbstractArray* array : vtkSPHListArrays(arrays))
  {
    const int type = array->GetDataType();
    const bool isSigned =
      vtkArrayDownCast<vtkDataArray>(array) && vtkDataArray::GetDataTypeMin(type) < 0.0;
    const char* kind = type == VTK_FLOAT || type == VTK_DOUBLE ? "Float"
      : isSigned                                               ? "Int"
                                                               : "UInt";
    const std::string size = std::to_string(8 * array->GetDataTypeSize());
    text << "      <PDataArray type=\"" << (type == VTK_STRING ? "String" : kind + size)
         << "\" Name=\"" << EscapedForXml(array->GetName()) << "\" NumberOfComponents=\""
         << array->GetNumberOfComponents() << "\"/>\n";
  }
  text << "    </" << element << ">\n";
}

/// Every format that is written, with its writer; DataSetBytes() writes .vtp.
using Writer = std::function<void(vtkPolyData*, const ColorScale&, std::string& bytes)>;
const std::vector<FileFormat<Writer>> Formats = { { ".vtp", nullptr }, { ".stl", WriteStl },
  { ".ply", WritePly }, { ".obj", WriteObj }, { ".csv", WriteCsv } };

const char* const FilmMark = "<!-- a step of a film by marching-correctors -->";

}

bool IsSurfaceFile(const std::string& file)
{
  return FindFormat(Formats, file) != nullptr;
}

std::string SurfaceFileEndings()
{
  return ListEndings(Formats);
}

std::string SurfaceBytes(const std::string& file, vtkPolyData* surface, const ColorScale& colors)
{
  if (EndsWith(file, ".vtp"))
  {
    return DataSetBytes(file, surface);
  }
  const Activity writing(file + " could not be written", "memory may have run out");
  const bool isTable = EndsWith(file, ".csv");
  const vtkIdType lines = surface->GetNumberOfLines(), triangles = surface->GetNumberOfPolys();
  RequireToWrite(lines == 0 || triangles > 0 || isTable || EndsWith(file, ".obj"), file,
    "this format cannot hold lines, which particles in a plane give; "
    "write a .vtp file, or a .csv file of their points");
  RequireToWrite(!isTable || lines > 0 || triangles == 0, file,
    "this format holds the points of lines, which particles in a plane "
    "give, but this is a surface; write a .vtp file");
  std::string bytes;
  FindFormat(Formats, file)->Process(surface, colors, bytes);
  return bytes;
}

std::string MarkedStep(std::string bytes)
{
  bytes.insert(bytes.find("?>") + 2, std::string("\n") + FilmMark);
  return bytes;
}

bool IsFilmStep(const std::string& file)
{
  return BytesOf(file)->substr(0, 256).find(FilmMark) != View::npos;
}

bool HoldsArrays(const std::string& file)
{
  return !EndsWith(file, ".stl") && !EndsWith(file, ".obj");
}

std::string LostArrays(
  const std::string& file, vtkPolyData* surface, const std::vector<std::string>& more)
{
  const bool isPly = EndsWith(file, ".ply");
  std::vector<std::string> names = more;
  for (vtkAbstractArray* array : vtkSPHListArrays(surface->GetPointData()))
  {
    const std::string name = array->GetName();
    const bool isHeld = isPly ? vtkDataArray::SafeDownCast(array) != nullptr
                              : name == "Normals" || name == "IsoValue" || name == "Widening";
    names.insert(names.end(), isHeld ? 0 : 1, name);
  }
  if ((HoldsArrays(file) && !isPly) || names.empty())
  {
    return "";
  }
  return fs::path(file).extension().string() + " files hold no " + (isPly ? "text" : "arrays") +
    ", so these are left out: " + Joined(names) + "; .vtp keeps all" +
    (isPly ? "" : ", .ply those of numbers") + ", --no-attributes makes none";
}

std::string PieceName(const std::string& file, int rank)
{
  const fs::path path(file);
  return (path.parent_path() / (path.stem().string() + "_" + std::to_string(rank) + ".vtp"))
    .string();
}

std::string ListPieces(const std::string& file, int count, vtkPolyData* piece)
{
  std::ostringstream text;
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"1.0\">\n"
       << "  <PPolyData GhostLevel=\"0\">\n";
  vtkNew<vtkPointData> places;
  if (piece->GetPoints())
  {
    places->AddArray(piece->GetPoints()->GetData());
  }
  Describe(text, "PPointData", piece->GetPointData());
  Describe(text, "PCellData", piece->GetCellData());
  Describe(text, "PPoints", places);
  for (int rank = 0; rank < count; ++rank)
  {
    text << "    <Piece Source=\""
         << EscapedForXml(fs::path(PieceName(file, rank)).filename().string()) << "\"/>\n";
  }
  text << "  </PPolyData>\n</VTKFile>\n";
  return text.str();
}

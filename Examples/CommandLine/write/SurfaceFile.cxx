// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"

#include "ColorScale.h"
#include "Ending.h"
#include "FileName.h"
#include "SafeText.h"

#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangle.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <vector>

namespace
{

namespace fs = std::filesystem;

/// Makes room for more bytes. Returns their place.
char* Grow(std::string& bytes, std::size_t more)
{
  const std::size_t begin = bytes.size();
  bytes.resize(begin + more);
  return &bytes[0] + begin;
}

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

void PutVector(char*& next, const double (&vector)[3])
{
  for (const double value : vector)
  {
    Put(next, static_cast<float>(value));
  }
}

/// Calls use(corners) for each triangle.
template <typename F>
void ForTriangles(vtkPolyData* surface, const F& use)
{
  vtkCellArray* triangles = surface->GetPolys();
  vtkIdType count = 0;
  const vtkIdType* corners = nullptr;
  for (vtkIdType i = 0; i < triangles->GetNumberOfCells(); ++i)
  {
    triangles->GetCellAtId(i, count, corners);
    use(corners);
  }
}

/// Writes binary .stl, little endian: triangles, each with its normal. VTK's writers of .stl and .obj
/// are not used, because they write only to files.
void WriteStl(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  bytes = "binary STL by marching-correctors";
  bytes.resize(80, ' ');
  const vtkIdType count = surface->GetNumberOfPolys();
  char* next = Grow(bytes, 4 + 50 * static_cast<std::size_t>(count));
  Put(next, static_cast<std::uint32_t>(count));
  ForTriangles(surface,
    [&next, surface](const vtkIdType* corners)
    {
      double points[3][3], normal[3];
      for (int k = 0; k < 3; ++k)
      {
        surface->GetPoint(corners[k], points[k]);
      }
      vtkTriangle::ComputeNormal(points[0], points[1], points[2], normal);
      PutVector(next, normal);
      for (const auto& point : points)
      {
        PutVector(next, point);
      }
      Put(next, std::uint16_t(0));
    });
}

/// Appends a word and a vector. With nine digits, every float is read back exactly.
void AppendLine(std::string& text, const char* word, const double (&vector)[3])
{
  char line[96];
  std::snprintf(line, sizeof(line), "%s %.9g %.9g %.9g\n", word, vector[0], vector[1], vector[2]);
  text += line;
}

void WriteObj(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  vtkDataArray* normals = surface->GetPointData()->GetNormals();
  bytes = "# by marching-correctors\n";
  double vector[3];
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    surface->GetPoint(i, vector);
    AppendLine(bytes, "v", vector);
  }
  for (vtkIdType i = 0; normals && i < surface->GetNumberOfPoints(); ++i)
  {
    normals->GetTuple(i, vector);
    AppendLine(bytes, "vn", vector);
  }
  ForTriangles(surface,
    [&](const vtkIdType* corners)
    {
      bytes += "f";
      for (int k = 0; k < 3; ++k)
      {
        const std::string number = std::to_string(corners[k] + 1);
        bytes += " " + number + (normals ? "//" + number : "");
      }
      bytes += "\n";
    });
}

/// A type of .ply files: its name, its size, and how a value is written. No type has 64-bit integers.
struct PlyType
{
  const char* Name;
  std::size_t Size;
  void (*PutValue)(char*& next, double value);
};

template <typename T>
PlyType MakePlyType(const char* name)
{
  return { name, sizeof(T), [](char*& next, double value) { Put(next, static_cast<T>(value)); } };
}

PlyType FindPlyType(vtkDataArray* array)
{
  static const std::map<int, PlyType> types = { { VTK_FLOAT, MakePlyType<float>("float") },
    { VTK_INT, MakePlyType<std::int32_t>("int") },
    { VTK_UNSIGNED_INT, MakePlyType<std::uint32_t>("uint") },
    { VTK_SHORT, MakePlyType<std::int16_t>("short") },
    { VTK_UNSIGNED_SHORT, MakePlyType<std::uint16_t>("ushort") },
    { VTK_CHAR, MakePlyType<std::int8_t>("char") },
    { VTK_SIGNED_CHAR, MakePlyType<std::int8_t>("char") },
    { VTK_UNSIGNED_CHAR, MakePlyType<std::uint8_t>("uchar") },
    { VTK_BIT, MakePlyType<std::uint8_t>("uchar") } };
  const auto found = types.find(array->GetDataType());
  return found == types.end() ? MakePlyType<double>("double") : found->second;
}

/// Writes .ply, with a property for each component of each array of numbers, which VTK's writer
/// leaves out. A vector has NAME_x, NAME_y and NAME_z, as Blender and splashsurf name them.
void WritePly(vtkPolyData* surface, const ColorScale& scale, std::string& bytes)
{
  struct Property
  {
    PlyType Type;
    vtkDataArray* Array;
    int Component;
  };
  std::vector<Property> properties;
  std::set<std::string> names;
  std::ostringstream head;
  std::size_t size = 0;
  const auto add = [&](vtkDataArray* array, int component, std::string name)
  {
    std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c <= ' '; }, '_');
    while (!names.insert(name).second)
    {
      name += "_";
    }
    properties.push_back({ FindPlyType(array), array, component });
    head << "\nproperty " << properties.back().Type.Name << " " << name;
    size += properties.back().Type.Size;
  };
  const vtkIdType points = surface->GetNumberOfPoints();
  head << "ply\nformat binary_little_endian 1.0\ncomment by marching-correctors\nelement vertex "
       << points;
  vtkPointData* data = surface->GetPointData();
  vtkNew<vtkFloatArray> nowhere; // for a surface without points
  nowhere->SetNumberOfComponents(3);
  vtkDataArray* normals = data->GetNormals();
  vtkNew<vtkUnsignedCharArray> colors;
  vtkDataArray* colored = scale.ArrayOf(surface);
  std::vector<unsigned char> mapped = colored ? scale.Map(colored) : std::vector<unsigned char>();
  colors->SetNumberOfComponents(3);
  colors->SetArray(mapped.data(), static_cast<vtkIdType>(mapped.size()), 1);
  for (int c = 0; c < 3; ++c)
  {
    add(surface->GetPoints() ? surface->GetPoints()->GetData() : nowhere.Get(), c,
      std::string(1, "xyz"[c]));
  }
  for (int c = 0; normals && c < 3; ++c)
  {
    add(normals, c, std::string("n") + "xyz"[c]);
  }
  const char* const colorNames[] = { "red", "green", "blue" };
  for (int c = 0; colored && c < 3; ++c)
  {
    add(colors, c, colorNames[c]);
  }
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i); // .ply has no place for texts
    const int components = array && array != normals ? array->GetNumberOfComponents() : 0;
    for (int c = 0; c < components; ++c)
    {
      add(array, c,
        array->GetName() +
          (components == 1      ? ""
              : components <= 3 ? std::string("_") + "xyz"[c]
                                : "_" + std::to_string(c)));
    }
  }
  head << "\nelement face " << surface->GetNumberOfPolys()
       << "\nproperty list uchar uint vertex_indices\nend_header\n";
  bytes = head.str();
  char* next = Grow(bytes,
    size * static_cast<std::size_t>(points) +
      13 * static_cast<std::size_t>(surface->GetNumberOfPolys()));
  for (vtkIdType i = 0; i < points; ++i)
  {
    for (const Property& property : properties)
    {
      property.Type.PutValue(next, property.Array->GetComponent(i, property.Component));
    }
  }
  ForTriangles(surface,
    [&next](const vtkIdType* corners)
    {
      Put(next, static_cast<std::uint8_t>(3));
      for (int k = 0; k < 3; ++k)
      {
        Put(next, static_cast<std::uint32_t>(corners[k]));
      }
    });
}

/// Writes lines: a row for each point of each line, a column for each component. If a column's name
/// is taken, the column gets another name, because readers go by names.
void WriteCsv(vtkPolyData* surface, const ColorScale&, std::string& bytes)
{
  struct Column
  {
    vtkAbstractArray* Array;
    int Component;
  };
  std::vector<Column> columns;
  std::set<std::string> names = { "Line" };
  bytes = "Line";
  const auto add = [&columns, &names, &bytes](vtkAbstractArray* array, int c, std::string name)
  {
    while (!names.insert(name).second)
    {
      name += "_";
    }
    bytes += "," + TableField(name);
    columns.push_back({ array, c });
  };
  for (int c = 0; surface->GetPoints() && c < 3; ++c)
  {
    add(surface->GetPoints()->GetData(), c, std::string(1, "XYZ"[c]));
  }
  for (const bool isVector :
    { true, false }) // vectors first: their columns' names are made of the arrays' names
  {
    for (int i = 0; i < surface->GetPointData()->GetNumberOfArrays(); ++i)
    {
      vtkAbstractArray* array = surface->GetPointData()->GetAbstractArray(i);
      const int components = array->GetNumberOfComponents();
      for (int c = 0; (components > 1) == isVector && c < components; ++c)
      {
        add(array, c, array->GetName() + (isVector ? ":" + std::to_string(c) : ""));
      }
    }
  }
  bytes += "\n";
  vtkNew<vtkIdList> line;
  for (vtkIdType l = 0; l < surface->GetNumberOfLines(); ++l)
  {
    surface->GetLines()->GetCellAtId(l, line);
    for (const vtkIdType point : *line)
    {
      bytes += std::to_string(l);
      for (const Column& column : columns)
      {
        bytes += "," + TableField(column.Array, point, column.Component);
      }
      bytes += "\n";
    }
  }
}

/// Describes an array. VTK's XML name of its type tells the size.
void Describe(std::ostream& text, vtkAbstractArray* array, const std::string& name)
{
  const int type = array->GetDataType();
  const auto* numbers = vtkArrayDownCast<vtkDataArray>(array);
  const bool isSigned = numbers && vtkDataArray::GetDataTypeMin(type) < 0.0;
  const std::string kind = type == VTK_FLOAT || type == VTK_DOUBLE ? "Float"
    : isSigned                                                     ? "Int"
                                                                   : "UInt";
  text << "      <PDataArray type=\""
       << (type == VTK_STRING ? "String" : kind + std::to_string(8 * array->GetDataTypeSize()))
       << "\" Name=\"" << EscapedForXml(name) << "\" NumberOfComponents=\""
       << array->GetNumberOfComponents() << "\"/>\n";
}

/// Describes the arrays, and says which are the normals, and so on, as VTK's writers do in a file.
void DescribeAll(std::ostream& text, const char* element, vtkDataSetAttributes* arrays)
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
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    Describe(text, arrays->GetAbstractArray(i), arrays->GetArrayName(i));
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
  if (lines > 0 && triangles == 0 && !isTable)
  {
    FailToWrite(file,
      "this format cannot hold lines, which particles in a plane give; "
      "write a .vtp file, or a .csv file of their points");
  }
  if (isTable && lines == 0 && triangles > 0)
  {
    FailToWrite(file,
      "this format holds the points of lines, which particles in a plane "
      "give, but this is a surface; write a .vtp file");
  }
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
  std::ifstream stream(file, std::ios::binary);
  std::string head(256, '\0');
  stream.read(&head[0], static_cast<std::streamsize>(head.size()));
  return head.find(FilmMark) != std::string::npos;
}

bool HoldsArrays(const std::string& file)
{
  return !EndsWith(file, ".stl") && !EndsWith(file, ".obj");
}

std::string LostArrays(
  const std::string& file, vtkPolyData* surface, const std::vector<std::string>& more)
{
  const bool isPly = EndsWith(file, ".ply");
  std::string names;
  for (const std::string& name : more)
  {
    names += (names.empty() ? "" : ", ") + name;
  }
  vtkPointData* arrays = surface->GetPointData();
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    const std::string name = arrays->GetArrayName(i);
    const bool isHeld = isPly ? arrays->GetArray(i) != nullptr
                              : name == "Normals" || name == "IsoValue" || name == "Widening";
    names += isHeld ? "" : (names.empty() ? "" : ", ") + name;
  }
  if ((HoldsArrays(file) && !isPly) || names.empty())
  {
    return "";
  }
  return fs::path(file).extension().string() + " files hold no " + (isPly ? "text" : "arrays") +
    ", so these are left out: " + names + "; .vtp keeps all" +
    (isPly ? "" : ", .ply those of numbers") + ", --no-attributes makes none";
}

bool IsInPieces(const std::string& file)
{
  return fs::path(file).extension() == ".pvtp";
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
  DescribeAll(text, "PPointData", piece->GetPointData());
  DescribeAll(text, "PCellData", piece->GetCellData());
  text << "    <PPoints>\n";
  if (piece->GetPoints())
  {
    Describe(text, piece->GetPoints()->GetData(), "Points");
  }
  text << "    </PPoints>\n";
  for (int rank = 0; rank < count; ++rank)
  {
    text << "    <Piece Source=\""
         << EscapedForXml(fs::path(PieceName(file, rank)).filename().string()) << "\"/>\n";
  }
  text << "  </PPolyData>\n</VTKFile>\n";
  return text.str();
}

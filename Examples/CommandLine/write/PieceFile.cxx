// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "PieceFile.h"

#include "SafeText.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <filesystem>
#include <sstream>

namespace fs = std::filesystem;

namespace
{

/// VTK's XML names of types, which tell their size.
std::string TypeOf(vtkAbstractArray* array)
{
  switch (array->GetDataType())
  {
    case VTK_FLOAT:
      return "Float32";
    case VTK_DOUBLE:
      return "Float64";
    case VTK_STRING:
      return "String";
    default:
      break;
  }
  const auto* numbers = vtkArrayDownCast<vtkDataArray>(array);
  const bool isSigned = numbers && array->GetDataType() != VTK_UNSIGNED_CHAR &&
    array->GetDataType() != VTK_UNSIGNED_SHORT && array->GetDataType() != VTK_UNSIGNED_INT &&
    array->GetDataType() != VTK_UNSIGNED_LONG && array->GetDataType() != VTK_UNSIGNED_LONG_LONG;
  return std::string(isSigned ? "Int" : "UInt") + std::to_string(8 * array->GetDataTypeSize());
}

void Describe(std::ostream& text, vtkAbstractArray* array, const std::string& name)
{
  text << "      <PDataArray type=\"" << TypeOf(array) << "\" Name=\"" << EscapedForXml(name)
       << "\" NumberOfComponents=\"" << array->GetNumberOfComponents() << "\"/>\n";
}

/// The arrays and which are the normals, and so on, as VTK's writers say it of a single file.
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

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "RankOutput.h"

#include "SafeText.h"

#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <filesystem>
#include <sstream>
#include <vector>

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

/// Which arrays are the normals, and so on, as VTK's writers say it of a single file.
void DescribeRoles(std::ostream& text, vtkPointData* arrays)
{
  for (int role = 0; role < vtkDataSetAttributes::NUM_ATTRIBUTES; ++role)
  {
    vtkAbstractArray* array = arrays->GetAbstractAttribute(role);
    if (array && array->GetName())
    {
      text << ' ' << vtkDataSetAttributes::GetAttributeTypeAsString(role) << "=\""
           << EscapedForXml(array->GetName()) << '"';
    }
  }
}

void Append(vtkPolyData* part, vtkPolyData* whole, vtkCellArray* triangles)
{
  vtkDataArray* numbers = part->GetPointData()->GetGlobalIds();
  vtkPointData *from = part->GetPointData(), *to = whole->GetPointData();
  const vtkIdType count = part->GetNumberOfPoints();
  if (count == 0)
  {
    return; // VTK sends no arrays then
  }
  vtkNew<vtkIdList> own, places;
  own->SetNumberOfIds(count);
  places->SetNumberOfIds(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    own->SetId(i, i);
    places->SetId(i, static_cast<vtkIdType>(numbers->GetComponent(i, 0)));
  }
  whole->GetPoints()->GetData()->InsertTuples(places, own, part->GetPoints()->GetData());
  for (int a = 0; a < to->GetNumberOfArrays(); ++a)
  {
    vtkAbstractArray* array = to->GetAbstractArray(a);
    array->InsertTuples(places, own, from->GetAbstractArray(array->GetName()));
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType i = 0; i < part->GetNumberOfPolys(); ++i)
  {
    part->GetPolys()->GetCellAtId(i, corners);
    triangles->InsertNextCell(3);
    for (vtkIdType c = 0; c < corners->GetNumberOfIds(); ++c)
    {
      triangles->InsertCellPoint(places->GetId(corners->GetId(c)));
    }
  }
}

vtkSmartPointer<vtkPolyData> Merge(const std::vector<vtkSmartPointer<vtkPolyData>>& parts)
{
  auto whole = vtkSmartPointer<vtkPolyData>::New();
  vtkPolyData* first = parts.front();
  whole->GetFieldData()->ShallowCopy(first->GetFieldData());
  vtkDataArray* total = first->GetFieldData()->GetArray("Points");
  if (!total || !first->GetPoints())
  {
    return whole;
  }
  const auto count = static_cast<vtkIdType>(total->GetComponent(0, 0));
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> triangles;
  points->SetDataType(first->GetPoints()->GetDataType());
  points->SetNumberOfPoints(count);
  whole->SetPoints(points);
  vtkPointData* arrays = whole->GetPointData();
  arrays->CopyAllOn();
  arrays->CopyGlobalIdsOff();
  arrays->CopyAllocate(first->GetPointData(), count);
  arrays->SetNumberOfTuples(count);
  for (const auto& part : parts)
  {
    Append(part, whole, triangles);
  }
  whole->SetPolys(triangles);
  return whole;
}

}

//------------------------------------------------------------------------------
bool IsInPieces(const std::string& file)
{
  return fs::path(file).extension() == ".pvtp";
}

//------------------------------------------------------------------------------
std::string PieceName(const std::string& file, int rank)
{
  const fs::path path(file);
  return (path.parent_path() / (path.stem().string() + "_" + std::to_string(rank) + ".vtp"))
    .string();
}

//------------------------------------------------------------------------------
std::string ListPieces(const std::string& file, int count, vtkPolyData* piece)
{
  std::ostringstream text;
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"1.0\">\n"
       << "  <PPolyData GhostLevel=\"0\">\n    <PPointData";
  vtkPointData* arrays = piece->GetPointData();
  DescribeRoles(text, arrays);
  text << ">\n";
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    Describe(text, arrays->GetAbstractArray(i), arrays->GetArrayName(i));
  }
  text << "    </PPointData>\n    <PPoints>\n";
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

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> MergeOnFirst(vtkMultiProcessController* controller, vtkPolyData* part)
{
  constexpr int tag = 1717;
  if (controller->GetLocalProcessId() != 0)
  {
    controller->Send(part, 0, tag);
    return nullptr;
  }
  std::vector<vtkSmartPointer<vtkPolyData>> parts = { part };
  for (int rank = 1; rank < controller->GetNumberOfProcesses(); ++rank)
  {
    parts.emplace_back(vtkSmartPointer<vtkPolyData>::New());
    controller->Receive(parts.back(), rank, tag);
  }
  return Merge(parts);
}

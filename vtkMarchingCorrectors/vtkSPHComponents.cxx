// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHComponents.h"

#include "mcor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHParticles.h"
#include "vtkSPHPieces.h"
#include "vtkTable.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace
{
constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();
const char* const IdName = "ComponentId";

/** The array of this name, or that of the most usual one for the quantity; nullptr: there is none. */
vtkDataArray* FindArray(
  vtkPointSet* particles, const std::string& name, mcor_quantity quantity, int components)
{
  return name.empty() ? vtkSPHDetect(particles, quantity, components)
                      : particles->GetPointData()->GetArray(name.c_str());
}

/** The tuples with these numbers, in their order. */
void CopyTuples(vtkDataSetAttributes* from, vtkIdList* ids, vtkDataSetAttributes* to)
{
  vtkNew<vtkIdList> places;
  places->SetNumberOfIds(ids->GetNumberOfIds());
  std::iota(places->GetPointer(0), places->GetPointer(0) + ids->GetNumberOfIds(), vtkIdType(0));
  to->CopyAllOn(); // normals and ids, too
  to->CopyAllocate(from, ids->GetNumberOfIds());
  to->CopyData(from, ids, places);
}

/** Points and triangles of the pieces that stay, with all their arrays, in their order. */
void Keep(vtkPolyData* mesh, const vtkSPHPieces& pieces, const std::vector<vtkIdType>& number,
  vtkPolyData* output)
{
  vtkNew<vtkIdList> points, cells;
  std::vector<vtkIdType> place(static_cast<size_t>(mesh->GetNumberOfPoints()), -1);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    const vtkIdType piece = pieces.PieceOfPoint[static_cast<size_t>(i)];
    if (piece >= 0 && number[static_cast<size_t>(piece)] >= 0)
    {
      place[static_cast<size_t>(i)] = points->InsertNextId(i);
    }
  }
  vtkNew<vtkCellArray> kept;
  vtkNew<vtkIdList> corners;
  for (vtkIdType t = 0; t < mesh->GetNumberOfPolys(); ++t)
  {
    if (number[static_cast<size_t>(pieces.PieceOfTriangle[static_cast<size_t>(t)])] >= 0)
    {
      mesh->GetPolys()->GetCellAtId(t, corners);
      for (vtkIdType i = 0; i < 3; ++i)
      {
        corners->SetId(i, place[static_cast<size_t>(corners->GetId(i))]);
      }
      kept->InsertNextCell(corners);
      cells->InsertNextId(t);
    }
  }
  vtkNew<vtkPoints> where;
  where->SetDataType(mesh->GetPoints()->GetDataType());
  where->SetNumberOfPoints(points->GetNumberOfIds());
  mesh->GetPoints()->GetPoints(points, where);
  output->SetPoints(where);
  output->SetPolys(kept);
  CopyTuples(mesh->GetPointData(), points, output->GetPointData());
  CopyTuples(mesh->GetCellData(), cells, output->GetCellData());
  output->GetFieldData()->PassData(mesh->GetFieldData());
}

/** Numbers of pieces that stay, of those that have one. */
void AddIds(vtkDataSetAttributes* data, const std::vector<vtkIdType>& of,
  const std::vector<vtkIdType>& number)
{
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName(IdName);
  for (const vtkIdType piece : of)
  {
    if (piece >= 0 && number[static_cast<size_t>(piece)] >= 0)
    {
      ids->InsertNextValue(number[static_cast<size_t>(piece)]);
    }
  }
  data->AddArray(ids);
}
}

/** What a piece encloses. */
struct vtkSPHComponents::Content
{
  double Particles = 0.0, Mass = 0.0, Momentum[3] = { 0.0, 0.0, 0.0 };
  bool HasMass = false, HasVelocity = false;
};

//------------------------------------------------------------------------------
vtkStandardNewMacro(vtkSPHComponents);

//------------------------------------------------------------------------------
vtkSPHComponents::vtkSPHComponents()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkSPHComponents::~vtkSPHComponents() = default;

//------------------------------------------------------------------------------
vtkTable* vtkSPHComponents::GetTable()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(1));
}

//------------------------------------------------------------------------------
int vtkSPHComponents::FillInputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), port == 0 ? "vtkPolyData" : "vtkPointSet");
  if (port == 1)
  {
    info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
    info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  }
  return 1;
}

//------------------------------------------------------------------------------
int vtkSPHComponents::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkTable");
  return 1;
}

//------------------------------------------------------------------------------
std::vector<vtkSPHComponents::Content> vtkSPHComponents::Count(
  const vtkSPHPieces& pieces, vtkPointSet* particles) const
{
  std::vector<Content> contents(pieces.Pieces.size());
  vtkDataArray* masses =
    this->Mass > 0.0 ? nullptr : FindArray(particles, this->MassArrayName, MCOR_MASS, 1);
  vtkDataArray* velocities = FindArray(particles, this->VelocityArrayName, MCOR_VELOCITY, 3);
  vtkSPHParticlesChoice fluid;
  fluid.FluidValue = this->FluidValue;
  if (this->FluidArrayName != "(automatic)") // of a panel's list
  {
    fluid.FluidArrayName = this->FluidArrayName;
  }
  if (this->DetectFluid)
  {
    vtkSPHParticles::FindFluid(fluid, particles);
  }
  vtkDataArray* types = particles->GetPointData()->GetArray(fluid.FluidArrayName.c_str());
  std::vector<std::array<double, 3>> places;
  std::vector<vtkIdType> numbers;
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    if (!types || types->GetComponent(i, 0) == fluid.FluidValue)
    {
      places.emplace_back();
      particles->GetPoint(i, places.back().data());
      numbers.push_back(i);
    }
  }
  const std::vector<vtkIdType> around = pieces.FindEnclosing(places);
  for (size_t i = 0; i < numbers.size(); ++i)
  {
    if (around[i] < 0)
    {
      continue;
    }
    Content& content = contents[static_cast<size_t>(around[i])];
    const double mass = masses ? masses->GetComponent(numbers[i], 0) : this->Mass;
    content.Particles += 1.0;
    content.Mass += mass;
    for (int a = 0; a < 3 && velocities; ++a)
    {
      content.Momentum[a] += (masses ? mass : 1.0) * velocities->GetComponent(numbers[i], a);
    }
  }
  for (Content& content : contents)
  {
    content.HasMass = masses || this->Mass > 0.0;
    content.HasVelocity = velocities != nullptr && content.Particles > 0.0;
    const double whole = masses ? content.Mass : content.Particles;
    for (double& momentum : content.Momentum)
    {
      momentum /= whole > 0.0 ? whole : 1.0; // a velocity now
    }
  }
  return contents;
}

//------------------------------------------------------------------------------
// New numbers of the pieces; -1: left out. Cavities go with what is around them.
std::vector<vtkIdType> vtkSPHComponents::Choose(
  const vtkSPHPieces& pieces, const std::vector<Content>& contents) const
{
  const size_t count = pieces.Pieces.size();
  std::vector<char> stays(count, 1);
  for (size_t i = 0; i < count; ++i)
  {
    const vtkSPHPiece& piece = pieces.Pieces[i];
    const bool few = !contents.empty() && piece.Volume > 0.0 &&
      contents[i].Particles < static_cast<double>(this->LeastParticles);
    stays[i] = !piece.HasVolume() || (std::abs(piece.Volume) >= this->LeastVolume && !few);
  }
  std::vector<vtkIdType> number(count, -1);
  vtkIdType next = 0;
  for (size_t i = 0; i < count; ++i)
  {
    const vtkIdType parent = pieces.Pieces[i].Parent;
    if (stays[i] && (parent < 0 || stays[static_cast<size_t>(parent)]))
    {
      number[i] = next++;
    }
  }
  return number;
}

//------------------------------------------------------------------------------
int vtkSPHComponents::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* mesh = vtkPolyData::GetData(inputVector[0]);
  vtkSmartPointer<vtkPointSet> particles = vtkPointSet::GetData(inputVector[1]);
  if (auto* blocks = vtkDataObjectTree::GetData(inputVector[1]))
  {
    particles = vtkSPHJoinBlocks(blocks);
  }
  vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
  vtkTable* table = vtkTable::GetData(outputVector, 1);
  if (mesh->GetNumberOfCells() != mesh->GetNumberOfPolys() ||
    (mesh->GetNumberOfPolys() > 0 && mesh->GetPolys()->IsHomogeneous() != 3))
  {
    vtkErrorMacro(<< "The surface has cells that are no triangles. Put vtkTriangleFilter, with "
                     "PassLines and PassVerts off, before this filter.");
    return 0;
  }
  const vtkSPHPieces pieces(mesh, this->PeriodicBounds);
  const std::vector<Content> contents =
    particles ? this->Count(pieces, particles) : std::vector<Content>();
  const std::vector<vtkIdType> number = this->Choose(pieces, contents);
  if (mesh->GetPoints())
  {
    Keep(mesh, pieces, number, output);
  }
  AddIds(output->GetPointData(), pieces.PieceOfPoint, number);
  AddIds(output->GetCellData(), pieces.PieceOfTriangle, number);
  const char* const names[] = { "component", "parent", "closed", "area", "volume", "x", "y", "z",
    "xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "diameter", "particles", "mass", "vx", "vy",
    "vz" };
  constexpr size_t columnCount = sizeof names / sizeof *names;
  vtkDoubleArray* columns[columnCount];
  for (size_t c = 0; c < columnCount; ++c)
  {
    vtkNew<vtkDoubleArray> column;
    column->SetName(names[c]);
    table->AddColumn(column);
    columns[c] = column;
  }
  for (size_t i = 0; i < pieces.Pieces.size(); ++i)
  {
    if (number[i] < 0)
    {
      continue;
    }
    const vtkSPHPiece& piece = pieces.Pieces[i];
    const bool has = piece.HasVolume(), filled = has && piece.Volume > 0.0 && !contents.empty();
    const Content content = filled ? contents[i] : Content();
    const double* b = piece.Bounds;
    const double* v = content.Momentum;
    const bool moves = content.HasVelocity;
    const double row[columnCount] = { static_cast<double>(number[i]),
      piece.Parent >= 0 ? static_cast<double>(number[static_cast<size_t>(piece.Parent)]) : NoNumber,
      piece.Closed ? 1.0 : 0.0, piece.Area, has ? piece.Volume : NoNumber, piece.Centre[0],
      piece.Centre[1], piece.Centre[2], b[0], b[1], b[2], b[3], b[4], b[5],
      has ? std::cbrt(6.0 * std::abs(piece.Volume) / 3.14159265358979323846) : NoNumber,
      filled ? content.Particles : NoNumber, content.HasMass ? content.Mass : NoNumber,
      moves ? v[0] : NoNumber, moves ? v[1] : NoNumber, moves ? v[2] : NoNumber };
    for (size_t c = 0; c < columnCount; ++c)
    {
      columns[c]->InsertNextValue(row[c]);
    }
  }
  return 1;
}

//------------------------------------------------------------------------------
void vtkSPHComponents::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Periodic Bounds:";
  for (const double side : this->PeriodicBounds)
  {
    os << " " << side;
  }
  os << "\n";
  os << indent << "Least Volume: " << this->LeastVolume << "\n";
  os << indent << "Least Particles: " << this->LeastParticles << "\n";
  os << indent << "Mass Array Name: " << this->MassArrayName << "\n";
  os << indent << "Mass: " << this->Mass << "\n";
  os << indent << "Velocity Array Name: " << this->VelocityArrayName << "\n";
  os << indent << "Fluid Array Name: " << this->FluidArrayName << "\n";
  os << indent << "Fluid Value: " << this->FluidValue << "\n";
  os << indent << "Detect Fluid: " << this->DetectFluid << "\n";
}

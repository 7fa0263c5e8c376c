// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHComponents.h"

#include "mcor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMath.h"
#include "vtkMultiProcessController.h"
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
#include "vtkSPHPrint.h"
#include "vtkTable.h"
#if MCOR_HAS_RANKS
#include "vtkSPHRanks.h"
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
constexpr double NoNumber = std::numeric_limits<double>::quiet_NaN();
const char* const IdName = "ComponentId";

/**
 * Adds an array with the id of the piece of each point or triangle that stays. The ids become
 * active scalars if there are several pieces: most users want to tell pieces apart by colour.
 * Returns the ids.
 */
vtkSmartPointer<vtkIdTypeArray> AddIds(
  vtkDataSetAttributes* data, const std::vector<vtkIdType>& numbers, size_t pieces)
{
  auto ids = vtkSmartPointer<vtkIdTypeArray>::New();
  ids->SetName(IdName);
  for (const vtkIdType number : numbers)
  {
    if (number >= 0)
    {
      ids->InsertNextValue(number);
    }
  }
  data->AddArray(ids);
  if (pieces > 1)
  {
    data->SetActiveScalars(IdName);
  }
  return ids;
}

/**
 * A sum whose bits do not depend on the order of its numbers. Expect() must get all numbers before
 * Add() gets the first one: Add() rounds to a unit in which the sum is exact.
 */
class OrderlessSum
{
public:
  void Expect(double number)
  {
    this->Greatest = std::max(this->Greatest, std::abs(number));
    this->Count += 1.0;
  }

  void Add(double number)
  {
    const double bound = this->Greatest * this->Count;
    const double unit = bound > 0.0 ? std::ldexp(1.0, std::ilogb(bound) + 1 - 53) : 1.0;
    this->Sum += unit > 0.0 ? std::nearbyint(number / unit) * unit : number;
  }

  double Sum = 0.0;

private:
  double Greatest = 0.0, Count = 0.0;
};
}

/** The particles that a piece encloses. */
struct vtkSPHComponents::Content
{
  double Particles = 0.0;
  OrderlessSum Mass, Momentum[3]; ///< without masses, each particle counts as 1
  bool HasMass = false, HasVelocity = false;

  double Velocity(int axis) const
  {
    return this->HasVelocity ? this->Momentum[axis].Sum / this->Mass.Sum : NoNumber;
  }
};

vtkStandardNewMacro(vtkSPHComponents);

vtkSPHComponents::vtkSPHComponents()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
  this->SetController(vtkMultiProcessController::GetGlobalController());
}

vtkSPHComponents::~vtkSPHComponents()
{
  this->SetController(nullptr);
}

vtkCxxSetObjectMacro(vtkSPHComponents, Controller, vtkMultiProcessController);

vtkTable* vtkSPHComponents::GetTable()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(1));
}

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

int vtkSPHComponents::FillOutputPortInformation(int port, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkPolyData" : "vtkTable");
  return 1;
}

std::vector<vtkSPHComponents::Content> vtkSPHComponents::Count(
  const vtkSPHPieces& pieces, vtkPointSet* particles) const
{
  std::vector<Content> contents(pieces.Pieces.size());
  vtkDataArray* masses =
    this->Mass > 0.0 ? nullptr : vtkSPHDetect(particles, MCOR_MASS, 1, this->MassArrayName);
  vtkDataArray* velocities = vtkSPHDetect(particles, MCOR_VELOCITY, 3, this->VelocityArrayName);
  vtkSPHParticlesChoice choice;
  choice.FluidValue = this->FluidValue;
  choice.FluidArrayName = vtkSPHRealName(this->FluidArrayName);
  choice.DetectFluid = this->DetectFluid;
  vtkSPHChoose(choice, particles, nullptr, nullptr);
  vtkDataArray* types = particles->GetPointData()->GetArray(choice.FluidArrayName.c_str());
  std::vector<vtkIdType> fluid;
  std::vector<std::array<double, 3>> places;
  for (vtkIdType i = 0; i < particles->GetNumberOfPoints(); ++i)
  {
    if (!types || types->GetComponent(i, 0) == choice.FluidValue)
    {
      fluid.push_back(i);
      places.emplace_back();
      particles->GetPoint(i, places.back().data());
    }
  }
  using Step = void (OrderlessSum::*)(double);
  for (const double isoValue : pieces.IsoValues)
  {
    const std::vector<vtkIdType> around = pieces.FindEnclosing(places, isoValue);
    for (const Step step : { &OrderlessSum::Expect, &OrderlessSum::Add })
    {
      for (size_t i = 0; i < fluid.size(); ++i)
      {
        if (around[i] < 0)
        {
          continue;
        }
        Content& content = contents[around[i]];
        const double one = this->Mass > 0.0 ? this->Mass : 1.0;
        const double mass = masses ? masses->GetComponent(fluid[i], 0) : one;
        content.Particles += step == &OrderlessSum::Add ? 1.0 : 0.0;
        (content.Mass.*step)(mass);
        for (int a = 0; a < 3 && velocities; ++a)
        {
          (content.Momentum[a].*step)(mass * velocities->GetComponent(fluid[i], a));
        }
      }
    }
  }
  for (Content& content : contents)
  {
    content.HasMass = masses || this->Mass > 0.0;
    content.HasVelocity = velocities != nullptr && content.Mass.Sum > 0.0;
  }
  return contents;
}

// Returns new numbers of the pieces; -1: left out. A cavity is left out with the piece around it.
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
    if (stays[i] && (parent < 0 || stays[parent]))
    {
      number[i] = next++;
    }
  }
  return number;
}

vtkSPHComponents::Numbers vtkSPHComponents::Split(
  vtkPolyData* mesh, vtkPointSet* particles, vtkTable* table) const
{
  vtkDataArray* const isoValues = vtkSPHFindIsoValues(mesh);
  const vtkSPHPieces pieces(mesh, isoValues, this->PeriodicBounds);
  const std::vector<Content> contents =
    particles ? this->Count(pieces, particles) : std::vector<Content>();
  const std::vector<vtkIdType> number = this->Choose(pieces, contents);
  const char* const names[] = { "component", "iso", "parent", "closed", "area", "volume", "x", "y",
    "z", "xmin", "xmax", "ymin", "ymax", "zmin", "zmax", "diameter", "particles", "mass", "vx",
    "vy", "vz" };
  constexpr size_t columnCount = sizeof names / sizeof *names;
  constexpr size_t withoutParticles = 16; // number of columns if there are no particles
  const size_t used = contents.empty() && !pieces.Pieces.empty() ? withoutParticles : columnCount;
  vtkDoubleArray* columns[columnCount];
  for (size_t c = 0; c < used; ++c)
  {
    vtkNew<vtkDoubleArray> column;
    column->SetName(names[c]);
    table->AddColumn(column);
    columns[c] = column;
  }
  std::vector<double> volumes;
  vtkDataArray* listed = mesh->GetFieldData()->GetArray("IsoValues");
  for (size_t i = 0; i < pieces.Pieces.size(); ++i)
  {
    if (number[i] < 0)
    {
      continue;
    }
    const vtkSPHPiece& piece = pieces.Pieces[i];
    double iso = NoNumber; // the points may have the value rounded to float
    for (vtkIdType v = 0; isoValues && v < listed->GetNumberOfValues(); ++v)
    {
      const double value = listed->GetComponent(v, 0);
      iso = std::abs(value - piece.Iso) >= std::abs(iso - piece.Iso) ? iso : value;
    }
    const bool has = piece.HasVolume(), filled = has && piece.Volume > 0.0 && !contents.empty();
    const Content content = filled ? contents[i] : Content();
    const double* b = piece.Bounds;
    const double row[columnCount] = { static_cast<double>(number[i]), iso,
      piece.Parent >= 0 ? static_cast<double>(number[piece.Parent]) : -1.0,
      piece.Closed ? 1.0 : 0.0, piece.Area, has ? piece.Volume : NoNumber, piece.Centre[0],
      piece.Centre[1], piece.Centre[2], b[0], b[1], b[2], b[3], b[4], b[5],
      has ? std::cbrt(6.0 * std::abs(piece.Volume) / vtkMath::Pi()) : NoNumber,
      filled ? content.Particles : NoNumber, content.HasMass ? content.Mass.Sum : NoNumber,
      content.Velocity(0), content.Velocity(1), content.Velocity(2) };
    for (size_t c = 0; c < used; ++c)
    {
      columns[c]->InsertNextValue(row[c]);
    }
    volumes.push_back(has ? piece.Volume : NoNumber);
  }
  Numbers numbers = { pieces.PieceOfPoint, pieces.PieceOfTriangle, volumes };
  for (std::vector<vtkIdType>* of : { &numbers.OfPoint, &numbers.OfTriangle })
  {
    for (vtkIdType& piece : *of)
    {
      piece = piece >= 0 ? number[piece] : -1;
    }
  }
  return numbers;
}

// Copies points and triangles of the pieces that stay, with all their arrays, in their order. Adds ComponentId and ComponentVolume.
void vtkSPHComponents::Keep(vtkPolyData* mesh, const Numbers& numbers, vtkPolyData* output)
{
  vtkNew<vtkIdList> points, cells;
  std::vector<vtkIdType> place(numbers.OfPoint.size(), -1);
  for (size_t i = 0; i < place.size(); ++i)
  {
    if (numbers.OfPoint[i] >= 0)
    {
      place[i] = points->InsertNextId(static_cast<vtkIdType>(i));
    }
  }
  vtkNew<vtkCellArray> kept;
  vtkNew<vtkIdList> corners;
  for (size_t t = 0; t < numbers.OfTriangle.size(); ++t)
  {
    if (numbers.OfTriangle[t] >= 0)
    {
      mesh->GetPolys()->GetCellAtId(static_cast<vtkIdType>(t), corners);
      for (vtkIdType i = 0; i < 3; ++i)
      {
        corners->SetId(i, place[corners->GetId(i)]);
      }
      kept->InsertNextCell(corners);
      cells->InsertNextId(static_cast<vtkIdType>(t));
    }
  }
  if (mesh->GetPoints())
  {
    output->SetPoints(vtkSPHTakePoints(mesh->GetPoints(), points));
    output->SetPolys(kept);
    vtkSPHTakeTuples(mesh->GetPointData(), points, output->GetPointData());
    vtkSPHTakeTuples(mesh->GetCellData(), cells, output->GetCellData());
    output->GetFieldData()->PassData(mesh->GetFieldData());
  }
  AddIds(output->GetPointData(), numbers.OfPoint, numbers.Volumes.size());
  const auto ids = AddIds(output->GetCellData(), numbers.OfTriangle, numbers.Volumes.size());
  vtkNew<vtkDoubleArray> volumes;
  volumes->SetName("ComponentVolume");
  volumes->SetNumberOfValues(ids->GetNumberOfValues());
  std::transform(ids->Begin(), ids->End(), volumes->Begin(),
    [&numbers](vtkIdType id) { return numbers.Volumes[id]; });
  output->GetCellData()->AddArray(volumes);
}

std::string vtkSPHComponents::FindProblem(vtkPolyData* mesh)
{
  if (mesh->GetNumberOfLines() > 0 && mesh->GetNumberOfPolys() == 0)
  {
    return "The input has lines, as from particles in a plane, and no triangles, so it has no "
           "pieces. Turn Filled on to get triangles, and put vtkTriangleFilter with PassLines off "
           "before this filter.";
  }
  if (mesh->GetNumberOfPoints() > 0 && mesh->GetNumberOfPolys() + mesh->GetNumberOfStrips() == 0)
  {
    return "Choose a surface, such as that of SPH Contour, as Surface: the input has no triangles.";
  }
  const bool hasOthers = mesh->GetNumberOfCells() != mesh->GetNumberOfPolys() ||
    (mesh->GetNumberOfPolys() > 0 && mesh->GetPolys()->IsHomogeneous() != 3);
  return hasOthers ? "The surface has cells that are not triangles. Put vtkTriangleFilter, with "
                     "PassLines and PassVerts off, before this filter."
                   : "";
}

int vtkSPHComponents::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* mesh = vtkPolyData::GetData(inputVector[0]);
  vtkDataObject* data = vtkDataObject::GetData(inputVector[1]);
  std::int64_t haveVertices = vtkSPHHaveVertices(data) ? 1 : 0;
#if MCOR_HAS_RANKS
  const bool isShared = this->Controller && this->Controller->IsA("vtkMPIController") &&
    this->Controller->GetNumberOfProcesses() > 1;
  if (isShared)
  {
    vtkSPHRanks(this->Controller).Reduce(vtkSPHRanks::GREATEST, &haveVertices, 1);
  }
#endif
  const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(data, haveVertices > 0);
  vtkSmartPointer<vtkPointSet> particles = vtkPointSet::SafeDownCast(taken);
  if (auto* blocks = vtkDataObjectTree::SafeDownCast(taken))
  {
    particles = vtkSPHJoinBlocks(blocks, this->FluidArrayName);
  }
  vtkPolyData* output = vtkPolyData::GetData(outputVector, 0);
  vtkTable* table = vtkTable::GetData(outputVector, 1);
  std::string problem;
#if MCOR_HAS_RANKS
  if (isShared)
  {
    problem = this->SplitDistributed(mesh, particles, output, table);
  }
  else
#endif
  {
    auto* other = vtkPolyData::SafeDownCast(particles);
    if (other && other->GetNumberOfPolys() > 0 && mesh->GetNumberOfPolys() == 0)
    {
      particles = std::exchange(mesh, other); // the inputs were exchanged
    }
    problem = FindProblem(mesh);
    if (problem.empty())
    {
      Keep(mesh, this->Split(mesh, particles, table), output);
    }
  }
  if (!problem.empty())
  {
    vtkErrorMacro(<< problem);
  }
  return 1; // also after an error, see vtkSPHAlgorithm::RequestData
}

void vtkSPHComponents::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(PeriodicBounds, LeastVolume, LeastParticles, MassArrayName, Mass,
    VelocityArrayName, FluidArrayName, FluidValue, DetectFluid, Controller);
}
VTK_ABI_NAMESPACE_END

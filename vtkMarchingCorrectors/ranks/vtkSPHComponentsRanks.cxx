// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Finds the pieces of a surface that ranks share. The first rank joins the parts, in the order of
// the global numbers of points and triangles, to the surface that one process would make. Each rank
// asks the first rank for the pieces of its own points and triangles.
#include "vtkSPHComponents.h"

#include "mcor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksParticles.h"
#include "vtkTable.h"

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Ids = std::vector<vtkIdType>;

/**
 * Joins the parts on the first rank, in the order of GlobalPointIds and GlobalCellIds, with all
 * arrays except these two. Returns null on other ranks. Collective.
 */
vtkSmartPointer<vtkPolyData> GatherSurface(vtkMultiProcessController* controller, vtkPolyData* part)
{
  vtkSPHRanks ranks(controller);
  vtkNew<vtkPolyData> own;
  own->ShallowCopy(part);
  const auto takeNumbers = [](vtkDataSetAttributes* data)
  {
    auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
    if (vtkDataArray* ids = data->GetGlobalIds()) // which may be of any type
    {
      numbers->DeepCopy(ids);
      data->RemoveArray(ids->GetName());
    }
    return numbers;
  };
  const auto points = takeNumbers(own->GetPointData()), triangles = takeNumbers(own->GetCellData());
  vtkNew<vtkIdTypeArray> corners;
  vtkNew<vtkIdList> triangle;
  corners->SetNumberOfComponents(3);
  for (vtkIdType t = 0; t < part->GetNumberOfPolys(); ++t)
  {
    part->GetPolys()->GetCellAtId(t, triangle);
    for (const vtkIdType corner : *triangle)
    {
      corners->InsertNextValue(points->GetValue(corner));
    }
  }
  vtkSPHMatchEmpty(controller, own);
  vtkSmartPointer<vtkPolyData> whole =
    vtkSPHMakePoints(vtkSPHGatherTuples(ranks, vtkSPHListArrays(own), points), own);
  vtkSPHRanksArrays arrays = vtkSPHListArrays(own->GetCellData());
  arrays.emplace_back(corners);
  arrays = vtkSPHGatherTuples(ranks, arrays, triangles);
  auto* wholeCorners = vtkDataArray::SafeDownCast(arrays.back());
  wholeCorners->SetNumberOfComponents(1); // all corners, in order
  vtkNew<vtkCellArray> cells;
  cells->SetData(3, wholeCorners);
  whole->SetPolys(cells);
  arrays.pop_back();
  whole->GetCellData()->ShallowCopy(own->GetCellData());
  for (const auto& array : arrays)
  {
    whole->GetCellData()->AddArray(array); // replaces the array of the same name
  }
  whole->GetFieldData()->ShallowCopy(part->GetFieldData());
  return ranks.GetRank() == 0 ? whole : nullptr;
}

/**
 * Returns the piece of each point, or of each triangle, of this rank; -1: the piece is left out.
 * pieces: on the first rank, the pieces of all ranks' points or triangles. The other ranks ask the
 * first rank, so that only one rank must hold all pieces. Also replaces the global ids in
 * `data`: gives new numbers to points or triangles whose pieces stay, and -1 to others. Collective.
 */
Ids Return(vtkSPHRanks& ranks, vtkDataSetAttributes* data, const Ids& pieces)
{
  vtkDataArray* given = data->GetGlobalIds();
  vtkSPHRanksLists wanted(static_cast<std::size_t>(ranks.GetCount())); // asks the first rank only
  for (vtkIdType i = 0; given && i < given->GetNumberOfTuples(); ++i)
  {
    wanted[0].push_back(static_cast<vtkIdType>(given->GetComponent(i, 0)));
  }
  vtkNew<vtkIdTypeArray> all, numbers;
  vtkIdType next = 0;
  for (const vtkIdType piece : pieces)
  {
    all->InsertNextValue(piece);
    numbers->InsertNextValue(piece >= 0 ? next++ : -1);
  }
  const vtkSPHRanksArrays came =
    vtkSPHSendTuples(ranks, { all.Get(), numbers.Get() }, ranks.Exchange(std::move(wanted)));
  if (given)
  {
    came[1]->SetName(given->GetName());
    data->SetGlobalIds(vtkDataArray::SafeDownCast(came[1]));
  }
  auto* own = vtkIdTypeArray::SafeDownCast(came[0]);
  return Ids(own->Begin(), own->End());
}
}

vtkSmartPointer<vtkPolyData> vtkSPHMergeSurface(
  vtkMultiProcessController* controller, vtkPolyData* part)
{
  vtkSPHRanks ranks(controller);
  std::int64_t others = ranks.GetRank() > 0 ? part->GetNumberOfPoints() : 0;
  ranks.Reduce(vtkSPHRanks::SUM, &others, 1);
  if (others > 0)
  {
    return GatherSurface(controller, part);
  }
  auto whole = vtkSmartPointer<vtkPolyData>::New(); // for lines, the first rank has everything
  whole->ShallowCopy(part);
  whole->GetPointData()->RemoveArray("GlobalPointIds");
  whole->GetCellData()->RemoveArray("GlobalCellIds");
  return ranks.GetRank() == 0 ? whole : nullptr;
}

// The first rank has all pieces and writes the table, so it needs all particles.
vtkSmartPointer<vtkPointSet> vtkSPHComponents::GatherParticles(
  vtkSPHRanks& ranks, vtkPointSet* particles) const
{
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles, {});
  vtkNew<vtkPolyData> fluid;
  fluid->SetPoints(own->GetPoints());
  for (vtkDataArray* array : { vtkSPHDetect(own, MCOR_MASS, 1, this->MassArrayName),
         vtkSPHDetect(own, MCOR_VELOCITY, 3, this->VelocityArrayName) })
  {
    if (array)
    {
      fluid->GetPointData()->AddArray(array);
    }
  }
  // The fluid is found among all particles, so each array that may mark the fluid is needed.
  for (const auto& array : vtkSPHListArrays(own->GetPointData()))
  {
    const char* name = array->GetName();
    if (this->FluidArrayName == name || mcor_name_priority(MCOR_PARTICLE_TYPE, name) >= 0)
    {
      fluid->GetPointData()->AddArray(array);
    }
  }
  return vtkSPHMakePoints(vtkSPHGatherTuples(ranks, vtkSPHListArrays(fluid), nullptr), fluid).Get();
}

// Returns the error, the same on all ranks. No rank may return while another rank waits for it.
std::string vtkSPHComponents::SplitDistributed(
  vtkPolyData* mesh, vtkPointSet* particles, vtkPolyData* output, vtkTable* table) const
{
  vtkSPHRanks ranks(this->Controller);
  std::string problem = FindProblem(mesh);
  const vtkIdType pointCount = mesh->GetNumberOfPoints(), triangleCount = mesh->GetNumberOfPolys();
  if ((pointCount > 0 && !mesh->GetPointData()->GetGlobalIds()) ||
    (triangleCount > 0 && !mesh->GetCellData()->GetGlobalIds()))
  {
    problem = "The parts of the surface have no GlobalPointIds and GlobalCellIds, which are needed "
              "to join pieces across processes. Use the surface as vtkMarchingCorrectors makes it "
              "with several processes.";
  }
  if (!ranks.Agree(problem))
  {
    return problem;
  }
  std::int64_t given = particles ? 1 : 0;
  ranks.Reduce(vtkSPHRanks::GREATEST, &given, 1);
  const vtkSmartPointer<vtkPointSet> all =
    given > 0 ? this->GatherParticles(ranks, particles) : nullptr;
  vtkNew<vtkPolyData> bare;
  bare->SetPoints(mesh->GetPoints());
  bare->SetPolys(mesh->GetPolys());
  bare->GetPointData()->SetGlobalIds(mesh->GetPointData()->GetGlobalIds());
  bare->GetCellData()->SetGlobalIds(mesh->GetCellData()->GetGlobalIds());
  bare->SetFieldData(mesh->GetFieldData());
  if (vtkDataArray* isoValues = vtkSPHFindIsoValues(mesh))
  {
    bare->GetPointData()->AddArray(isoValues);
  }
  vtkSmartPointer<vtkPolyData> whole = GatherSurface(this->Controller, bare);
  whole = whole ? whole : vtkSmartPointer<vtkPolyData>::New();
  const Numbers found = this->Split(whole, all, table);
  vtkNew<vtkPolyData> part;
  part->ShallowCopy(mesh);
  const Numbers own = { Return(ranks, part->GetPointData(), found.OfPoint),
    Return(ranks, part->GetCellData(), found.OfTriangle),
    ranks.Join(found.Volumes) }; // only the first rank has found any
  Keep(part, own, output);
  return "";
}
VTK_ABI_NAMESPACE_END

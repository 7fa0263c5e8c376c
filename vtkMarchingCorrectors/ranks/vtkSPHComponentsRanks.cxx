// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Pieces of a surface that many processes have parts of. The first one puts it together by its points' and
// triangles' numbers, so that it has what one process has, and sends each the numbers of its pieces.
#include "vtkSPHComponents.h"

#include "mcor.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHRanks.h"
#include "vtkSPHRanksParticles.h"
#include "vtkSPHRanksTuples.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

namespace
{
using Lists = std::vector<std::vector<vtkIdType>>;

/** All of so many tuples, to the first rank. */
Lists ToFirst(vtkSPHRanks& ranks, vtkIdType count)
{
  Lists to(static_cast<std::size_t>(ranks.GetCount()));
  to[0].resize(static_cast<std::size_t>(count));
  std::iota(to[0].begin(), to[0].end(), vtkIdType(0));
  return to;
}

/** What was sent to the first rank: arrays of all, numbers of the tuples in the whole, and how many came from
 * each. */
struct Sent
{
  vtkNew<vtkDoubleArray> Values;
  vtkNew<vtkIdTypeArray> Numbers, Corners;
  std::vector<vtkIdType> From;

  void Receive(
    vtkSPHRanks& ranks, const vtkSPHRanksArrays& own, vtkIdType count, const vtkSPHRanksArrays& all)
  {
    const std::vector<vtkSPHRanks::Bytes> received =
      vtkSPHSendTuples(ranks, own, ToFirst(ranks, count));
    this->From = vtkSPHCountTuples(received);
    const vtkIdType total = std::accumulate(this->From.begin(), this->From.end(), vtkIdType(0));
    for (vtkAbstractArray* array : all)
    {
      array->SetNumberOfTuples(total);
    }
    vtkSPHReceiveTuples(received, all);
  }
};

/** The corners of this rank's triangles by the points' numbers in the whole. */
vtkSmartPointer<vtkIdTypeArray> ListCorners(vtkPolyData* mesh, vtkIdTypeArray* numbers)
{
  auto corners = vtkSmartPointer<vtkIdTypeArray>::New();
  vtkNew<vtkIdList> triangle;
  corners->SetNumberOfComponents(3);
  corners->SetNumberOfTuples(mesh->GetNumberOfPolys());
  for (vtkIdType t = 0; t < mesh->GetNumberOfPolys(); ++t)
  {
    mesh->GetPolys()->GetCellAtId(t, triangle);
    for (int i = 0; i < 3; ++i)
    {
      corners->SetTypedComponent(t, i, numbers->GetValue(triangle->GetId(i)));
    }
  }
  return corners;
}

/** Numbers as ids, whatever type they have. */
vtkSmartPointer<vtkIdTypeArray> NumbersOf(vtkDataSetAttributes* data, vtkIdType count)
{
  auto numbers = vtkSmartPointer<vtkIdTypeArray>::New();
  numbers->SetNumberOfTuples(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    numbers->SetValue(i, static_cast<vtkIdType>(data->GetGlobalIds()->GetComponent(i, 0)));
  }
  return numbers;
}

vtkIdType CountOf(vtkIdTypeArray* numbers)
{
  vtkIdType count = 0;
  for (vtkIdType i = 0; i < numbers->GetNumberOfTuples(); ++i)
  {
    count = std::max(count, numbers->GetValue(i) + 1);
  }
  return count;
}

/** The whole surface, in the order of its numbers. */
vtkSmartPointer<vtkPolyData> PutTogether(const Sent& points, const Sent& triangles)
{
  auto whole = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  places->SetNumberOfPoints(CountOf(points.Numbers));
  for (vtkIdType i = 0; i < points.Numbers->GetNumberOfTuples(); ++i)
  {
    places->SetPoint(points.Numbers->GetValue(i), points.Values->GetPointer(3 * i));
  }
  vtkNew<vtkIdTypeArray> corners;
  corners->SetNumberOfValues(3 * CountOf(triangles.Numbers));
  for (vtkIdType t = 0; t < triangles.Numbers->GetNumberOfTuples(); ++t)
  {
    std::copy_n(triangles.Corners->GetPointer(3 * t), 3,
      corners->GetPointer(3 * triangles.Numbers->GetValue(t)));
  }
  vtkNew<vtkCellArray> cells;
  cells->SetData(3, corners);
  whole->SetPoints(places);
  whole->SetPolys(cells);
  return whole;
}

/** Sends what the first rank knows of the whole back: pieces, and numbers among those that stay. Returns the
 * pieces of this rank's; `numbers` become the new ones, of those that stay. */
std::vector<vtkIdType> Return(vtkSPHRanks& ranks, const Sent& sent,
  const std::vector<vtkIdType>& pieces, vtkIdType count, vtkIdTypeArray* numbers)
{
  std::vector<vtkIdType> place(pieces.size());
  vtkIdType next = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i)
  {
    place[i] = pieces[i] >= 0 ? next++ : -1;
  }
  vtkNew<vtkPointData> results, came;
  vtkNew<vtkIdTypeArray> both;
  both->SetName("Numbers");
  both->SetNumberOfComponents(2);
  Lists back;
  vtkIdType at = 0;
  for (const vtkIdType from : sent.From)
  {
    back.emplace_back();
    for (const vtkIdType end = at + from; at < end; ++at)
    {
      const auto number = static_cast<std::size_t>(sent.Numbers->GetValue(at));
      both->InsertNextTypedTuple(
        std::array<vtkIdType, 2>{ { pieces[number], place[number] } }.data());
      back.back().push_back(at);
    }
  }
  results->AddArray(both);
  vtkSPHReturnArrays(ranks, results, at, back, ToFirst(ranks, count), count, came);
  std::vector<vtkIdType> own(static_cast<std::size_t>(count));
  vtkDataArray* answer = came->GetArray("Numbers");
  numbers->Reset();
  for (vtkIdType i = 0; i < count; ++i)
  {
    own[static_cast<std::size_t>(i)] = static_cast<vtkIdType>(answer->GetComponent(i, 0));
    if (own[static_cast<std::size_t>(i)] >= 0)
    {
      numbers->InsertNextValue(static_cast<vtkIdType>(answer->GetComponent(i, 1)));
    }
  }
  return own;
}

void Renumber(vtkDataSetAttributes* data, vtkIdTypeArray* numbers)
{
  if (data->GetGlobalIds())
  {
    numbers->SetName(data->GetGlobalIds()->GetName());
    data->SetGlobalIds(numbers);
  }
}
}

// On the first rank all of them, with what the table tells of them.
vtkSmartPointer<vtkPointSet> vtkSPHComponents::GatherParticles(
  vtkSPHRanks& ranks, vtkPointSet* particles) const
{
  const vtkSmartPointer<vtkPolyData> own = vtkSPHTakeParticles(ranks, particles);
  vtkPointData* data = own->GetPointData();
  const auto find = [&](const std::string& name, mcor_quantity quantity, int components)
  { return name.empty() ? vtkSPHDetect(own, quantity, components) : data->GetArray(name.c_str()); };
  vtkNew<vtkPolyData> fluid;
  fluid->SetPoints(own->GetPoints());
  for (vtkDataArray* array :
    { find(this->MassArrayName, MCOR_MASS, 1), find(this->VelocityArrayName, MCOR_VELOCITY, 3),
      data->GetArray(this->FluidArrayName.c_str()) })
  {
    if (array)
    {
      fluid->GetPointData()->AddArray(array);
    }
  }
  return vtkSPHSendParticles(ranks, fluid, ToFirst(ranks, own->GetNumberOfPoints())).Get();
}

// Returns what is wrong, on all ranks alike; nothing here may return on one of them and go on on another.
std::string vtkSPHComponents::SplitDistributed(
  vtkPolyData* mesh, vtkPointSet* particles, vtkPolyData* output, vtkTable* table) const
{
  vtkSPHRanks ranks(this->Controller);
  std::string problem = FindProblem(mesh);
  const vtkIdType pointCount = mesh->GetNumberOfPoints(), triangleCount = mesh->GetNumberOfPolys();
  if ((pointCount > 0 && !mesh->GetPointData()->GetGlobalIds()) ||
    (triangleCount > 0 && !mesh->GetCellData()->GetGlobalIds()))
  {
    problem =
      "The parts of the surface have no GlobalPointIds and GlobalCellIds, by which pieces are "
      "put together. Take the surface as the filter of several processes makes it.";
  }
  if (!ranks.Agree(problem))
  {
    return problem;
  }
  std::int64_t given = particles ? 1 : 0;
  ranks.Reduce(vtkSPHRanks::GREATEST, &given, 1);
  const vtkSmartPointer<vtkPointSet> all =
    given > 0 ? this->GatherParticles(ranks, particles) : nullptr;
  const vtkSmartPointer<vtkIdTypeArray> pointNumbers = NumbersOf(mesh->GetPointData(), pointCount);
  const vtkSmartPointer<vtkIdTypeArray> triangleNumbers =
    NumbersOf(mesh->GetCellData(), triangleCount);
  vtkNew<vtkDoubleArray> places;
  places->SetNumberOfComponents(3);
  if (mesh->GetPoints())
  {
    places->DeepCopy(mesh->GetPoints()->GetData());
  }
  Sent points, triangles;
  points.Values->SetNumberOfComponents(3);
  triangles.Corners->SetNumberOfComponents(3);
  points.Receive(ranks, { places, pointNumbers }, pointCount, { points.Values, points.Numbers });
  triangles.Receive(ranks, { ListCorners(mesh, pointNumbers), triangleNumbers }, triangleCount,
    { triangles.Corners, triangles.Numbers });
  const Numbers whole = this->Split(PutTogether(points, triangles), all, table);
  const Numbers own = { Return(ranks, points, whole.OfPoint, pointCount, pointNumbers),
    Return(ranks, triangles, whole.OfTriangle, triangleCount, triangleNumbers) };
  Keep(mesh, own, output);
  Renumber(output->GetPointData(), pointNumbers);
  Renumber(output->GetCellData(), triangleNumbers);
  return "";
}

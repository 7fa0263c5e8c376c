// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// Finds the particles in a filter's input, processes blocks, and finds values for panels.
#include "vtkSPHAlgorithm.h"

#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHBlocks.h"
#include "vtkSPHColorRange.h"
#include "vtkSPHRun.h"
#include "vtkSPHSay.h"
#include "vtkVersionMacros.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

VTK_ABI_NAMESPACE_BEGIN
// All processes take part in the run of each block, so all must have the same number of blocks.
bool vtkSPHAlgorithm::AgreeOnBlocks(vtkDataObjectTree* blocks)
{
  const double count = blocks ? static_cast<double>(vtkSPHNameBlocks(blocks).size()) : -1.0;
  double range[2] = { count, count };
  vtkRun::Make(this)->MergeRanges(range, 1);
  if (range[0] < range[1])
  {
    this->Fail("The processes have different numbers of blocks. Merge the blocks of each process.");
  }
  return range[0] == range[1];
}

// A block that fails leaves its place empty, and does not touch other blocks. An observer of the
// progress may take blocks out of the input, or change blocks that come later, so the tree and the
// later blocks are copied first.
void vtkSPHAlgorithm::ProcessBlocks(vtkDataObjectTree* input, vtkDataObjectTree* output)
{
  auto blocks = vtkSmartPointer<vtkDataObjectTree>::Take(input->NewInstance());
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 3, 0)
  blocks->CompositeShallowCopy(input);
#else
  blocks->ShallowCopy(input); // the same blocks as in the input
#endif
  output->CopyStructure(blocks);
  const std::vector<std::string> names = vtkSPHNameBlocks(blocks);
  const auto iterator = vtk::TakeSmartPointer(blocks->NewTreeIterator());
  // The blocks, in order. Later blocks are shallow copies. The first block is not copied, so that
  // the data that the filter has kept for this block can be used again.
  std::vector<vtkSmartPointer<vtkDataObject>> taken;
  for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
  {
    vtkDataObject* block = iterator->GetCurrentDataObject();
    taken.emplace_back(block);
    if (taken.size() > 1)
    {
      taken.back().TakeReference(block->NewInstance());
      taken.back()->ShallowCopy(block);
    }
  }
  iterator->InitTraversal();
  this->WarnOnce(WARN_WALL_BLOCK, vtkSPHFindWalls(names));
  const double share = 1.0 / static_cast<double>(names.size());
  for (size_t i = 0; i < names.size(); ++i, iterator->GoToNextItem())
  {
    this->SetProgressShiftScale(static_cast<double>(i) * share, share);
    this->BlockName = names[i] + ": ";
    vtkDataObject* block = taken[i];
    const auto made = NewOutput(this->GetOutputClassName(block->GetClassName()), block);
    made->GetFieldData()->PassData(block->GetFieldData());
    this->Process(block, made);
    output->SetDataSetFrom(iterator, made);
  }
  this->SetProgressShiftScale(0.0, 1.0);
  if (this->IsAborted())
  {
    output->CopyStructure(blocks); // a result has all blocks or none
  }
}

void vtkSPHAlgorithm::WarnOfMesh(vtkDataObject* data, vtkDataObject* taken)
{
  std::int64_t counts[2] = { 0, 0 };
  for (int k = 0; k < 2; ++k)
  {
    for (vtkPointSet* set : vtkSPHListPointSets(k == 0 ? data : taken))
    {
      counts[k] += set->GetNumberOfPoints();
    }
  }
  const auto run = vtkRun::Make(this);
  run->Sum(counts, 2);
  if (run->IsFirst() && counts[1] < counts[0])
  {
    this->Warn(vtkSPHSay(MCOR_SAY(MESH_NODES), static_cast<long long>(counts[0] - counts[1]),
      static_cast<long long>(counts[0]), "", ""));
  }
}

bool vtkSPHAlgorithm::vtkInternals::Made::Serves(vtkDataObject* from, const std::string& how)
{
  auto* tree = vtkDataObjectTree::SafeDownCast(from);
  if (this->Data && this->From.GetPointer() == from && this->How == how &&
    (tree ? vtkSPHTimeOfBlocks(tree) : from->GetMTime()) <= this->Time.GetMTime())
  {
    return true;
  }
  this->From = from;
  this->How = how;
  this->Time.Modified();
  return false;
}

// A rank that has only a mesh, or nothing, needs to know whether any rank has vertices.
vtkDataObject* vtkSPHAlgorithm::TakeVertices(vtkDataObject* data)
{
  vtkInternals::Made& taken = this->Internals->Taken;
  std::int64_t haveVertices = vtkSPHHaveVertices(data) ? 1 : 0;
  vtkRun::Make(this)->Sum(&haveVertices, 1);
  if (!taken.Serves(data, haveVertices > 0 ? "vertices" : ""))
  {
    taken.Data = vtkSPHTakeVertices(data, haveVertices > 0);
  }
  return taken.Data;
}

vtkSmartPointer<vtkPointSet> vtkSPHAlgorithm::TakeParticles(vtkDataObject* data)
{
  return this->JoinParticles(this->TakeVertices(data));
}

vtkSmartPointer<vtkPointSet> vtkSPHAlgorithm::TakeParticlesAhead(vtkDataObject* data)
{
  auto* points = vtkPointSet::SafeDownCast(data);
  if (!this->IsShared() && points && points->GetNumberOfPoints() == 0)
  {
    this->GetInputAlgorithm(0, 0)->Update();
  }
  return this->TakeParticles(data);
}

vtkSmartPointer<vtkPointSet> vtkSPHAlgorithm::JoinParticles(vtkDataObject* data)
{
  vtkInternals::Made& joined = this->Internals->Joined;
  auto* tree = vtkDataObjectTree::SafeDownCast(data);
  if (!tree)
  {
    joined.Data = nullptr;
    return vtkPointSet::SafeDownCast(data);
  }
  if (!joined.Serves(data, this->FluidArrayName))
  {
    joined.Data = vtkSPHJoinBlocks(tree, this->FluidArrayName);
  }
  return vtkPointSet::SafeDownCast(joined.Data);
}

vtkSmartPointer<vtkPointSet> vtkSPHAlgorithm::TakePresent(vtkPointSet* particles) const
{
  const std::vector<bool> present =
    particles ? vtkSPHFindPresent(*this, particles) : std::vector<bool>();
  if (std::count(present.begin(), present.end(), false) == 0)
  {
    return particles;
  }
  vtkNew<vtkIdList> ids;
  for (std::size_t i = 0; i < present.size(); ++i)
  {
    if (present[i])
    {
      ids->InsertNextId(static_cast<vtkIdType>(i));
    }
  }
  auto taken = vtkSmartPointer<vtkPolyData>::New();
  taken->SetPoints(vtkSPHTakePoints(particles->GetPoints(), ids));
  vtkSPHTakeTuples(particles->GetPointData(), ids, taken->GetPointData());
  taken->SetFieldData(particles->GetFieldData());
  return taken;
}

void vtkSPHAlgorithm::ProcessJoined(vtkDataObjectTree* input, vtkDataObject* output)
{
  const vtkSmartPointer<vtkPointSet> particles = this->JoinParticles(input);
  auto* tree = vtkDataObjectTree::SafeDownCast(output);
  if (!tree)
  {
    output->GetFieldData()->PassData(particles->GetFieldData());
    this->Process(particles, output);
    return;
  }
  auto made = vtkSmartPointer<vtkPointSet>::Take(particles->NewInstance());
  this->Process(particles, made);
  if (this->ErrorMessage.empty() && !this->IsAborted())
  {
    vtkSPHSplitBlocks(input, particles, made, tree);
  }
}

// At most `far` particles are left out at each end of an axis, so for each end the `far` + 1
// outermost coordinates are kept. At upper ends, coordinates are negated.
bool vtkSPHAlgorithm::FindFluidBounds(vtkPointSet* particles, double bounds[6], double* densest)
{
  const auto run = vtkRun::Make(this);
  run->Begin(particles);
  run->Own = this->TakePresent(run->Own);
  const vtkSPHParticlesChoice choice = run->Choose();
  vtkPointSet* own = run->Own;
  vtkDataArray* fluid = own->GetPointData()->GetArray(choice.FluidArrayName.c_str());
  double x[3];
  const auto takeFluid = [own, fluid, &choice, &x](vtkIdType i)
  {
    own->GetPoint(i, x);
    return (!fluid || fluid->GetComponent(i, 0) == choice.FluidValue) && std::isfinite(x[0]) &&
      std::isfinite(x[1]) && std::isfinite(x[2]);
  };
  std::int64_t total = 0;
  for (vtkIdType i = 0; i < own->GetNumberOfPoints(); ++i)
  {
    total += takeFluid(i) ? 1 : 0;
  }
  run->Sum(&total, 1);
  if (total == 0)
  {
    return false;
  }
  const std::int64_t far = std::min(std::max<std::int64_t>(8, total / 1000), (total - 1) / 4);
  const auto keepLowest = [far](std::vector<double>& values)
  {
    const auto kept = std::min<std::ptrdiff_t>(far + 1, values.end() - values.begin());
    std::partial_sort(values.begin(), values.begin() + kept, values.end());
    values.resize(static_cast<std::size_t>(kept));
  };
  std::vector<double> mine[6], ends[6];
  double longest = 0.0;
  for (vtkIdType i = 0; i < own->GetNumberOfPoints(); ++i)
  {
    const bool isFluid = takeFluid(i);
    for (int e = 0; e < 6 && isFluid; ++e)
    {
      mine[e].push_back(e % 2 ? -x[e / 2] : x[e / 2]);
      if (static_cast<std::int64_t>(mine[e].size()) > 8 * (far + 1))
      {
        keepLowest(mine[e]); // so that memory does not grow with the particles
      }
    }
  }
  for (int e = 0; e < 6; ++e)
  {
    keepLowest(mine[e]);
    for (const std::vector<vtkRun::Named>& theirs : run->Gather({ { "", mine[e] } }))
    {
      ends[e].insert(ends[e].end(), theirs[0].second.begin(), theirs[0].second.end());
    }
    keepLowest(ends[e]);
    longest = std::max(longest, e % 2 ? -ends[e].back() - ends[e - 1].back() : 0.0);
  }
  for (int e = 0; e < 6; ++e)
  {
    const double end = *std::lower_bound(ends[e].begin(), ends[e].end(), ends[e].back() - longest);
    bounds[e] = e % 2 ? -end : end;
  }
  for (int a = 0; a < 3 && densest; ++a)
  {
    // Divides the box into columns along this axis, side by side.
    constexpr int Columns = 16;
    const int across[2] = { (a + 1) % 3, (a + 2) % 3 };
    std::vector<std::int64_t> counts(static_cast<std::size_t>(Columns * Columns), 0);
    const auto width = [bounds](int b) { return (bounds[2 * b + 1] - bounds[2 * b]) / Columns; };
    for (vtkIdType i = 0; i < own->GetNumberOfPoints(); ++i)
    {
      int column[2] = { 0, 0 };
      bool isIn = takeFluid(i);
      for (int k = 0; k < 2 && isIn; ++k)
      {
        const double from = x[across[k]] - bounds[2 * across[k]];
        const double at = width(across[k]) > 0.0 ? from / width(across[k]) : 0.0;
        isIn = at >= 0.0 && at <= Columns;
        column[k] = isIn ? std::min(static_cast<int>(at), Columns - 1) : 0;
      }
      counts[Columns * column[0] + column[1]] += isIn ? 1 : 0;
    }
    // Of the columns with nearly the most particles, the one nearest to the middle is best.
    const auto most = static_cast<double>(*std::max_element(counts.begin(), counts.end()));
    const auto off = [](int c)
    { return std::abs(c / Columns - 0.5 * Columns) + std::abs(c % Columns - 0.5 * Columns); };
    int best = -1;
    for (int c = 0; c < Columns * Columns; ++c)
    {
      const bool isDense = static_cast<double>(counts[c]) >= 0.9 * most;
      best = isDense && (best < 0 || off(c) < off(best)) ? c : best;
    }
    densest[3 * a + a] = 0.5 * bounds[2 * a] + 0.5 * bounds[2 * a + 1];
    for (int k = 0; k < 2; ++k)
    {
      densest[3 * a + across[k]] = bounds[2 * across[k]] +
        (0.5 + (k == 0 ? best / Columns : best % Columns)) * width(across[k]);
    }
  }
  return true;
}

// If processes share a run, bounds are unknown: all processes would have to call this at one time.
double* vtkSPHAlgorithm::FindNextBounds(bool densest)
{
  const vtkSmartPointer<vtkPointSet> particles =
    this->IsShared() ? nullptr : this->TakeParticles(this->GetParticles());
  double(&found)[2][9] = this->NextPlaces;
  if (!particles || !this->FindFluidBounds(particles, found[0], densest ? found[1] : nullptr))
  {
    std::fill_n(found[densest], 9, 0.0);
  }
  return found[densest];
}

const char* vtkSPHAlgorithm::GetColorRanges()
{
  std::ostringstream text;
  auto* shown = vtkDataSet::SafeDownCast(this->GetOutputDataObject(0));
  auto* points = vtkPointSet::SafeDownCast(shown);
  std::vector<bool> areWalls;
  if (shown && !this->IsShared())
  {
    vtkSPHParticlesChoice choice(*this);
    if (points && points->GetNumberOfPoints() > 0)
    {
      vtkSPHChoose(choice, points, nullptr, nullptr);
    }
    vtkPointData* data = shown->GetPointData();
    vtkDataArray* fluid = data->GetArray(choice.FluidArrayName.c_str());
    for (vtkIdType i = 0; fluid && points && i < fluid->GetNumberOfTuples(); ++i)
    {
      areWalls.push_back(fluid->GetComponent(i, 0) != choice.FluidValue);
    }
    const vtkSPHColorRange ranges(shown, areWalls);
    for (int i = 0; i < data->GetNumberOfArrays(); ++i)
    {
      double range[2];
      vtkDataArray* array = data->GetArray(i);
      if (array && array->GetName() && array->GetNumberOfTuples() == shown->GetNumberOfPoints() &&
        ranges.Find(array, range))
      {
        text << range[0] << " " << range[1] << " " << array->GetName() << "\n";
      }
    }
  }
  this->ColorRanges = text.str();
  return this->ColorRanges.c_str();
}

int vtkSPHAlgorithm::GetNextEstimate()
{
  vtkDataObject* data = this->GetParticles();
  const vtkSmartPointer<vtkDataObject> taken = vtkSPHTakeVertices(data, vtkSPHHaveVertices(data));
  const std::vector<vtkPointSet*> sets = vtkSPHListPointSets(taken);
  vtkSPHParticlesChoice choice(*this);
  choice.EstimateSmoothingLength = 0;
  if (sets.empty())
  {
    return 0;
  }
  vtkSPHParticles particles(choice, sets.front());
  particles.Collect();
  return mcor_is_given(&particles.Core.smoothing_length) ? 0 : 1;
}

const char* vtkSPHAlgorithm::GetNextBlocks()
{
  this->NextBlocks.clear();
  if (auto* tree = vtkDataObjectTree::SafeDownCast(this->GetParticles()))
  {
    for (const std::string& choice : vtkSPHListFluidBlocks(tree))
    {
      this->NextBlocks += choice + "\n";
    }
  }
  return this->NextBlocks.c_str();
}

vtkDataObject* vtkSPHAlgorithm::GetParticles()
{
  const int port = this->GetParticlesPort();
  return this->GetNumberOfInputConnections(port) > 0 ? this->GetInputDataObject(port, 0) : nullptr;
}

int vtkSPHAlgorithm::FindDimension(vtkPointSet* particles)
{
  const auto run = vtkRun::Make(this);
  run->Begin(particles);
  vtkSPHWanted wanted;
  wanted.Wants = 0;
  vtkSPHParticles mine(run->Choose(), run->Own, wanted);
  mine.Collect();
  return run->Ask([&](const mcor_ranks* ranks)
    { return mcor_find_dimension(&mine.Core, ranks, this->Dimension); });
}
VTK_ABI_NAMESPACE_END

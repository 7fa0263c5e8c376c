// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHMeter.h"

#include "vtkAbstractArray.h"
#include "vtkBoundingBox.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHArrays.h"
#include "vtkSPHPrint.h"
#include "vtkSPHRun.h"
#include "vtkSPHSay.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkVariant.h"

#include <algorithm>
#include <set>

VTK_ABI_NAMESPACE_BEGIN
using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkSPHMeter::vtkSPHMeter()
{
  this->SetNumberOfInputPorts(2);
}

vtkTable* vtkSPHMeter::GetOutput()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(0));
}

int vtkSPHMeter::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

// Requests all of both inputs, whatever piece of the table is wanted. If processes share a run,
// requests all of the places, but leaves to the pipeline which particles this process gets.
int vtkSPHMeter::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  for (int port = 0; port < 2; ++port)
  {
    vtkInformation* info = inputVector[port]->GetInformationObject(0);
    if (info && (port == 1 || !this->IsShared()))
    {
      AskForAll(info);
    }
  }
  return 1;
}

void vtkSPHMeter::AddPlace(const char* name, int shape, std::vector<double> numbers)
{
  this->Places.push_back({ name ? name : "", shape, std::move(numbers) });
  this->Modified();
}

std::string vtkSPHMeter::NameOf(vtkDataSet* data, vtkIdType cell, const std::string& usual)
{
  vtkAbstractArray* names = data->GetCellData()->GetAbstractArray("Name");
  return names
    ? std::string(names->GetVariantValue(cell * names->GetNumberOfComponents()).ToString())
    : usual;
}

vtkSPHWanted vtkSPHMeter::GetWanted() const
{
  return vtkSPHWanted();
}

// Returns false, after an error, if two places have the same name.
bool vtkSPHMeter::CheckNames(const std::vector<Place>& places)
{
  std::set<std::string> names;
  for (const Place& place : places)
  {
    if (!names.insert(place.Name).second)
    {
      this->Fail(std::string("Two ") + this->GetNoun() + "s have the name '" + place.Name +
        "'. Give each a name of its own.");
      return false;
    }
  }
  return true;
}

// If there is no fluid, each process calls the core without particles, and the core finds nothing.
void vtkSPHMeter::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* table = vtkTable::SafeDownCast(output);
  vtkDataObject* const input = this->GetParticles();
  vtkInformation* const known = input ? input->GetInformation() : nullptr;
  vtkInformation* const asked = this->GetOutputInformation(0);
  const double time = known && known->Has(vtkDataObject::DATA_TIME_STEP())
    ? known->Get(vtkDataObject::DATA_TIME_STEP())
    : asked->Has(Pipeline::UPDATE_TIME_STEP()) ? asked->Get(Pipeline::UPDATE_TIME_STEP())
                                               : this->Time;
  this->SetUsedNames(nullptr);
  std::unique_ptr<vtkRun> run = vtkRun::Make(this);
  const bool isFirst = run->IsFirst();
  const std::vector<Place> places = Merge(*run, this->ListPlaces(this->GetInputDataObject(1, 0)));
  if (!run->Begin(vtkPointSet::SafeDownCast(data)) || !this->CheckNames(places))
  {
    return;
  }
  vtkSPHParticles present(run->Choose(), run->Own, this->GetWanted());
  if (!run->Accept(present, this->GetConsequence()))
  {
    return;
  }
  const bool hasFluid = run->HasFluid;
  vtkNew<vtkPolyData> none;
  none->SetPoints(vtkNew<vtkPoints>());
  if (!hasFluid)
  {
    run = std::make_unique<vtkRun>(this);
    run->Own = none;
  }
  vtkSPHParticles nothing(vtkSPHParticlesChoice(*this), none);
  vtkSPHParticles& mine = hasFluid ? present : nothing;
  this->FillOptions(run->Options);
  run->Options.field = MCOR_WEIGHT_SUM;
  run->Options.level_limit = 0;
  run->Options.wall_share = MCOR_WALL_SHARE_MEASURED;
  run->Options.iso_values = &this->Level;
  run->Options.iso_count = 1;
  if (!run->Measure(mine, false))
  {
    return;
  }
  vtkBoundingBox box;
  for (const Place& place : places)
  {
    const size_t count = place.Numbers.size();
    const double radius = count % 3 == 1 ? place.Numbers.back() : 0.0;
    for (size_t i = 0; i < (count % 3 == 1 ? 3 : count); i += 3)
    {
      const double* x = place.Numbers.data() + i;
      box.AddPoint(x[0] - radius, x[1] - radius, x[2] - radius);
      box.AddPoint(x[0] + radius, x[1] + radius, x[2] + radius);
    }
  }
  run->PlaceBox(box.GetMinPoint(), box.GetMaxPoint());
  vtkSPHParticles* shared = run->Share(mine);
  const auto count = static_cast<vtkIdType>(places.size());
  vtkSPHAddColumn<vtkDoubleArray>(table, "time", count, [time](vtkIdType) { return time; });
  vtkSPHAddColumn<vtkStringArray>(
    table, this->GetNoun(), count, [&places](vtkIdType i) { return places[i].Name; });
  std::vector<bool> outside;
  mcor_statistics statistics = {};
  if (!shared ||
    !run->Call(*shared,
      [&](mcor_context* context) {
        return this->Measure(
          context, shared->Core, run->Options, places, table, outside, statistics);
      }))
  {
    table->GetRowData()->Initialize();
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, statistics);
  run->WarnOfParticles(shared->Core, statistics);
  const auto first = std::find(outside.begin(), outside.end(), true);
  const auto dry = std::count(first, outside.end(), true);
  if (isFirst && hasFluid && dry > 0)
  {
    const char* noun = this->GetNoun();
    const char* name = places[first - outside.begin()].Name.c_str();
    this->Warn(dry == 1 ? vtkSPHSay(MCOR_SAY(PLACE_DRY), noun, name)
                        : vtkSPHSay(MCOR_SAY(PLACES_DRY), static_cast<long long>(dry),
                            static_cast<long long>(outside.size()), noun, name));
  }
  if (!isFirst)
  {
    table->SetNumberOfRows(0);
  }
}

// Lists the places of all processes, equal places once. Numbers may be NaN, so bytes are compared.
std::vector<vtkSPHMeter::Place> vtkSPHMeter::Merge(vtkRun& run, const std::vector<Place>& mine)
{
  std::vector<vtkRun::Named> own;
  for (const Place& place : mine)
  {
    own.emplace_back(place.Name, place.Numbers);
    own.back().second.push_back(place.Shape);
  }
  std::vector<Place> all;
  std::set<std::pair<std::string, std::string>> known;
  for (const std::vector<vtkRun::Named>& theirs : run.Gather(own))
  {
    const auto before = known; // CheckNames() reports equal places of one process
    for (const vtkRun::Named& place : theirs)
    {
      const std::vector<double>& numbers = place.second;
      const std::pair<std::string, std::string> one(place.first,
        { reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double) });
      if (before.count(one) == 0)
      {
        known.insert(one);
        all.push_back({ place.first, static_cast<int>(numbers.back()),
          std::vector<double>(numbers.begin(), numbers.end() - 1) });
      }
    }
  }
  return all;
}

void vtkSPHMeter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(Level, Time);
}
VTK_ABI_NAMESPACE_END

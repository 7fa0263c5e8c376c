// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHMeter.h"

#include "mcor.h"
#include "vtkDoubleArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHMeterColumn.h"
#include "vtkSPHParticles.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <set>

VTK_ABI_NAMESPACE_BEGIN
using Pipeline = vtkStreamingDemandDrivenPipeline;

vtkSPHMeter::vtkSPHMeter()
{
  this->SetNumberOfInputPorts(2);
}

vtkSPHMeter::~vtkSPHMeter() = default;

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

int vtkSPHMeter::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

const char* vtkSPHMeter::GetOutputClassName(const char*)
{
  return "vtkTable";
}

// Requests all of both inputs, whatever piece of the table is wanted; if processes share a run, all
// of the places.
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

int vtkSPHMeter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  vtkInformation* asked = outputVector->GetInformationObject(0);
  vtkInformation* known = input ? input->GetInformation() : nullptr;
  this->More = vtkDataObject::GetData(inputVector[1]);
  this->InputTime = known && known->Has(vtkDataObject::DATA_TIME_STEP())
    ? known->Get(vtkDataObject::DATA_TIME_STEP())
    : asked->Has(Pipeline::UPDATE_TIME_STEP()) ? asked->Get(Pipeline::UPDATE_TIME_STEP())
                                               : this->Time;
  const int done = this->Superclass::RequestData(request, inputVector, outputVector);
  this->More = nullptr;
  return done;
}

bool vtkSPHMeter::Collect(vtkSPHParticles& particles)
{
  return particles.CollectParticles();
}

// Returns false, after an error, if two places have one name.
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

void vtkSPHMeter::Process(vtkDataObject* data, vtkDataObject* output)
{
  auto* particles = vtkPointSet::SafeDownCast(data);
  auto* table = vtkTable::SafeDownCast(output);
  this->SetUsedNames(nullptr);
#if MCOR_HAS_RANKS
  if (this->IsShared())
  {
    this->ProcessDistributed(particles, table);
    return;
  }
#endif
  const std::vector<Place> places = this->ListPlaces(this->More);
  if (!particles || this->IsAborted() || !this->CheckNames(places))
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  vtkSPHParticles input(choice, particles);
  if (particles->GetNumberOfPoints() == 0 ||
    this->Accept(input, this->Collect(input), this->GetConsequence()))
  {
    this->Measure(input, particles, places, table);
  }
}

void vtkSPHMeter::Measure(vtkSPHParticles& input, vtkPointSet* particles,
  const std::vector<Place>& places, vtkTable* output)
{
  mcor_options options;
  this->FillOptions(options);
  if (!this->SetPeriod(particles, options))
  {
    return;
  }
  options.iso_values = &this->Level;
  options.iso_count = 1;
  const std::unique_ptr<Found> found = this->MakeFound();
  if (!this->CallCore(input, options,
        [&](mcor_context* context) { return found->Call(context, input.Core, options, places); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, found->GetStatistics());
  this->WarnOfParticles(input.Core, options, found->GetStatistics());
  this->Fill(output, places, *found, input.FluidCount > 0);
}

void vtkSPHMeter::Fill(
  vtkTable* output, const std::vector<Place>& places, const Found& found, bool hasFluid)
{
  const auto count = static_cast<vtkIdType>(places.size());
  auto* times = vtkSPHAddColumn<vtkDoubleArray>(output, "time", count);
  auto* names = vtkSPHAddColumn<vtkStringArray>(output, this->GetNoun(), count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    const std::string& name = places[static_cast<size_t>(i)].Name;
    times->SetValue(i, this->InputTime);
    names->SetValue(i, name);
    if (hasFluid && found.IsOutside(i))
    {
      std::string noun = this->GetNoun();
      noun[0] = static_cast<char>(noun[0] - 'a' + 'A');
      this->Warn(noun + " '" + name +
        "' is outside of all fluid: no particle reaches it. If this is so at all times, "
        "check where it is.");
    }
  }
  found.Fill(output);
}

void vtkSPHMeter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Level: " << this->Level << "\n";
  os << indent << "Time: " << this->Time << "\n";
}
VTK_ABI_NAMESPACE_END

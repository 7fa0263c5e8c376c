// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHGauge.h"

#include "mcor.h"
#include "vtkAbstractArray.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <algorithm>
#include <set>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
using Pipeline = vtkStreamingDemandDrivenPipeline;

template <typename ArrayT>
ArrayT* AddColumn(vtkTable* table, const char* name, vtkIdType rows)
{
  vtkNew<ArrayT> column;
  column->SetName(name);
  column->SetNumberOfTuples(rows);
  table->AddColumn(column);
  return column;
}
}

vtkStandardNewMacro(vtkSPHGauge);

vtkSPHGauge::vtkSPHGauge()
{
  this->SetNumberOfInputPorts(2);
}

vtkSPHGauge::~vtkSPHGauge() = default;

vtkTable* vtkSPHGauge::GetOutput()
{
  return vtkTable::SafeDownCast(this->GetOutputDataObject(0));
}

void vtkSPHGauge::AddGauge(
  const char* name, double x0, double y0, double z0, double x1, double y1, double z1)
{
  this->Gauges.push_back({ name ? name : "", { x0, y0, z0, x1, y1, z1 } });
  this->Modified();
}

void vtkSPHGauge::ClearGauges()
{
  this->Gauges.clear();
  this->Modified();
}

int vtkSPHGauge::GetNumberOfGauges() const
{
  return static_cast<int>(this->Gauges.size());
}

int vtkSPHGauge::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkSPHGauge::FillOutputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkTable");
  return 1;
}

const char* vtkSPHGauge::GetOutputClassName(const char*)
{
  return "vtkTable";
}

// All of both, whatever piece of the table is wanted; of processes that share a run, all of the lines.
int vtkSPHGauge::RequestUpdateExtent(
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

int vtkSPHGauge::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  vtkInformation* asked = outputVector->GetInformationObject(0);
  vtkInformation* known = input ? input->GetInformation() : nullptr;
  this->Lines = vtkDataObject::GetData(inputVector[1]);
  this->InputTime = known && known->Has(vtkDataObject::DATA_TIME_STEP())
    ? known->Get(vtkDataObject::DATA_TIME_STEP())
    : asked->Has(Pipeline::UPDATE_TIME_STEP()) ? asked->Get(Pipeline::UPDATE_TIME_STEP())
                                               : this->Time;
  const int done = this->Superclass::RequestData(request, inputVector, outputVector);
  this->Lines = nullptr;
  return done;
}

void vtkSPHGauge::AddLines(vtkDataSet* lines, std::vector<Gauge>& gauges) const
{
  vtkAbstractArray* names = lines->GetCellData()->GetAbstractArray("Name");
  for (vtkIdType i = 0; i < lines->GetNumberOfCells(); ++i)
  {
    vtkCell* cell = lines->GetCell(i);
    if (cell->GetCellDimension() != 1)
    {
      continue;
    }
    Gauge gauge;
    gauge.Name = names ? names->GetVariantValue(i * names->GetNumberOfComponents()).ToString()
                       : "line " + std::to_string(i);
    lines->GetPoint(cell->GetPointId(0), gauge.Ends.data());
    lines->GetPoint(
      cell->GetPointId(static_cast<int>(cell->GetNumberOfPoints()) - 1), gauge.Ends.data() + 3);
    gauges.push_back(gauge);
  }
}

std::vector<vtkSPHGauge::Gauge> vtkSPHGauge::ListGauges() const
{
  std::vector<Gauge> gauges = this->Gauges;
  if (auto* lines = vtkDataSet::SafeDownCast(this->Lines))
  {
    this->AddLines(lines, gauges);
  }
  if (gauges.empty() && !this->Lines)
  {
    const double *a = this->Point1, *b = this->Point2;
    gauges.push_back({ "gauge", { a[0], a[1], a[2], b[0], b[1], b[2] } });
  }
  return gauges;
}

// False, and reported, where two have one name.
bool vtkSPHGauge::CheckNames(const std::vector<Gauge>& gauges)
{
  std::set<std::string> names;
  for (const Gauge& gauge : gauges)
  {
    if (!names.insert(gauge.Name).second)
    {
      this->Fail("Two gauges have the name '" + gauge.Name + "'. Give each a name of its own.");
      return false;
    }
  }
  return true;
}

void vtkSPHGauge::Process(vtkDataObject* data, vtkDataObject* output)
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
  const std::vector<Gauge> gauges = this->ListGauges();
  if (!particles || this->IsAborted() || !this->CheckNames(gauges))
  {
    return;
  }
  vtkSPHParticlesChoice choice(*this);
  this->FindFluid(choice, particles);
  vtkSPHParticles input(choice, particles);
  if (particles->GetNumberOfPoints() == 0 ||
    this->Accept(input, input.CollectParticles(), "all gauges are dry"))
  {
    this->Measure(input, particles, gauges, table);
  }
}

std::vector<mcor_gauge_line> vtkSPHGauge::ListLines(const std::vector<Gauge>& gauges)
{
  std::vector<mcor_gauge_line> lines;
  for (const Gauge& gauge : gauges)
  {
    mcor_gauge_line line = {};
    std::copy_n(gauge.Ends.data(), 3, line.from);
    std::copy_n(gauge.Ends.data() + 3, 3, line.to);
    line.name = gauge.Name.c_str();
    lines.push_back(line);
  }
  return lines;
}

void vtkSPHGauge::Measure(vtkSPHParticles& input, vtkPointSet* particles,
  const std::vector<Gauge>& gauges, vtkTable* output)
{
  const std::vector<mcor_gauge_line> lines = ListLines(gauges);
  mcor_options options;
  this->FillOptions(options);
  if (!this->SetPeriod(particles, options))
  {
    return;
  }
  options.iso_values = &this->Level;
  options.iso_count = 1;
  mcor_gauges found = {};
  const auto count = static_cast<int64_t>(lines.size());
  if (!this->CallCore(input, options,
        [&](mcor_context* context)
        { return mcor_gauge(context, &input.Core, &options, lines.data(), count, &found); }))
  {
    return;
  }
  vtkSPHAddRunStatistics(this->RunStatistics, found.statistics);
  this->WarnOfParticles(input.Core, options, found.statistics);
  this->Fill(output, gauges, found, input.FluidCount > 0);
  mcor_free_gauges(&found);
}

void vtkSPHGauge::Fill(
  vtkTable* output, const std::vector<Gauge>& gauges, const mcor_gauges& found, bool hasFluid)
{
  const auto count = static_cast<vtkIdType>(found.count);
  auto* times = AddColumn<vtkDoubleArray>(output, "time", count);
  auto* names = AddColumn<vtkStringArray>(output, "gauge", count);
  auto* states = AddColumn<vtkStringArray>(output, "state", count);
  auto* first = AddColumn<vtkDoubleArray>(output, "first", count);
  auto* last = AddColumn<vtkDoubleArray>(output, "last", count);
  auto* depth = AddColumn<vtkDoubleArray>(output, "depth", count);
  auto* crossings = AddColumn<vtkIdTypeArray>(output, "crossings", count);
  vtkDoubleArray* place[3] = { AddColumn<vtkDoubleArray>(output, "x", count),
    AddColumn<vtkDoubleArray>(output, "y", count), AddColumn<vtkDoubleArray>(output, "z", count) };
  for (vtkIdType i = 0; i < count; ++i)
  {
    const mcor_gauge_reading& reading = found.readings[i];
    const std::string& name = gauges[static_cast<size_t>(i)].Name;
    times->SetValue(i, this->InputTime);
    names->SetValue(i, name);
    states->SetValue(i, mcor_gauge_state_name(reading.state));
    first->SetValue(i, reading.first);
    last->SetValue(i, reading.last);
    depth->SetValue(i, reading.depth);
    crossings->SetValue(i, reading.crossing_count);
    for (int a = 0; a < 3; ++a)
    {
      place[a]->SetValue(i, reading.place[a]);
    }
    if (reading.outside && hasFluid)
    {
      this->Warn("Gauge '" + name +
        "' is outside of all fluid: no particle reaches its line. If this is so at all times, "
        "check its ends.");
    }
  }
}

void vtkSPHGauge::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Level: " << this->Level << "\n";
  os << indent << "Time: " << this->Time << "\n";
  PrintNumbers(os, indent, "Point1", this->Point1, 3);
  PrintNumbers(os, indent, "Point2", this->Point2, 3);
  for (const Gauge& gauge : this->Gauges)
  {
    PrintNumbers(os, indent, ("Gauge " + gauge.Name).c_str(), gauge.Ends.data(), 6);
  }
}
VTK_ABI_NAMESPACE_END

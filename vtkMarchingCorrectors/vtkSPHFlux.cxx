// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHFlux.h"

#include "mcor.h"
#include "vtkCell.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPoints.h"
#include "vtkSPHArrays.h"
#include "vtkSPHParticles.h"
#include "vtkSPHPrint.h"

#include <algorithm>
#include <functional>
#include <iterator>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
/** A section: the triangles of its polygons, or its lines. */
struct Shapes
{
  std::string Name;
  std::vector<double> Triangles;
  std::vector<double> Lines;
};

/** Lists sections, in the order of their first cells. Cells with one name are one section. */
std::vector<Shapes> ListShapes(
  vtkDataSet* data, const std::function<std::string(vtkIdType)>& nameOf)
{
  std::vector<Shapes> all;
  for (vtkIdType i = 0; i < data->GetNumberOfCells(); ++i)
  {
    vtkCell* cell = data->GetCell(i);
    const int dimension = cell->GetCellDimension();
    if (dimension != 1 && dimension != 2)
    {
      continue;
    }
    const std::string name = nameOf(i);
    auto shapes =
      std::find_if(all.begin(), all.end(), [&name](const Shapes& s) { return s.Name == name; });
    shapes = shapes == all.end() ? all.insert(shapes, { name, {}, {} }) : shapes;
    vtkNew<vtkIdList> ids;
    vtkNew<vtkPoints> points;
    cell->Triangulate(0, ids, points);
    for (vtkIdType p = 0; p < points->GetNumberOfPoints(); ++p)
    {
      double at[3];
      points->GetPoint(p, at);
      std::vector<double>& to = dimension == 1 ? shapes->Lines : shapes->Triangles;
      to.insert(to.end(), at, at + 3);
    }
  }
  return all;
}
}

vtkStandardNewMacro(vtkSPHFlux);

void vtkSPHFlux::AddRectangle(
  const char* name, const double a[3], const double b[3], const double c[3])
{
  this->AddPlace(
    name, MCOR_SECTION_RECTANGLE, { a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2] });
}

void vtkSPHFlux::AddDisc(const char* name, const double c[3], const double n[3], double radius)
{
  this->AddPlace(name, MCOR_SECTION_DISC, { c[0], c[1], c[2], n[0], n[1], n[2], radius });
}

void vtkSPHFlux::AddBox(const char* name, const double b[6])
{
  this->AddPlace(name, MCOR_SECTION_BOX, { b[0], b[2], b[4], b[1], b[3], b[5] });
}

void vtkSPHFlux::AddLine(const char* name, const double a[3], const double b[3])
{
  this->AddPlace(name, MCOR_SECTION_LINES, { a[0], a[1], a[2], b[0], b[1], b[2] });
}

void vtkSPHFlux::AddSurface(const char* name, vtkDataSet* surface)
{
  const std::vector<Shapes> list = ListShapes(surface, [](vtkIdType) { return ""; });
  const Shapes all = list.empty() ? Shapes() : list.front(); // cells with one name are one section
  all.Triangles.empty() ? this->AddPlace(name, MCOR_SECTION_LINES, all.Lines)
                        : this->AddPlace(name, MCOR_SECTION_TRIANGLES, all.Triangles);
}

std::vector<vtkSPHMeter::Place> vtkSPHFlux::ListPlaces(vtkDataObject* more)
{
  std::vector<Place> sections = this->Places;
  if (auto* data = vtkDataSet::SafeDownCast(more))
  {
    for (const Shapes& shapes :
      ListShapes(data, [data](vtkIdType i) { return NameOf(data, i, "section"); }))
    {
      const bool isLine = shapes.Triangles.empty();
      sections.push_back({ shapes.Name, isLine ? MCOR_SECTION_LINES : MCOR_SECTION_TRIANGLES,
        isLine ? shapes.Lines : shapes.Triangles });
    }
  }
  if (sections.empty() && !more)
  {
    const double *o = this->Origin, *n = this->Normal;
    sections.push_back(
      { "section", MCOR_SECTION_DISC, { o[0], o[1], o[2], n[0], n[1], n[2], this->Radius } });
  }
  return sections;
}

vtkSPHWanted vtkSPHFlux::GetWanted() const
{
  vtkSPHWanted wanted;
  wanted.Wants |= MCOR_WANT_FLOW;
  wanted.Velocity = this->VelocityArrayName;
  return wanted;
}

int vtkSPHFlux::Measure(mcor_context* context, const mcor_input& particles,
  const mcor_options& options, const std::vector<Place>& places, vtkTable* table,
  std::vector<bool>& outside, mcor_statistics& statistics) const
{
  std::vector<mcor_section> sections;
  for (const Place& place : places)
  {
    mcor_section section = {};
    section.shape = static_cast<mcor_section_shape>(place.Shape);
    section.points = place.Numbers.data();
    section.point_count = static_cast<int64_t>(place.Numbers.size() / 3);
    section.radius = place.Shape == MCOR_SECTION_DISC ? place.Numbers.back() : 0.0;
    section.name = place.Name.c_str();
    sections.push_back(section);
  }
  mcor_input input = particles;
  mcor_array none[2] = {}; // velocities, densities
  none[0].components = 3;
  if (input.count == 0) // without particles, no array is needed, and nothing flows
  {
    input.attributes = none;
    input.attribute_count = 2;
  }
  vtkSPHOwned<mcor_fluxes, mcor_free_fluxes> fluxes;
  const int status = mcor_flux(
    context, &input, &options, sections.data(), static_cast<int64_t>(sections.size()), &fluxes);
  if (status != MCOR_OK)
  {
    return status;
  }
  const vtkIdType count = fluxes.count;
  const mcor_flux_reading* readings = fluxes.readings;
  vtkSPHAddColumns<mcor_flux_reading>(table, readings, count,
    { { "area", &mcor_flux_reading::area }, { "volume_flux", &mcor_flux_reading::volume_flux },
      { "mass_flux", &mcor_flux_reading::mass_flux },
      { "velocity", &mcor_flux_reading::velocity } });
  std::transform(readings, readings + count, std::back_inserter(outside),
    [](const mcor_flux_reading& reading) { return reading.outside != 0; });
  statistics = fluxes.statistics;
  return status;
}

void vtkSPHFlux::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  vtkSPHPrintMacro(Origin, Normal, Radius, VelocityArrayName);
  for (const Place& section : this->Places)
  {
    os << indent << "Section " << section.Name << ": shape " << section.Shape << ", "
       << section.Numbers.size() / 3 << " points\n";
  }
}
VTK_ABI_NAMESPACE_END

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "FluxRun.h"

#include "GaugeLine.h"
#include "Job.h"
#include "MeterRun.h"
#include "ParticleFile.h"

#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <stdexcept>

namespace
{

std::vector<FluxSection> ListSections(const Job& job)
{
  std::vector<FluxSection> sections = job.Fluxes;
  if (!job.FluxFile.empty())
  {
    for (const std::string& row : ReadRows("--fluxes", job.FluxFile, "sections", FluxForm))
    {
      sections.push_back(ToFlux("--fluxes " + job.FluxFile, row));
    }
  }
  std::vector<std::string> names;
  for (const FluxSection& section : sections)
  {
    names.push_back(section.Name);
  }
  CheckNames(names, "sections");
  return sections;
}

void AddSection(const Job& job, const FluxSection& section, MessageCapture* messages)
{
  const char* name = section.Name.c_str();
  const double* n = section.Numbers.data();
  switch (section.Shape)
  {
    case FluxSection::Line:
      job.Flux->AddLine(name, n, n + 3);
      break;
    case FluxSection::Rectangle:
      job.Flux->AddRectangle(name, n, n + 3, n + 6);
      break;
    case FluxSection::Disc:
      job.Flux->AddDisc(name, n, n + 3, n[6]);
      break;
    case FluxSection::Box:
      job.Flux->AddBox(name, n);
      break;
    default:
    {
      const vtkSmartPointer<vtkDataSet> surface = ReadDataSet(section.File, messages);
      if (surface->GetNumberOfCells() == 0)
      {
        throw std::runtime_error(section.File + " has no triangles for section '" + section.Name +
          "'; give a file of a surface");
      }
      job.Flux->AddSurface(name, surface);
    }
  }
}

/// The integrals of fluxes in time, by trapezia between steps.
class Flowed
{
public:
  /// Adds them to the table of a step, the columns volume and mass.
  void AddTo(vtkTable* table, double time)
  {
    const double passed = this->Before.empty() ? 0.0 : time - this->Time;
    const auto rows = static_cast<std::size_t>(table->GetNumberOfRows());
    std::vector<double> now(2 * rows);
    this->Sums.resize(2 * rows);
    this->Time = time;
    for (std::size_t flux = 0; flux < 2; ++flux)
    {
      vtkNew<vtkDoubleArray> column;
      column->SetName(flux == 0 ? "volume" : "mass");
      for (std::size_t row = 0; row < rows; ++row)
      {
        const std::size_t i = 2 * row + flux;
        now[i] =
          table->GetValueByName(
                 static_cast<vtkIdType>(row), flux == 0 ? "volume_flux" : "mass_flux")
            .ToDouble();
        const double before = this->Before.empty() ? now[i] : this->Before[i];
        this->Sums[i] +=
          passed * 0.5 * (before + now[i]) + 0.0 * now[i]; // no number where there is no flux
        column->InsertNextValue(this->Sums[i]);
      }
      table->AddColumn(column);
    }
    this->Before = rows > 0 ? now : std::vector<double>();
  }

private:
  double Time = 0.0;
  std::vector<double> Before, Sums; ///< of volume and mass, for each section
};

}

bool MakeFluxTable(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  const std::vector<FluxSection> sections = ListSections(job);
  for (const FluxSection& section : sections)
  {
    AddSection(job, section, messages);
  }
  Flowed flowed;
  const MeterTask task{ job.Flux,
    std::to_string(sections.size()) + (sections.size() == 1 ? " section" : " sections"),
    [&flowed](vtkTable* table, double time) { flowed.AddTo(table, time); }, {} };
  return MakeMeterTable(job, task, messages, sharing);
}

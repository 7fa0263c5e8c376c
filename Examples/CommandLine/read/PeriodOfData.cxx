// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

#include "ParticleFile.h"
#include "SafeText.h"

#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkFieldData.h"
#include "vtkSPHFound.h"

#include <sstream>
#include <stdexcept>

void PassPeriod(vtkDataObject* from, vtkDataObject* to)
{
  vtkFieldData* data = from->GetFieldData();
  for (int i = 0; data && i < data->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = data->GetArray(i);
    if (array && vtkSPHTellsOfPeriod(array->GetName()))
    {
      to->GetFieldData()->AddArray(array);
    }
  }
}

std::vector<double> CheckedPeriod(const vtkSPHPeriod& found, const std::string& problem)
{
  if (!problem.empty() || found.Period.empty())
  {
    const std::string none = "The field data of the particles give no period: there is no array "
                             "PeriodicBounds, BoxSize, or box with boundaryType.";
    throw std::runtime_error((problem.empty() ? none : problem) + " Give --periodic LX,LY,LZ.");
  }
  return found.Period;
}

std::vector<double> DetectPeriod(vtkDataObject* particles)
{
  return CheckedPeriod(vtkSPHFindPeriod(particles->GetFieldData()), "");
}

std::string HintOfPeriod(vtkDataObject* particles)
{
  const vtkSPHPeriod found = vtkSPHFindPeriod(particles->GetFieldData());
  std::ostringstream hint;
  for (std::size_t i = 0; i < found.Period.size(); ++i)
  {
    hint << (i == 0 ? "the field data array " + Printable(found.Array) + " may be a period (" : ",")
         << found.Period[i];
  }
  hint << (found.Period.empty() ? ""
                                : "), but was not used; --periodic auto uses it, --periodic 0,0,0 "
                                  "confirms that there is none");
  return hint.str();
}

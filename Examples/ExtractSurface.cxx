// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause

// VTK, C++: an isosurface of the speed of a dam break, coloured by the pressure.
//
//   ExtractSurface Data/dam_break_45k.vtp speed.vtp
#include "vtkMarchingCorrectors.h"

#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLPolyDataWriter.h"

#include <iostream>

int main(int argc, char* argv[])
{
  if (argc != 3)
  {
    std::cerr << "usage: " << argv[0] << " PARTICLES.vtp SURFACE.vtp\n";
    return 2;
  }
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName(argv[1]);

  // Smoothing length, mass and density are found by their names.
  vtkNew<vtkMarchingCorrectors> surface;
  surface->SetInputConnection(reader->GetOutputPort());
  surface->SetInputArrayToProcess(
    // a vector is contoured by its magnitude
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  surface->SetValue(0, 1.0);                                       // m/s
  surface->SetFluidArrayName("ParticleType");                      // 0 is fluid, 1 is wall
  surface->SetFluidValue(0.0);

  // The output is a polygon mesh like any other; "Pressure" was interpolated to it.
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputConnection(surface->GetOutputPort());
  writer->SetFileName(argv[2]);
  if (!writer->Write() || *surface->GetErrorMessage())
  {
    return 1;
  }
  vtkPolyData* mesh = surface->GetOutput();
  std::cout << mesh->GetNumberOfPoints() << " points, " << mesh->GetNumberOfCells()
            << " triangles\n";
  return mesh->GetNumberOfCells() > 0 ? 0 : 1;
}

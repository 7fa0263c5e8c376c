// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// A pipeline of reader, filter, mapper and window, whose picture VTK compares with a baseline (-V).
#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkDataObject.h"
#include "vtkLookupTable.h"
#include "vtkMarchingCorrectors.h"
#include "vtkNew.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkTesting.h"
#include "vtkXMLPolyDataReader.h"

#include <cstdlib>
#include <string>

/// Draws a surface of the speed or the free surface: TestImage ARGUMENTS OF VTK'S TESTS...
/// speed|free
int TestImage(int argc, char* argv[])
{
  const bool isFreeSurface = std::string(argv[argc - 1]) == "free";
  vtkNew<vtkTesting> testing;
  testing->AddArguments(argc, argv);
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((std::string(testing->GetDataRoot()) + "/dam_break_45k.vtp").c_str());
  vtkNew<vtkMarchingCorrectors> filter;
  filter->SetInputConnection(reader->GetOutputPort());
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  filter->GenerateValues(5, 0.5, 2.5);
  filter->SetFreeSurface(isFreeSurface);
  filter->SetFluidArrayName("ParticleType");

  vtkNew<vtkLookupTable> colors;
  colors->SetVectorModeToMagnitude();
  colors->SetHueRange(0.67, 0.0);
  colors->SetSaturationRange(0.5, 0.7);
  colors->SetRange(0.0, 3.0);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(filter->GetOutputPort());
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray(isFreeSurface ? "Velocity" : "Velocity_Magnitude");
  mapper->SetLookupTable(colors);
  mapper->UseLookupTableScalarRangeOn();
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetInterpolationToPhong();
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(actor);
  renderer->SetBackground(0.2, 0.2, 0.25);
  renderer->GetActiveCamera()->SetPosition(0.4, 1.5, 3.0);
  renderer->GetActiveCamera()->SetFocalPoint(1.6, 0.3, 0.0);
  renderer->GetActiveCamera()->SetViewUp(0.0, 1.0, 0.0);
  renderer->ResetCamera();
  renderer->GetActiveCamera()->Zoom(1.4);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetSize(500, 300);
  window->AddRenderer(renderer);
  window->Render();
  return vtkRegressionTestImage(window) == vtkTesting::FAILED ? EXIT_FAILURE : EXIT_SUCCESS;
}

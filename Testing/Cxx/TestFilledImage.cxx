// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
// Lines over bands; TestPlane checks the numbers.
#include "TestPlaneParticles.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkLookupTable.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

namespace
{
vtkSmartPointer<vtkActor> MakeActor(vtkPolyData* data)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  return actor;
}
}

int TestFilledImage(int argc, char* argv[])
{
  auto filter = test::MakePlaneFilter();
  filter->SetValue(3, 0.9);
  filter->FilledOn();
  filter->Update();
  vtkNew<vtkLookupTable> colors;
  colors->SetHueRange(0.67, 0.0);
  colors->SetSaturationRange(0.5, 0.7);
  colors->SetRange(0.0, 1.0);
  auto bands = MakeActor(filter->GetOutput());
  vtkMapper* mapper = bands->GetMapper();
  mapper->SetScalarModeToUseCellFieldData();
  mapper->SelectColorArray("BandValue");
  mapper->SetLookupTable(colors);
  mapper->UseLookupTableScalarRangeOn();
  vtkNew<vtkPolyData> lines;
  lines->SetPoints(filter->GetOutput()->GetPoints());
  lines->SetLines(filter->GetOutput()->GetLines());
  auto over = MakeActor(lines);
  over->GetProperty()->SetColor(0.0, 0.0, 0.0);
  over->GetProperty()->SetLineWidth(2.0);
  over->SetPosition(0.0, 0.01, 0.0);
  vtkNew<vtkRenderer> renderer;
  renderer->AddActor(bands);
  renderer->AddActor(over);
  renderer->SetBackground(0.2, 0.2, 0.25);
  vtkCamera* camera = renderer->GetActiveCamera();
  camera->SetPosition(0.0, 5.0, 0.0);
  camera->SetFocalPoint(0.0, 0.5, 0.0);
  camera->SetViewUp(0.0, 0.0, 1.0);
  camera->ParallelProjectionOn();
  renderer->ResetCamera();
  camera->Zoom(1.3);
  vtkNew<vtkRenderWindow> window;
  window->SetMultiSamples(0);
  window->SetSize(300, 300);
  window->AddRenderer(renderer);
  window->Render();
  return vtkRegressionTestImage(window) == vtkTesting::FAILED ? 1 : 0;
}

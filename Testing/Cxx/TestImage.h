// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Draws a surface of the dam break. The numeric sibling of these tests is TestDamBreakNumbers.
 */
#ifndef TestImage_h
#define TestImage_h

#include "TestDamBreak.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkLookupTable.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRegressionTestImage.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"

namespace test
{
/** Draws the surface, colored by an array, and compares with the baseline (-V). */
inline int CompareImage(
  vtkAlgorithm* filter, const char* colorBy, double low, double high, int argc, char* argv[])
{
  vtkNew<vtkLookupTable> colors;
  colors->SetVectorModeToMagnitude();
  colors->SetHueRange(0.67, 0.0);
  colors->SetSaturationRange(0.5, 0.7);
  colors->SetRange(low, high);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(filter->GetOutputPort());
  mapper->SetScalarModeToUsePointFieldData();
  mapper->SelectColorArray(colorBy);
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
  return vtkRegressionTestImage(window) == vtkTesting::FAILED ? 1 : 0;
}
}

#endif

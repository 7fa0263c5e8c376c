// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "SurfacePicture.h"

#include "MessageCapture.h"
#include "OutputFile.h"
#include "Supervisor.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkDataArray.h"
#include "vtkLightKit.h"
#include "vtkNew.h"
#include "vtkOutlineSource.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWindowToImageFilter.h"

#include <stdexcept>

#include <dlfcn.h>

namespace
{

/// A connection to the X server, where this VTK renders through one. X is asked for in the running
/// program, since only VTK's rendering library knows whether it is linked to it. The connection is
/// held until the picture is drawn: a server that loses its last client starts anew (Xvfb does),
/// and does not answer meanwhile.
class DisplayConnection
{
public:
  explicit DisplayConnection(vtkRenderWindow* window)
  {
    if (window->IsA("vtkXOpenGLRenderWindow"))
    {
      const auto open = reinterpret_cast<OpenType>(dlsym(RTLD_DEFAULT, "XOpenDisplay"));
      this->Close = reinterpret_cast<CloseType>(dlsym(RTLD_DEFAULT, "XCloseDisplay"));
      this->Needed = open && this->Close;
      this->Display = this->Needed ? open(nullptr) : nullptr;
    }
  }

  ~DisplayConnection()
  {
    if (this->Display)
    {
      this->Close(this->Display);
    }
  }

  DisplayConnection(const DisplayConnection&) = delete;
  void operator=(const DisplayConnection&) = delete;

  /// True only where it is certain that an X server is needed and cannot be reached.
  bool IsMissing() const { return this->Needed && !this->Display; }

private:
  using OpenType = void* (*)(const char*);
  using CloseType = int (*)(void*);

  bool Needed = false;
  void* Display = nullptr;
  CloseType Close = nullptr;
};

void AddSurface(vtkRenderer* renderer, vtkPolyData* surface)
{
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(surface);
  vtkDataArray* scalars = surface->GetPointData()->GetScalars();
  double range[2] = { 0.0, 0.0 };
  if (scalars && scalars->GetNumberOfTuples() > 0)
  {
    scalars->GetRange(range);
  }
  // The scalars are the iso value: colours tell several surfaces apart, and one needs none.
  mapper->SetScalarVisibility(range[0] < range[1]);
  mapper->SetScalarRange(range);
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.36, 0.60, 0.85);
  actor->GetProperty()->SetSpecular(0.25);
  actor->GetProperty()->SetSpecularPower(30.0);
  renderer->AddActor(actor);
}

void AddOutline(vtkRenderer* renderer, vtkPointSet* particles)
{
  vtkNew<vtkOutlineSource> outline;
  outline->SetBounds(particles->GetBounds());
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputConnection(outline->GetOutputPort());
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(0.45, 0.45, 0.45);
  actor->GetProperty()->LightingOff();
  renderer->AddActor(actor);
}

}

//------------------------------------------------------------------------------
void WritePicture(
  const std::string& file, vtkPolyData* surface, vtkPointSet* particles, MessageCapture* messages)
{
  const Activity drawing(file + " could not be written", "the graphics driver may be at fault");
  messages->Clear();
  vtkNew<vtkRenderWindow> window;
  const DisplayConnection display(window);
  if (display.IsMissing())
  {
    throw std::runtime_error(
      file + " could not be written: rendering needs a display; try xvfb-run -a -s -noreset");
  }
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);
  AddSurface(renderer, surface);
  AddOutline(renderer, particles);
  // A headlight alone leaves what faces sideways nearly black.
  vtkNew<vtkLightKit> lights;
  lights->AddLightsToRenderer(renderer);
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(1280, 800);
  window->AddRenderer(renderer);
  vtkCamera* camera = renderer->GetActiveCamera();
  renderer->ResetCamera();
  camera->Azimuth(-25.0);
  camera->Elevation(22.0);
  renderer->ResetCamera();
  camera->Zoom(1.3);
  window->Render();

  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  image->ReadFrontBufferOff();
  vtkNew<vtkPNGWriter> writer;
  writer->WriteToMemoryOn();
  writer->SetInputConnection(image->GetOutputPort());
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (!bytes || !messages->GetErrors().empty())
  {
    throw std::runtime_error(file + " could not be written" +
      (messages->GetErrors().empty() ? "" : ": " + messages->GetErrors().front()));
  }
  const auto size = static_cast<std::size_t>(bytes->GetNumberOfValues());
  WriteOutput(file, std::string(reinterpret_cast<const char*>(bytes->GetPointer(0)), size));
}

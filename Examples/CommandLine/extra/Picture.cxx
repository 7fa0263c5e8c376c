// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Extra.h"

#include "ColorScale.h"
#include "Failures.h"
#include "Job.h"
#include "Text.h"

#include "vtkActor.h"
#include "vtkBoundingBox.h"
#include "vtkCamera.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataArrayRange.h"
#include "vtkDataSetMapper.h"
#include "vtkFieldData.h"
#include "vtkLightKit.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkOutlineSource.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkScalarBarActor.h"
#include "vtkTextProperty.h"
#include "vtkUnsignedCharArray.h"
#include "vtkVariant.h"
#include "vtkVector.h"
#include "vtkVectorOperators.h"
#include "vtkWindowToImageFilter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <set>

#include <dlfcn.h>

namespace
{

/// Connects to the X server, if this VTK renders through one. The running program is searched for
/// X's functions, because only VTK's rendering library knows whether it is linked to them. The
/// connection is held until the last picture is drawn: a server that loses its last client starts anew
/// (Xvfb does), and does not answer meanwhile. Throws if a server is certainly needed and cannot be
/// reached.
std::shared_ptr<void> Connect(vtkRenderWindow* window, const std::string& file)
{
  const auto open = reinterpret_cast<void* (*)(const char*)>(dlsym(RTLD_DEFAULT, "XOpenDisplay"));
  const auto close = reinterpret_cast<int (*)(void*)>(dlsym(RTLD_DEFAULT, "XCloseDisplay"));
  if (!window->IsA("vtkXOpenGLRenderWindow") || !open || !close)
  {
    return nullptr;
  }
  void* const display = open(nullptr);
  RequireToWrite(display, file, "rendering needs a display; try xvfb-run -a -s -noreset");
  return { display, close };
}

const double WidthOfBar = 0.13; ///< the colour bar's share of the picture's width

using Vector = vtkVector3d;

Vector AxisOf(const std::string& name)
{
  Vector axis(0.0);
  axis[static_cast<int>(std::string("xyz").find(name.back()))] = name[0] == '-' ? -1.0 : 1.0;
  return axis;
}

/// A view: three directions at right angles.
struct View
{
  Vector Right;
  Vector Up;
  Vector ToEye;
};

/// Returns the view from the direction `toEye`. If `toEye` is parallel to `up`, another axis is upwards.
View MakeView(Vector up, Vector toEye)
{
  vtkMath::Normalize(toEye.GetData());
  if (std::abs(up.Dot(toEye)) > 0.999)
  {
    up = { up[1], up[2], up[0] };
  }
  Vector right = up.Cross(toEye);
  vtkMath::Normalize(right.GetData());
  return { right, toEye.Cross(right), toEye };
}

/// Returns a view from the front, a little from above and from the left.
View ObliqueView(const Vector& up)
{
  const Vector right(std::abs(up[1]) + std::abs(up[2]), std::abs(up[0]), 0.0);
  const Vector front = right.Cross(up);
  const double azimuth = vtkMath::RadiansFromDegrees(-25.0);
  const double elevation = vtkMath::RadiansFromDegrees(22.0);
  return MakeView(up,
    std::cos(elevation) * (std::sin(azimuth) * right + std::cos(azimuth) * front) +
      std::sin(elevation) * up);
}

View ViewOfSlice(const Vector& up, int axis)
{
  Vector toEye(0.0);
  toEye[axis] = axis == 1 ? -1.0 : 1.0; // so that z is upwards and x to the right
  return MakeView(axis == 1 && up[1] != 0.0 ? Vector(0.0, 0.0, 1.0) : up, toEye);
}

/// Returns the axis that is constant for lines in a plane; -1: there is none.
int AxisOfLines(vtkDataSet* data)
{
  auto* surface = vtkPolyData::SafeDownCast(data);
  const double* bounds = data->GetBounds();
  for (int a = 2; a >= 0 && surface && surface->GetNumberOfLines() > 0; --a)
  {
    if (bounds[2 * a] == bounds[2 * a + 1])
    {
      return a;
    }
  }
  return -1;
}

/// Places the camera so near that the box's corners just fit into the picture, with a margin of 4 %, and
/// with equal space on opposite sides.
void PlaceCamera(vtkRenderer* renderer, const View& view, const vtkBoundingBox& box, double aspect)
{
  vtkCamera* camera = renderer->GetActiveCamera();
  const double slope = std::tan(vtkMath::RadiansFromDegrees(0.5 * camera->GetViewAngle()));
  const double margin = 1.04;
  Vector center;
  box.GetCenter(center.GetData());
  for (int round = 0; round < 10; ++round)
  {
    std::array<Vector, 8> seen; // corners in the eye's axes: right, up, towards the eye
    double distance = 1e-6 * box.GetDiagonalLength();
    for (int i = 0; i < 8; ++i)
    {
      Vector corner;
      box.GetCorner(i, corner.GetData());
      corner = corner - center;
      Vector& c = seen[static_cast<std::size_t>(i)];
      c = Vector(corner.Dot(view.Right), corner.Dot(view.Up), corner.Dot(view.ToEye));
      distance = std::max(
        distance, c[2] + margin * std::max(std::abs(c[1]), std::abs(c[0]) / aspect) / slope);
    }
    distance = distance > 0.0 ? distance : 1.0; // a single point has no extent
    camera->SetFocalPoint(center.GetData());
    camera->SetPosition((center + distance * view.ToEye).GetData());
    for (int a = 0; a < 2; ++a) // near things look larger, so the middle is not the mean
    {
      double lowest = VTK_DOUBLE_MAX, highest = -VTK_DOUBLE_MAX;
      for (const Vector& c : seen)
      {
        lowest = std::min(lowest, c[a] / (distance - c[2]));
        highest = std::max(highest, c[a] / (distance - c[2]));
      }
      center = center + 0.5 * (lowest + highest) * distance * (a == 0 ? view.Right : view.Up);
    }
  }
  camera->SetViewUp(view.Up.GetData());
  renderer->ResetCameraClippingRange();
}

class Scene
{
public:
  explicit Scene(const PictureOptions& options)
    : Options(options)
    , Display(Connect(this->Window, options.File))
  {
    this->Renderer->SetBackground(1.0, 1.0, 1.0);
    // With a headlight alone, sides that face away would be nearly black.
    vtkNew<vtkLightKit> lights;
    lights->AddLightsToRenderer(this->Renderer);
    this->Window->SetOffScreenRendering(1);
    this->Window->SetMultiSamples(0);
    this->Window->SetSize(Width, Height);
    this->Window->AddRenderer(this->Renderer);
  }

  std::string Draw(const std::string& file, vtkDataSet* data, vtkDataSet* frame,
    const ColorScale& colors, int sliceAxis)
  {
    const Activity drawing(file + " could not be written", "the graphics driver may be at fault");
    Messages() = {};
    const int axis = sliceAxis >= 0 ? sliceAxis : AxisOfLines(data);
    const bool isSlice = axis >= 0;
    this->Show(data, colors, isSlice);
    double bounds[6];
    vtkBoundingBox(frame->GetBounds()).GetBounds(bounds);
    vtkNew<vtkOutlineSource> outline;
    outline->SetBounds(bounds);
    outline->Update();
    this->ShowLines(outline->GetOutput(), 0.45, 1.0, Vector(0.0));
    this->Seen.AddBounds(frame->GetBounds());
    if (data->GetNumberOfPoints() > 0)
    {
      this->Seen.AddBounds(data->GetBounds());
    }
    if (!colors.GetName().empty())
    {
      this->ShowBar(colors, data);
    }
    // Only DualSPHysics writes an array Idp, and in DualSPHysics the z axis points upwards.
    const bool isUpright = frame->GetPointData()->HasArray("Idp");
    const Vector up =
      AxisOf(!this->Options.Up.empty() ? this->Options.Up : isUpright ? "z" : "y");
    const std::vector<double>& given = this->Options.View;
    PlaceCamera(this->Renderer,
      !given.empty() ? MakeView(up, { given[0], given[1], given[2] })
        : isSlice    ? ViewOfSlice(up, axis)
                     : ObliqueView(up),
      this->Seen, (this->HasBar ? 1.0 - WidthOfBar : 1.0) * Width / Height);
    std::string bytes = this->Render();
    RequireToWrite(!bytes.empty() && Messages().Errors.empty(), file, Messages().FirstError());
    return bytes;
  }

private:
  void Show(vtkDataSet* data, const ColorScale& colors, bool isFlat)
  {
    this->Renderer->RemoveAllViewProps();
    vtkNew<vtkDataSetMapper> mapper;
    mapper->SetInputDataObject(data);
    colors.ArrayOf(data) ? mapper->SetScalarModeToUsePointFieldData()
                         : mapper->SetScalarModeToUseCellFieldData();
    const bool isColored = colors.ArrayOf(data) || colors.CellArrayOf(data);
    mapper->SetScalarVisibility(isColored);
    if (isColored)
    {
      mapper->SelectColorArray(colors.GetName().c_str());
      mapper->SetLookupTable(colors.GetTable());
      mapper->UseLookupTableScalarRangeOn();
    }
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(0.45, 0.72, 0.95);
    actor->GetProperty()->SetLighting(!isFlat);
    actor->GetProperty()->SetAmbient(isColored && !isFlat ? 0.3 : 0.0); // shade changes colours
    actor->GetProperty()->SetSpecular(isColored ? 0.0 : 0.4);
    actor->GetProperty()->SetSpecularPower(30.0);
    actor->GetProperty()->SetLineWidth(3.0);
    actor->GetProperty()->SetPointSize(3.0);
    this->Renderer->AddActor(actor);
    if (data->GetCellData()->HasArray("BandValue"))
    {
      this->ShowBorders(vtkPolyData::SafeDownCast(data));
    }
  }

  /// Draws lines in one shade, independent of light.
  void ShowLines(vtkPolyData* lines, double shade, double width, Vector position)
  {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(lines);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->SetPosition(position.GetData());
    actor->GetProperty()->SetColor(shade, shade, shade);
    actor->GetProperty()->SetLineWidth(static_cast<float>(width));
    actor->GetProperty()->LightingOff();
    this->Renderer->AddActor(actor);
  }

  /// Draws the lines between filled regions, on both sides of the plane.
  void ShowBorders(vtkPolyData* filled)
  {
    vtkNew<vtkPolyData> lines;
    lines->SetPoints(filled->GetPoints());
    lines->SetLines(filled->GetLines());
    const double* bounds = filled->GetBounds();
    const double off = 1e-3 * filled->GetLength();
    for (const double side : { -off, off })
    {
      this->ShowLines(lines, 0.1, 2.0,
        { bounds[0] == bounds[1] ? side : 0.0, bounds[2] == bounds[3] ? side : 0.0,
          bounds[4] == bounds[5] ? side : 0.0 });
    }
  }

  /// Makes a legend of a filled region's bands, the lowest one first; null unless bands give the colours.
  static vtkSmartPointer<vtkLookupTable> MakeSteps(const ColorScale& colors, vtkDataSet* data)
  {
    vtkDataArray* bands = colors.CellArrayOf(data);
    vtkDataArray* values = data->GetFieldData()->GetArray("IsoValues");
    if (colors.GetName() != "BandValue" || !bands || !values)
    {
      return nullptr;
    }
    const auto range = vtk::DataArrayValueRange(values);
    const std::set<double> begins(range.begin(), range.end());
    const auto text = [](double value) { return vtkVariant(value).ToString(); };
    auto steps = vtkSmartPointer<vtkLookupTable>::New();
    steps->SetNumberOfTableValues(static_cast<vtkIdType>(begins.size()));
    steps->IndexedLookupOn();
    for (auto at = begins.begin(); at != begins.end(); ++at)
    {
      const auto next = std::next(at);
      const std::string label =
        next == begins.end() ? "above " + text(*at) : text(*at) + " to " + text(*next);
      double color[3];
      colors.GetTable()->GetColor(*at, color);
      steps->SetTableValue(steps->SetAnnotation(*at, label), color[0], color[1], color[2]);
    }
    return steps;
  }

  /// Shows the colour bar beside the picture, in a place of its own.
  void ShowBar(const ColorScale& colors, vtkDataSet* data)
  {
    const vtkSmartPointer<vtkLookupTable> steps = MakeSteps(colors, data);
    this->Renderer->SetViewport(0.0, 0.0, 1.0 - WidthOfBar, 1.0);
    this->Bars->SetViewport(1.0 - WidthOfBar, 0.0, 1.0, 1.0);
    this->Bars->SetBackground(1.0, 1.0, 1.0);
    this->Bars->RemoveAllViewProps();
    vtkNew<vtkScalarBarActor> bar;
    bar->SetLookupTable(steps ? steps.Get() : colors.GetTable());
    bar->SetTitle(colors.GetName().c_str());
    bar->SetNumberOfLabels(6);
    bar->SetVerticalTitleSeparation(14);
    bar->SetLabelFormat("%-.4g");
    bar->SetUnconstrainedFontSize(true);
    bar->SetPosition(0.1, 0.08);
    bar->SetWidth(0.8);
    bar->SetHeight(0.84);
    bar->SetBarRatio(0.25);
    if (steps) // the words of the steps stand beyond the bar's width
    {
      bar->SetTextPositionToPrecedeScalarBar();
      bar->SetPosition(0.16, 0.08);
      bar->SetWidth(0.24);
      bar->SetBarRatio(0.6);
    }
    for (vtkTextProperty* text : { bar->GetLabelTextProperty(), bar->GetTitleTextProperty(),
           bar->GetAnnotationTextProperty() })
    {
      text->SetColor(0.0, 0.0, 0.0);
      text->SetFontSize(steps ? 13 : 15);
      text->ItalicOff();
      text->ShadowOff();
    }
    this->Bars->AddActor2D(bar);
    this->Window->AddRenderer(this->Bars);
    this->HasBar = true;
  }

  std::string Render()
  {
    this->Window->Render();
    vtkNew<vtkWindowToImageFilter> image;
    image->SetInput(this->Window);
    image->ReadFrontBufferOff();
    vtkNew<vtkPNGWriter> writer;
    writer->WriteToMemoryOn();
    writer->SetInputConnection(image->GetOutputPort());
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    return bytes ? std::string(reinterpret_cast<const char*>(bytes->GetPointer(0)),
                     static_cast<std::size_t>(bytes->GetNumberOfValues()))
                 : std::string();
  }

  static constexpr int Width = 1280, Height = 800;
  const PictureOptions& Options;
  vtkBoundingBox Seen;
  vtkNew<vtkRenderWindow> Window;
  const std::shared_ptr<void> Display;
  vtkNew<vtkRenderer> Renderer;
  vtkNew<vtkRenderer> Bars;
  bool HasBar = false;
};

}

Picture NewPicture(const PictureOptions& options)
{
  const Activity drawing(
    options.File + " could not be written", "the graphics driver may be at fault");
  return [scene = std::make_shared<Scene>(options)](const auto&... what)
  { return scene->Draw(what...); };
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * A picture for each way in which the filter draws, named by -M. Testing/Python/mode_images.py draws the
 * same from Python and through the plugin, for the same baselines.
 */
#include "TestImage.h"

#include "vtkPlaneSource.h"
#include "vtkSPHProbe.h"

namespace
{
std::string ModeOf(int argc, char* argv[])
{
  for (int i = 1; i + 1 < argc; ++i)
  {
    if (std::strcmp(argv[i], "-M") == 0)
    {
      return argv[i + 1];
    }
  }
  return "";
}

/** False if there is no such mode. */
bool SetMode(vtkMarchingCorrectors* filter, const std::string& mode)
{
  filter->SetValue(0, 0.7);
  filter->ComputeWeightSumOn();
  if (mode == "Preview")
  {
    filter->PreviewOn();
    filter->SetCubeSizeFactor(2.0);
  }
  else if (mode == "Untrimmed")
  {
    filter->TrimOff();
    filter->SetNodeThreshold(0.001); // up to where the kernels end, so that the picture shows it
  }
  else if (mode == "Wall")
  {
    filter->FreeSurfaceOn();
    filter->SetSolids(vtkMarchingCorrectors::SOLIDS_WALL);
  }
  else if (mode == "Weight")
  {
    filter->SetHScaleFactor(0.75);
  }
  return mode == "Iso" || mode == "Preview" || mode == "Untrimmed" || mode == "Wall" ||
    mode == "Weight";
}

/** The speed on an upright plane along the tank. */
int CompareSlice(int argc, char* argv[])
{
  vtkNew<vtkPlaneSource> plane;
  plane->SetOrigin(0.0, 0.0, 0.1);
  plane->SetPoint1(3.22, 0.0, 0.1);
  plane->SetPoint2(0.0, 1.0, 0.1);
  plane->SetResolution(322, 100);
  vtkNew<vtkSPHProbe> probe;
  probe->SetInputConnection(plane->GetOutputPort());
  probe->SetSourceData(test::ReadDamBreak(argc, argv));
  probe->SetFluidArrayName("ParticleType");
  return test::CompareImage(probe, "Velocity", 0.0, 3.0, argc, argv);
}
}

int TestModesImage(int argc, char* argv[])
{
  const std::string mode = ModeOf(argc, argv);
  if (mode == "Slice")
  {
    return CompareSlice(argc, argv);
  }
  auto filter = test::MakeDamBreakFilter(argc, argv);
  if (!SetMode(filter, mode))
  {
    std::cerr << "There is no mode '" << mode << "'.\n";
    return 1;
  }
  return mode == "Weight" || mode == "Untrimmed"
    ? test::CompareImage(filter, "WeightSum", 0.0, 1.0, argc, argv)
    : test::CompareImage(filter, "Velocity", 0.0, 3.0, argc, argv);
}

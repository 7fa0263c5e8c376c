// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * The dam break of Examples/Data, for tests on real particles.
 */
#ifndef TestDamBreak_h
#define TestDamBreak_h

#include "TestParticles.h"

#include "vtkXMLPolyDataReader.h"

namespace test
{
inline vtkSmartPointer<vtkPolyData> ReadDamBreak(int argc, char* argv[])
{
  std::string folder = ".";
  for (int i = 1; i + 1 < argc; ++i)
  {
    folder = std::strcmp(argv[i], "-D") == 0 ? argv[i + 1] : folder;
  }
  vtkNew<vtkXMLPolyDataReader> reader;
  reader->SetFileName((folder + "/dam_break_45k.vtp").c_str());
  reader->Update();
  return reader->GetOutput();
}

/** Velocity magnitude 1 m/s of the fluid, walls marked as solid. */
inline vtkSmartPointer<vtkMarchingCorrectors> MakeDamBreakFilter(int argc, char* argv[])
{
  auto filter = vtkSmartPointer<vtkMarchingCorrectors>::New();
  filter->SetInputData(ReadDamBreak(argc, argv));
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  filter->SetValue(0, 1.0);
  filter->SetFluidArrayName("ParticleType");
  filter->SetFluidValue(0.0);
  return filter;
}
}

#endif

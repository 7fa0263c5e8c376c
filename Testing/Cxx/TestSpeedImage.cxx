// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "TestImage.h"

int TestSpeedImage(int argc, char* argv[])
{
  auto filter = test::MakeDamBreakFilter(argc, argv);
  filter->GenerateValues(5, 0.5, 2.5);
  return test::CompareImage(filter, "Velocity_Magnitude", 0.0, 3.0, argc, argv);
}

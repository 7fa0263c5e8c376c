// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "TestImage.h"

int TestFreeSurfaceImage(int argc, char* argv[])
{
  auto filter = test::MakeDamBreakFilter(argc, argv);
  filter->FreeSurfaceOn();
  return test::CompareImage(filter, "Velocity", 0.0, 3.0, argc, argv);
}

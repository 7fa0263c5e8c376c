// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "TestImage.h"

int TestSpeedImage(int argc, char* argv[])
{
  auto filter = test::MakeDamBreakFilter(argc, argv);
  return test::CompareImage(filter, "VorticityMagnitude", 0.0, 40.0, argc, argv);
}

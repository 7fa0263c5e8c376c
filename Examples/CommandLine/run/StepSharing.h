// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef StepSharing_h
#define StepSharing_h

#include "ParticleTimes.h"

#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

/// What is different where processes share the steps of a series; as it is, there is one.
struct StepSharing
{
  bool IsFirst = true; ///< the one that writes, and tells

  /// All do this; what one throws, all throw.
  std::function<void(const std::function<void()>&)> OnAll = [](const std::function<void()>& work)
  { work(); };

  void OnFirst(const std::function<void()>& work) const
  {
    this->OnAll(
      [&]
      {
        if (this->IsFirst)
        {
          work();
        }
      });
  }

  /// This process's part of the particles of a time. What one throws, all throw.
  std::function<vtkSmartPointer<vtkPointSet>(
    ParticleTimes& times, double time, std::vector<std::string>& warnings)>
    Read = [](ParticleTimes& times, double time, std::vector<std::string>& warnings)
  { return times.At(time, warnings); };

  /// The whole surface on the first process, null on others.
  std::function<vtkSmartPointer<vtkPolyData>(vtkPolyData* part)> Merge = [](vtkPolyData* part)
  { return part; };
};

#endif

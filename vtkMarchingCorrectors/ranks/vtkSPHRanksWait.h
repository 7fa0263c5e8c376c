// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the project: waits for other ranks, and joins their parts of a surface. MPI's own
 * calls keep a processor busy while they wait, which slows down ranks that compute on it.
 */
#ifndef vtkSPHRanksWait_h
#define vtkSPHRanksWait_h

#include "vtkMPIController.h"
#include "vtkMarchingCorrectorsModule.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <chrono>
#include <thread>

VTK_ABI_NAMESPACE_BEGIN
class vtkPolyData;

/**
 * Joins the parts of a surface on the first process, in the order of GlobalPointIds and
 * GlobalCellIds, and without these two arrays. Returns null on other processes. Collective.
 */
VTKMARCHINGCORRECTORS_EXPORT vtkSmartPointer<vtkPolyData> vtkSPHMergeSurface(
  vtkMultiProcessController* controller, vtkPolyData* part);

/**
 * If this process has no points, gives its particles or surface the arrays that all processes with
 * points have, without values. Collective.
 */
VTKMARCHINGCORRECTORS_EXPORT void vtkSPHMatchEmpty(
  vtkMultiProcessController* controller, vtkPolyData* points);

/**
 * Returns when all ranks have called this function: true if all set `goesOn`. Each message doubles
 * the number of ranks that a rank has heard of.
 */
inline bool vtkSPHAwaitRanks(vtkMPIController* controller, bool goesOn = true)
{
  constexpr int tag = 1719;
  const int rank = controller->GetLocalProcessId(), count = controller->GetNumberOfProcesses();
  for (int step = 1; step < count; step *= 2)
  {
    const int sent = goesOn ? 1 : 0;
    int received;
    vtkMPICommunicator::Request sending, receiving;
    controller->NoBlockReceive(&received, 1, (rank - step + count) % count, tag, receiving);
    controller->NoBlockSend(&sent, 1, (rank + step) % count, tag, sending);
    for (vtkMPICommunicator::Request* request : { &receiving, &sending })
    {
      for (std::chrono::microseconds pause(10); !request->Test(); // asks less and less often
           pause = std::min(2 * pause, std::chrono::microseconds(1000)))
      {
        std::this_thread::sleep_for(pause);
      }
    }
    goesOn = goesOn && received != 0;
  }
  return goesOn;
}
VTK_ABI_NAMESPACE_END

#endif

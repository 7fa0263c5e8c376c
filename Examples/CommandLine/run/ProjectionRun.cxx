// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ProjectionRun.h"

#include "ColorScale.h"
#include "DataSetFile.h"
#include "Extra.h"
#include "Job.h"
#include "MessageCapture.h"
#include "OutputFile.h"
#include "ParticleFile.h"
#include "Picture.h"
#include "SafeText.h"
#include "Sharing.h"
#include "SurfaceRun.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"

#include <iostream>
#include <stdexcept>

namespace
{

void WriteProjection(const Job& job, double seconds, MessageCapture* messages)
{
  for (const std::string& warning : messages->GetWarnings())
  {
    Say("warning: " + warning);
  }
  vtkImageData* image = job.Projection->GetImage();
  vtkDataArray* values = image->GetPointData()->GetScalars();
  if (!values)
  {
    throw std::runtime_error("no particle is seen, so no image was written");
  }
  const int* size = image->GetDimensions();
  if (!job.Quiet)
  {
    std::cout << "image       " << size[0] << " x " << size[1] << " x " << size[2] << " pixels, "
              << Printable(values->GetName()) << " from " << values->GetFiniteRange()[0] << " to "
              << values->GetFiniteRange()[1] << "\nseconds     " << seconds << "\n";
  }
  WriteDataSet(job.Output, image, messages);
  if (!job.Picture.File.empty())
  {
    ColorScale colors(job.Picture);
    colors.SetName(job.Picture.ColorBy.empty() ? values->GetName() : job.Picture.ColorBy);
    colors.Include(image);
    const double* sight = job.Projection->GetDirection();
    const int axis = sight[0] != 0.0 ? 0 : sight[1] != 0.0 ? 1 : 2;
    const auto picture = LoadExtra().NewPicture(job.Picture);
    WriteOutput(job.Picture.File,
      picture->Draw(job.Picture.File, image, image, colors, messages, size[axis] == 1 ? axis : -1));
  }
}

}

void ProjectParticles(const Job& job, MessageCapture* messages, Sharing& sharing)
{
  sharing.OnFirst(
    [&] {
      CheckOutputs(ListFiles(job.InputFiles(), messages), { job.Output, job.Picture.File });
    });
  const vtkSmartPointer<vtkPointSet> particles =
    sharing.Read(job.Inputs.front(), job.Walls, messages);
  double seconds = 0.0;
  sharing.OnAll(
    [&] { job.Projection->SetInputData(SetUpParticles(job.Projection, job, particles)); });
  sharing.OnAll([&] { seconds = Update(job.Projection, job, messages); });
  sharing.OnFirst([&] { WriteProjection(job, seconds, messages); });
}

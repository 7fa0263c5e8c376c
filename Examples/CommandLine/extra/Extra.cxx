// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Extra.h"

#include "FileName.h"
#include "Picture.h"
#ifdef MCOR_HAS_VTKHDF
#include "HdfLinks.h"
#include "HdfSteps.h"
#include "vtkHDFReader.h"
#endif

#include "vtkNew.h"
#include "vtkOBJReader.h"
#include "vtkPLYReader.h"
#include "vtkPolyData.h"
#include "vtkSTLReader.h"

#include <stdexcept>

namespace
{

#ifdef MCOR_HAS_VTKHDF
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t step)
{
  RefuseHdfLinks(file);
  if (const vtkSmartPointer<vtkDataObject> points = ReadHdfPoints(file, step))
  {
    return points;
  }
  vtkNew<vtkHDFReader> reader;
  reader->SetFileName(file.c_str());
  if (!reader->CanReadFile(file.c_str()))
  {
    throw std::runtime_error(file + " cannot be read: its reader does not know what it holds");
  }
  reader->Update();
  return reader->GetOutputDataObject(0);
}

std::vector<double> ListTimes(const std::string& file)
{
  RefuseHdfLinks(file);
  return ListHdfTimes(file);
}
#else
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t)
{
  throw std::runtime_error(file + " cannot be read: this VTK was built without its reader");
}

std::vector<double> ListTimes(const std::string&)
{
  return {};
}
#endif

template <typename ReaderT>
vtkSmartPointer<vtkDataObject> ReadWith(const std::string& file)
{
  vtkNew<ReaderT> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutputDataObject(0);
}

vtkSmartPointer<vtkDataObject> ReadSurface(const std::string& file)
{
  return EndsWith(file, ".stl") ? ReadWith<vtkSTLReader>(file)
    : EndsWith(file, ".ply")    ? ReadWith<vtkPLYReader>(file)
                                : ReadWith<vtkOBJReader>(file);
}

}

const Extra MarchingCorrectorsExtra = { Picture::New, ReadHdf, ListTimes, ReadSurface };

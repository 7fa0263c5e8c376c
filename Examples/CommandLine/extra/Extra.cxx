// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Extra.h"

#include "Text.h"

#include "vtkNew.h"
#include "vtkOBJReader.h"
#include "vtkPLYReader.h"
#include "vtkSTLReader.h"

#include <stdexcept>

#ifndef MCOR_HAS_VTKHDF
vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& file, std::size_t)
{
  throw std::runtime_error(file + " cannot be read: this VTK was built without its reader");
}

std::vector<double> ListHdfTimes(const std::string&)
{
  return {};
}
#endif

namespace
{

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

const Extra MarchingCorrectorsExtra = { NewPicture, ReadHdf, ListHdfTimes, ReadSurface };

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Ending.h"
#include "MessageCapture.h"
#include "OptionValue.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkNew.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataReader.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

namespace
{

/// Field data that are farther from the beginning of a file are not looked at.
constexpr std::streamsize MostHead = 1 << 16;

const char* const Names[] = { "TimeValue", "TIME", "Time", "time" };

/// An empty data set with these field data, as text, in the file's own format: VTK's readers read
/// them alone.
std::string HeadOfXml(const std::string& head)
{
  const std::size_t tag = head.find("<VTKFile"), begin = head.find("<FieldData"),
                    close = head.find("</FieldData>");
  const std::size_t tagEnd = tag == std::string::npos ? tag : head.find('>', tag);
  if (tagEnd == std::string::npos || begin == std::string::npos || close == std::string::npos ||
    begin < tagEnd || close < begin)
  {
    return "";
  }
  std::string file = head.substr(tag, tagEnd + 1 - tag);
  const std::size_t type = file.find("type=");
  const std::size_t typeEnd =
    type == std::string::npos ? type : file.find(file[type + 5], type + 6);
  if (typeEnd == std::string::npos)
  {
    return "";
  }
  file.replace(type, typeEnd + 1 - type, "type=\"PolyData\"");
  return file + "<PolyData>" + head.substr(begin, close - begin) +
    "</FieldData><Piece NumberOfPoints=\"0\"><Points></Points></Piece></PolyData></VTKFile>";
}

std::string HeadOfLegacy(const std::string& head)
{
  const std::size_t set = head.find("\nDATASET "), field = head.find("\nFIELD ", set);
  const std::size_t points = head.find("\nPOINTS ", field);
  if (set == std::string::npos || points == std::string::npos)
  {
    return "";
  }
  return head.substr(0, set) + "\nDATASET POLYDATA" + head.substr(field, points - field) +
    "\nPOINTS 0 float\n";
}

/// The time in an XML file whose field data are at its end: the least and greatest value stand at
/// its beginning.
bool FindRange(const std::string& head, double& time)
{
  for (const char* name : Names)
  {
    const std::size_t at = head.find("Name=\"" + std::string(name) + "\"");
    const std::size_t end = at == std::string::npos ? at : head.find('>', at);
    const std::size_t low = end == std::string::npos ? end : head.find("RangeMin=\"", at);
    if (low < end && end != std::string::npos)
    {
      const std::size_t from = low + 10;
      return ParseNumber(head.substr(from, head.find('"', from) - from), time);
    }
  }
  return false;
}

bool FindTime(vtkDataObject* data, double& time)
{
  for (const char* name : Names)
  {
    vtkDataArray* array = data ? data->GetFieldData()->GetArray(name) : nullptr;
    if (array && array->GetNumberOfValues() == 1 && std::isfinite(array->GetComponent(0, 0)))
    {
      time = array->GetComponent(0, 0);
      return true;
    }
  }
  return false;
}

}

bool ReadTime(const std::string& file, MessageCapture* messages, double& time)
{
  std::string head(static_cast<std::size_t>(MostHead), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(&head[0], MostHead);
  head.resize(static_cast<std::size_t>(stream.gcount()));
  const bool isLegacy = head.compare(0, 5, "# vtk") == 0;
  const std::string text = isLegacy ? HeadOfLegacy(head) : HeadOfXml(head);
  if (text.empty())
  {
    return false;
  }
  const Activity reading("the reader of VTK failed on " + file, "the file may be damaged");
  const Silence silence;
  bool isFound = false;
  try
  {
    CheckDeclaredSizes(file, text);
    if (isLegacy)
    {
      vtkNew<vtkGenericDataObjectReader> reader;
      reader->ReadFromInputStringOn();
      reader->SetBinaryInputString(text.data(), static_cast<int>(text.size()));
      reader->ReadAllFieldsOn();
      reader->Update();
      isFound = FindTime(reader->GetOutput(), time);
    }
    else if (text.find("\"appended\"") == std::string::npos)
    {
      vtkNew<vtkXMLPolyDataReader> reader;
      reader->ReadFromInputStringOn();
      reader->SetInputString(text);
      reader->Update();
      isFound = FindTime(reader->GetOutput(), time);
    }
  }
  catch (const std::exception&)
  {
    // A fault is told where all of the file is read.
  }
  messages->Clear();
  return isFound || FindRange(text, time);
}

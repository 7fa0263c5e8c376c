// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "ParticleFile.h"
#include "Text.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <vector>

namespace
{

/// An array: its label in format 2, the name that it gets, its number of columns, and whether all types
/// of particles have it, or only gas.
struct Known
{
  View Label;
  const char* Name;
  int Columns;
  bool IsOfAll;
};
const Known Arrays[] = { { "POS ", "Points", 3, true }, { "VEL ", "Velocities", 3, true },
  { "ID  ", "ParticleIDs", 1, true }, { "MASS", "Masses", 1, true },
  { "U   ", "InternalEnergy", 1, false }, { "RHO ", "Density", 1, false },
  { "NE  ", "ElectronAbundance", 1, false }, { "NH  ", "NeutralHydrogenAbundance", 1, false },
  { "HSML", "SmoothingLength", 1, false }, { "POT ", "Potential", 1, true },
  { "ACCE", "Acceleration", 3, true } };

constexpr std::size_t HeaderSize = 256;

/// One file of a snapshot: records of Fortran, each between two copies of its number of bytes. In
/// format 2, a record with a label comes before each array; in format 1, the order of the arrays
/// tells their names.
class File
{
public:
  explicit File(const std::string& name)
    : Name(name)
    , Bytes(BytesOf(name))
  {
    const auto first = this->Number<std::uint32_t>(*this->Bytes);
    this->IsSwapped = true;
    const auto other = this->Number<std::uint32_t>(*this->Bytes);
    this->HasLabels = this->Bytes->substr(0, 8).find("HEAD") == 4 && (first == 8 || other == 8);
    this->IsSwapped = this->HasLabels ? other == 8 : other == HeaderSize;
    this->IsGadget = this->HasLabels || this->IsSwapped || first == HeaderSize;
  }

  void ReadHeader()
  {
    View data;
    const bool isEmpty = this->HasLabels && !this->Next(data);
    this->Check(!isEmpty && this->Next(data) && data.size() == HeaderSize, "its header is damaged");
    this->Copy(data, this->Counts, 6, sizeof(std::int32_t));
    this->Copy(data.substr(24), this->Masses, 6, sizeof(double));
    this->Time = this->Number<double>(data.substr(72));
    this->HasCooling = this->Number<std::int32_t>(data.substr(120)) != 0;
    this->Files = this->Number<std::int32_t>(data.substr(124));
    for (int type = 0; type < 6; ++type)
    {
      this->Check(this->Counts[type] >= 0,
        "it claims " + std::to_string(this->Counts[type]) + " particles of a type");
      this->Total += this->Counts[type];
      this->WithMasses += this->Masses[type] == 0.0 ? this->Counts[type] : 0;
    }
  }

  /// Reads the gas, with the arrays listed above; from format 1, only with the arrays up to SmoothingLength.
  vtkSmartPointer<vtkPolyData> ReadGas()
  {
    auto gas = vtkSmartPointer<vtkPolyData>::New();
    std::size_t next = 0; // place in the order of format 1
    View record;
    for (const Known* known = nullptr; this->Next(record);)
    {
      if (this->HasLabels)
      {
        known = std::find_if(std::begin(Arrays), std::end(Arrays),
          [label = record.substr(0, 4)](const Known& each) { return each.Label == label; });
        this->Check(this->Next(record), "it ends before an array");
      }
      else
      {
        next += next == 3 && this->WithMasses == 0 ? 1 : 0;
        next += next == 6 && !this->HasCooling ? 2 : 0;
        known = next < 9 ? &Arrays[next++] : std::end(Arrays);
      }
      if (known != std::end(Arrays))
      {
        this->Take(*known, record, gas);
      }
    }
    this->Check(gas->GetPoints(), "it has no positions");
    if (this->Masses[0] != 0.0)
    {
      const std::vector<double> masses(static_cast<std::size_t>(this->Counts[0]), this->Masses[0]);
      AddNumbers(gas->GetPointData(), "Masses", masses);
    }
    return gas;
  }

  bool IsGadget = false;
  std::int32_t Counts[6] = {}, Files = 1;
  double Time = 0.0;

private:
  void Check(bool isGood, const std::string& why) const { RequireToRead(isGood, this->Name, why); }

  /// Copies numbers, and reverses their bytes if the file's byte order is not this machine's.
  void Copy(View from, void* to, std::size_t count, std::size_t width) const
  {
    from.copy(static_cast<char*>(to), count * width);
    if (this->IsSwapped)
    {
      vtkByteSwap::SwapVoidRange(to, count, width);
    }
  }

  template <typename T>
  T Number(View from) const
  {
    T number = 0;
    this->Copy(from, &number, 1, sizeof(T));
    return number;
  }

  /// Gives the next record, without its two counts. Returns false at the end of the file.
  bool Next(View& record)
  {
    const View rest = this->Bytes->substr(this->At);
    const std::size_t size = this->Number<std::uint32_t>(rest);
    if (rest.empty())
    {
      return false;
    }
    Require(rest.size() >= 8 && size >= 4 && size <= rest.size() - 8,
      vtkSPHSay(MCOR_SAY(FILE_ENDS), this->Name.c_str(), static_cast<long long>(this->At)));
    Require(this->Number<std::uint32_t>(rest.substr(4 + size)) == size,
      vtkSPHSay(MCOR_SAY(RECORD_ENDS), this->Name.c_str(), static_cast<long long>(this->At)));
    record = rest.substr(4, size);
    this->At += 8 + size;
    return true;
  }

  void Take(const Known& known, View record, vtkPolyData* gas)
  {
    const bool isMass = known.Label == "MASS", isId = known.Label == "ID  ";
    const std::int64_t rows = isMass ? this->WithMasses
      : known.IsOfAll                ? this->Total
                                     : this->Counts[0];
    const auto values = static_cast<std::size_t>(rows * known.Columns);
    const std::size_t width = values > 0 ? record.size() / values : 0;
    const bool isGood = width * values == record.size() && (width == 4 || width == 8);
    this->Check(isGood || !known.IsOfAll,
      "its " + std::string(known.Name) + " have " + std::to_string(record.size()) + " bytes for " +
        std::to_string(rows) + " particles");
    if (!isGood || (isMass && this->Masses[0] != 0.0))
    {
      return;
    }
    const int type = isId ? (width == 4 ? VTK_TYPE_UINT32 : VTK_TYPE_INT64)
      : width == 4        ? VTK_FLOAT
                          : VTK_DOUBLE;
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    array->SetNumberOfComponents(known.Columns);
    array->SetNumberOfTuples(this->Counts[0]);
    this->Copy(record, array->GetVoidPointer(0),
      static_cast<std::size_t>(array->GetNumberOfValues()), width);
    array->SetName(known.Name);
    if (&known == Arrays) // this array is the positions
    {
      gas->SetPoints(PointsAt(array)->GetPoints());
      return;
    }
    for (vtkIdType i = 0; known.Label == "HSML" && i < array->GetNumberOfTuples(); ++i)
    {
      array->SetTuple1(i, 0.5 * array->GetTuple1(i));
    }
    gas->GetPointData()->AddArray(array);
  }

  const std::string Name;
  const FileBytes Bytes;
  bool HasLabels = false, IsSwapped = false, HasCooling = false;
  std::size_t At = 0; ///< where the next record begins
  double Masses[6] = {};
  std::int64_t Total = 0, WithMasses = 0;
};

}

bool IsGadget(const std::string& file)
{
  std::error_code error;
  return std::filesystem::is_regular_file(file, error) && File(file).IsGadget;
}

std::vector<double> ListTimesOfGadget(const std::string& name)
{
  File file(name);
  file.ReadHeader();
  return { file.Time };
}

std::vector<std::string> ListGadget(const std::string& name)
{
  File file(name);
  file.ReadHeader();
  const std::size_t dot = name.rfind('.');
  const bool isOne = file.Files <= 1 || dot == std::string::npos ||
    name.find_first_not_of("0123456789", dot + 1) != std::string::npos;
  if (isOne || file.Files > 100000)
  {
    return { name };
  }
  std::vector<std::string> files;
  for (int i = 0; i < file.Files; ++i)
  {
    files.push_back(name.substr(0, dot + 1) + std::to_string(i));
  }
  return files;
}

vtkSmartPointer<vtkDataObject> ReadGadget(const std::string& name, std::size_t)
{
  File file(name);
  file.ReadHeader();
  return file.Counts[0] > 0 ? file.ReadGas() : vtkSmartPointer<vtkPolyData>::New();
}

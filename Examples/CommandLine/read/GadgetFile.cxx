// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "SafeText.h"

#include "vtkByteSwap.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHSay.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace
{

/// An array's names in the formats, its name here, and its number of columns. All types of
/// particles have the first arrays; only gas has the others.
struct Known
{
  const char* Label;
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
/// format 2, a record with a label comes before each array; in format 1, the order tells arrays.
class File
{
public:
  explicit File(const std::string& name)
    : Name(name)
    , Stream(name, std::ios::binary)
    , Size(std::filesystem::file_size(name))
  {
    std::uint32_t first = 0;
    char word[4] = {};
    this->Stream.read(reinterpret_cast<char*>(&first), 4).read(word, 4);
    std::uint32_t other = first;
    vtkByteSwap::SwapVoidRange(&other, 1, 4);
    this->HasLabels = std::memcmp(word, "HEAD", 4) == 0 && (first == 8 || other == 8);
    this->IsSwapped = this->HasLabels ? other == 8 : other == HeaderSize;
    this->IsGadget = this->HasLabels || this->IsSwapped || first == HeaderSize;
    this->Stream.clear();
  }

  void ReadHeader()
  {
    std::array<char, HeaderSize> data;
    std::uint64_t size = 0;
    const bool isEmpty = this->HasLabels && !this->Begin(size);
    if (isEmpty || !this->Begin(size) || size != HeaderSize ||
      !this->Stream.read(data.data(), HeaderSize))
    {
      this->Fail("its header is damaged");
    }
    const auto get = [this, &data](std::size_t at, void* to, std::size_t count, std::size_t width)
    {
      std::memcpy(to, data.data() + at, count * width);
      this->Order(to, count, width);
    };
    get(0, this->Counts, 6, 4);
    get(24, this->Masses, 6, 8);
    get(72, &this->Time, 1, 8);
    get(120, &this->HasCooling, 1, 4);
    get(124, &this->Files, 1, 4);
    for (int type = 0; type < 6; ++type)
    {
      if (this->Counts[type] < 0)
      {
        this->Fail("it claims " + std::to_string(this->Counts[type]) + " particles of a type");
      }
      this->Total += this->Counts[type];
      this->WithMasses += this->Masses[type] == 0.0 ? this->Counts[type] : 0;
    }
  }

  /// Reads the gas, with the arrays that are listed above.
  vtkSmartPointer<vtkPolyData> ReadGas()
  {
    auto gas = vtkSmartPointer<vtkPolyData>::New();
    const vtkIdType count = this->Counts[0];
    std::size_t next = 0; // place in the order of format 1
    std::uint64_t size = 0;
    for (const Known* known = nullptr; this->Begin(size);)
    {
      if (this->HasLabels)
      {
        char label[4] = {};
        this->Stream.read(label, 4);
        const auto found = std::find_if(std::begin(Arrays), std::end(Arrays),
          [&label](const Known& each) { return std::memcmp(each.Label, label, 4) == 0; });
        known = found == std::end(Arrays) ? nullptr : &*found;
        if (!this->Begin(size))
        {
          this->Fail("it ends before an array");
        }
      }
      else
      {
        next += next == 3 && this->WithMasses == 0 ? 1 : 0;
        next += next == 6 && this->HasCooling == 0 ? 2 : 0;
        known = next < 9 ? &Arrays[next++] : nullptr;
      }
      if (known)
      {
        this->Take(*known, size, gas);
      }
    }
    if (!gas->GetPoints())
    {
      this->Fail("it has no positions");
    }
    if (this->Masses[0] != 0.0)
    {
      vtkNew<vtkDoubleArray> masses;
      masses->SetName("Masses");
      masses->SetNumberOfValues(count);
      masses->Fill(this->Masses[0]);
      gas->GetPointData()->AddArray(masses);
    }
    return gas;
  }

  [[noreturn]] void Fail(const std::string& why) const { FailToRead(this->Name, why); }

  bool IsGadget = false;
  std::int32_t Counts[6] = {}, Files = 1;
  double Time = 0.0;

private:
  /// Reverses the bytes of numbers if the file has the other byte order.
  void Order(void* numbers, std::size_t count, std::size_t width) const
  {
    if (this->IsSwapped)
    {
      vtkByteSwap::SwapVoidRange(numbers, count, width);
    }
  }

  std::uint32_t ReadSize()
  {
    std::uint32_t size = 0;
    this->Stream.read(reinterpret_cast<char*>(&size), 4);
    this->Order(&size, 1, 4);
    return size;
  }

  /// Goes to the bytes of the next record. size: becomes their number. Returns false at the end.
  bool Begin(std::uint64_t& size)
  {
    const std::uint64_t at = this->Next;
    if (at == this->Size)
    {
      return false;
    }
    this->Stream.seekg(static_cast<std::streamoff>(at));
    size = this->ReadSize();
    if (!this->Stream || size < 4 || at + 8 + size > this->Size)
    {
      throw std::runtime_error(
        vtkSPHSay(MCOR_SAY(FILE_ENDS), this->Name.c_str(), static_cast<long long>(at)));
    }
    this->Stream.seekg(static_cast<std::streamoff>(at + 4 + size));
    if (this->ReadSize() != size || !this->Stream)
    {
      throw std::runtime_error(
        vtkSPHSay(MCOR_SAY(RECORD_ENDS), this->Name.c_str(), static_cast<long long>(at)));
    }
    this->Stream.seekg(static_cast<std::streamoff>(at + 4));
    this->Next = at + 8 + size;
    return true;
  }

  void Take(const Known& known, std::uint64_t size, vtkPolyData* gas)
  {
    const bool isMass = std::strcmp(known.Label, "MASS") == 0,
               isId = std::strcmp(known.Label, "ID  ") == 0;
    const std::int64_t rows = isMass ? this->WithMasses
      : known.IsOfAll                ? this->Total
                                     : this->Counts[0];
    const auto values = static_cast<std::uint64_t>(rows * known.Columns);
    const std::uint64_t width = values > 0 ? size / values : 0;
    if (width * values != size || (width != 4 && width != 8))
    {
      if (known.IsOfAll && size > 0)
      {
        this->Fail("its " + std::string(known.Name) + " have " + std::to_string(size) +
          " bytes for " + std::to_string(rows) + " particles");
      }
      return;
    }
    if (isMass && this->Masses[0] != 0.0)
    {
      return;
    }
    const int type = isId ? (width == 4 ? VTK_TYPE_UINT32 : VTK_TYPE_INT64)
      : width == 4        ? VTK_FLOAT
                          : VTK_DOUBLE;
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
    array->SetNumberOfComponents(known.Columns);
    array->SetNumberOfTuples(this->Counts[0]);
    const auto count = static_cast<std::size_t>(array->GetNumberOfValues());
    void* to = array->GetVoidPointer(0);
    this->Stream.read(static_cast<char*>(to), static_cast<std::streamsize>(count * width));
    this->Order(to, count, width);
    array->SetName(known.Name);
    if (&known == Arrays) // this array is the positions
    {
      gas->SetPoints(vtkNew<vtkPoints>());
      gas->GetPoints()->SetData(array);
      return;
    }
    for (vtkIdType i = 0; std::strcmp(known.Label, "HSML") == 0 && i < array->GetNumberOfTuples();
         ++i)
    {
      array->SetTuple1(i, 0.5 * array->GetTuple1(i));
    }
    gas->GetPointData()->AddArray(array);
  }

  const std::string Name;
  std::ifstream Stream;
  const std::uint64_t Size;
  bool HasLabels = false, IsSwapped = false;
  std::uint64_t Next = 0; ///< where the next record begins
  double Masses[6] = {};
  std::int32_t HasCooling = 0;
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

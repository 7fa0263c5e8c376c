// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Extra.h"

#include "Formats.h"
#include "Text.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkHDFReader.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTypeInt64Array.h"

#include "vtk_hdf5.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <type_traits>

namespace
{

const long DeepestGroup = 64; ///< a damaged file may have a circle of groups

/// Holds an object of HDF5, and closes it.
struct Handle
{
  const hid_t Id;
  explicit Handle(hid_t id)
    : Id(id)
  {
  }
  Handle(const Handle&) = delete;
  ~Handle()
  {
    if (this->Id >= 0)
    {
      H5Idec_ref(this->Id);
    }
  }
  operator hid_t() const { return this->Id; }
};

herr_t VisitLink(hid_t root, const char* name, const H5L_info_t* link, void* found)
{
  std::string& sentence = *static_cast<std::string*>(found);
  bool liesElsewhere = link->type != H5L_TYPE_HARD && link->type != H5L_TYPE_SOFT;
  const Handle data(link->type == H5L_TYPE_HARD ? H5Oopen(root, name, H5P_DEFAULT) : -1);
  if (data >= 0 && H5Iget_type(data) == H5I_DATASET)
  {
    const Handle list(H5Dget_create_plist(data));
    liesElsewhere = H5Pget_layout(list) == H5D_VIRTUAL || H5Pget_external_count(list) > 0;
  }
  if (liesElsewhere)
  {
    sentence = std::string("its '") + name +
      "' lies in another file, which is not opened; give a file that holds all of its data";
  }
  else if (std::count(name, name + std::strlen(name), '/') > DeepestGroup)
  {
    sentence = "its groups lie too deep in each other; it may be damaged";
  }
  return sentence.empty() ? 0 : 1; // this ends the visit
}

/// Throws std::runtime_error if the file links to other files, which the user has not named, or if its
/// groups lie too deep in each other or cannot be listed.
void RefuseLinks(const std::string& file)
{
  H5open();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle opened(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  std::string found;
  const bool isListed =
    opened < 0 || H5Lvisit(opened, H5_INDEX_NAME, H5_ITER_NATIVE, VisitLink, &found) >= 0;
  RequireToRead(isListed, file, "its groups cannot be listed; it may be damaged");
  RequireToRead(found.empty(), file, found);
}

struct Kind
{
  int Vtk;
  hid_t Hdf;
};

/// Returns the types of VTK and of HDF5 for the numbers of a data set; VTK_VOID if it holds no
/// numbers.
Kind KindOf(hid_t data)
{
  const Kind wholes[] = { { VTK_UNSIGNED_CHAR, H5T_NATIVE_UCHAR },
    { VTK_UNSIGNED_SHORT, H5T_NATIVE_USHORT }, { VTK_UNSIGNED_INT, H5T_NATIVE_UINT },
    { VTK_UNSIGNED_LONG_LONG, H5T_NATIVE_ULLONG }, { VTK_SIGNED_CHAR, H5T_NATIVE_SCHAR },
    { VTK_SHORT, H5T_NATIVE_SHORT }, { VTK_INT, H5T_NATIVE_INT },
    { VTK_LONG_LONG, H5T_NATIVE_LLONG } };
  const Handle type(H5Dget_type(data));
  if (H5Tget_class(type) == H5T_FLOAT)
  {
    return H5Tget_size(type) <= 4 ? Kind{ VTK_FLOAT, H5T_NATIVE_FLOAT }
                                  : Kind{ VTK_DOUBLE, H5T_NATIVE_DOUBLE };
  }
  const Handle native(H5Tget_native_type(type, H5T_DIR_ASCEND));
  const auto whole = std::find_if(std::begin(wholes), std::end(wholes),
    [&native](const Kind& each) { return native >= 0 && H5Tequal(native, each.Hdf) > 0; });
  return whole == std::end(wholes) ? Kind{ VTK_VOID, -1 } : *whole;
}

/// Opens the group VTKHDF of a file, and reads its arrays.
class HdfFile
{
public:
  explicit HdfFile(const std::string& name)
    : Name(name)
    , File(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT))
    , Root(this->File < 0 ? -1 : H5Gopen2(this->File, "VTKHDF", H5P_DEFAULT))
  {
  }

  void Check(bool isGood, const std::string& why) const { RequireToRead(isGood, this->Name, why); }

  bool IsGood() const { return this->Root >= 0; }

  bool Has(const std::string& name) const
  {
    const std::size_t slash = name.rfind('/');
    return (slash == std::string::npos || this->Has(name.substr(0, slash))) &&
      H5Lexists(this->Root, name.c_str(), H5P_DEFAULT) > 0;
  }

  std::string Type() const
  {
    const Handle attribute(H5Aopen(this->Root, "Type", H5P_DEFAULT));
    const Handle type(attribute < 0 ? -1 : H5Aget_type(attribute));
    if (type < 0 || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
      H5Tget_size(type) > 100)
    {
      return "";
    }
    std::string text(H5Tget_size(type), '\0');
    H5Aread(attribute, type, &text[0]);
    return text.substr(0, text.find('\0'));
  }

  /// Reads `count` rows from `first` on, or all rows if `count` is below 0. Returns null if the
  /// array does not hold numbers, or has more than 2 dimensions or 1000 columns. Throws
  /// std::runtime_error if there is no such array, if it has fewer rows, or if it is damaged.
  vtkSmartPointer<vtkDataArray> Read(
    const std::string& name, long long first = 0, long long count = -1) const
  {
    const Handle data(this->Has(name) ? H5Dopen2(this->Root, name.c_str(), H5P_DEFAULT) : -1);
    this->Check(data >= 0, "it has no data set '" + name + "'");
    const Kind kind = KindOf(data);
    const Handle space(H5Dget_space(data));
    hsize_t extent[2] = { 0, 1 };
    const int rank = H5Sget_simple_extent_ndims(space);
    if (kind.Vtk == VTK_VOID || rank < 1 || rank > 2 ||
      H5Sget_simple_extent_dims(space, extent, nullptr) < 0 || extent[1] < 1 || extent[1] > 1000)
    {
      return nullptr;
    }
    const auto rows = static_cast<long long>(extent[0]);
    const long long wanted = count < 0 ? rows : count;
    this->Check(first >= 0 && wanted <= rows && first <= rows - wanted,
      "'" + name + "' has " + std::to_string(rows) + " values, not " + std::to_string(wanted) +
        " from " + std::to_string(first) + " on");
    // The values may be packed 1000 to 1. 16 MB more are accepted, because chunks that were never
    // written take no room in a file.
    const auto size = static_cast<double>(std::filesystem::file_size(this->Name));
    this->Check(
      static_cast<double>(wanted) * static_cast<double>(extent[1]) * 8 <= 16e6 + 1000 * size,
      "'" + name + "' is larger than the file can hold; it may be damaged");
    auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(kind.Vtk));
    array->SetNumberOfComponents(static_cast<int>(extent[1]));
    array->SetNumberOfTuples(wanted);
    const hsize_t start[2] = { static_cast<hsize_t>(first), 0 },
                  part[2] = { static_cast<hsize_t>(wanted), extent[1] };
    const Handle memory(H5Screate_simple(rank, part, nullptr));
    this->Check(wanted == 0 ||
        (H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, part, nullptr) >= 0 &&
          H5Dread(data, kind.Hdf, memory, space, H5P_DEFAULT, array->GetVoidPointer(0)) >= 0),
      "'" + name + "' is damaged");
    return array;
  }

  /// Reads all values of an array as values of ArrayT. Throws if ArrayT holds integers, but the array in the
  /// file holds floating-point numbers.
  template <typename ArrayT>
  std::vector<typename ArrayT::ValueType> Values(const std::string& name) const
  {
    const vtkSmartPointer<vtkDataArray> read = this->Read(name);
    const bool isWhole =
      read && read->GetDataType() != VTK_FLOAT && read->GetDataType() != VTK_DOUBLE;
    this->Check(isWhole || std::is_floating_point<typename ArrayT::ValueType>::value,
      "'" + name + "' does not hold whole numbers");
    vtkNew<ArrayT> values;
    values->DeepCopy(read);
    return { values->GetPointer(0), values->GetPointer(0) + values->GetNumberOfValues() };
  }

  std::vector<std::string> Names(const char* group) const
  {
    std::vector<std::string> names;
    const Handle opened(this->Has(group) ? H5Gopen2(this->Root, group, H5P_DEFAULT) : -1);
    const auto add = [](hid_t parent, const char* name, const H5L_info_t*, void* found) -> herr_t
    {
      const Handle object(H5Oopen(parent, name, H5P_DEFAULT));
      if (object >= 0 && H5Iget_type(object) == H5I_DATASET)
      {
        static_cast<std::vector<std::string>*>(found)->emplace_back(name);
      }
      return 0;
    };
    H5Literate(opened, H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names);
    return names;
  }

private:
  const std::string Name;
  const Handle File, Root;
};

}

std::vector<double> ListHdfTimes(const std::string& name)
{
  RefuseLinks(name);
  const HdfFile file(name);
  return file.IsGood() && file.Has("Steps/Values") ? file.Values<vtkDoubleArray>("Steps/Values")
                                                   : std::vector<double>();
}

vtkSmartPointer<vtkDataObject> ReadHdf(const std::string& name, std::size_t step)
{
  RefuseLinks(name);
  const HdfFile file(name);
  const std::string type = file.IsGood() ? file.Type() : "";
  const bool hasSteps = file.IsGood() && file.Has("Steps");
  file.Check(step == 0 || hasSteps, "it has no step " + std::to_string(step));
  if (type != "PolyData" && (type != "UnstructuredGrid" || !hasSteps))
  {
    vtkNew<vtkHDFReader> reader; // this reader reads cells, too
    reader->SetFileName(name.c_str());
    file.Check(reader->CanReadFile(name.c_str()) != 0, "its reader does not know what it holds");
    reader->Update();
    return reader->GetOutputDataObject(0);
  }
  std::vector<vtkTypeInt64> parts = file.Values<vtkTypeInt64Array>("NumberOfPoints");
  long long offset = 0;
  const auto of = [&file, step](const std::string& list)
  {
    const std::vector<vtkTypeInt64> numbers = file.Values<vtkTypeInt64Array>(list);
    file.Check(
      step < numbers.size(), "it has no step " + std::to_string(step) + " in '" + list + "'");
    return numbers[step];
  };
  if (hasSteps)
  {
    const long long first = of("Steps/PartOffsets");
    const long long count = file.Has("Steps/NumberOfParts") ? of("Steps/NumberOfParts") : 1;
    offset = of("Steps/PointOffsets");
    const auto all = static_cast<long long>(parts.size());
    file.Check(first >= 0 && count >= 0 && count <= all && first <= all - count,
      "it has no parts " + std::to_string(first) + " to " + std::to_string(first + count) +
        " of step " + std::to_string(step));
    parts = { parts.begin() + first, parts.begin() + first + count };
  }
  long long total = 0;
  for (const long long count : parts)
  {
    total = count < 0 || total > VTK_INT_MAX ? VTK_INT_MAX : total + count;
  }
  const vtkSmartPointer<vtkDataArray> places = file.Read("Points", offset, total);
  file.Check(places && places->GetNumberOfComponents() == 3, "its 'Points' are no positions");
  const vtkSmartPointer<vtkPolyData> data = PointsAt(places);
  for (const std::string& array : file.Names("PointData"))
  {
    const std::string own = "Steps/PointDataOffsets/" + array;
    const long long begin = hasSteps && file.Has(own) ? of(own) : offset;
    if (const vtkSmartPointer<vtkDataArray> values = file.Read("PointData/" + array, begin, total))
    {
      values->SetName(array.c_str());
      data->GetPointData()->AddArray(values);
    }
  }
  return data;
}

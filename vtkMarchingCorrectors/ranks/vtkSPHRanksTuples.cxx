// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksTuples.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkVariant.h"

#include <cstring>
#include <numeric>
#include <string>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
vtkSmartPointer<vtkAbstractArray> MakeLike(vtkAbstractArray* array, vtkIdType count)
{
  auto made =
    vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(array->GetDataType()));
  made->SetName(array->GetName());
  made->SetNumberOfComponents(array->GetNumberOfComponents());
  made->CopyComponentNames(array);
  made->SetNumberOfTuples(count);
  return made;
}

std::size_t TupleSize(vtkAbstractArray* array)
{
  return static_cast<std::size_t>(array->GetDataTypeSize()) *
    static_cast<std::size_t>(array->GetNumberOfComponents());
}

/** Whether the values lie side by side, as bytes. */
bool IsPlain(vtkAbstractArray* array)
{
  return array->GetDataType() != VTK_STRING && array->GetDataType() != VTK_BIT;
}

/** Copies tuples of a size that the compiler knows, which is several times as fast. */
template <std::size_t Size>
void CopyTuples(const char* values, const std::vector<vtkIdType>& ids, char* to)
{
  for (const vtkIdType id : ids)
  {
    std::memcpy(to, values + static_cast<std::size_t>(id) * Size, Size);
    to += Size;
  }
}

void PutPlain(diy::MemoryBuffer& bytes, vtkAbstractArray* array, const std::vector<vtkIdType>& ids)
{
  const std::size_t size = TupleSize(array);
  bytes.buffer.resize(bytes.position + ids.size() * size);
  char* to = bytes.buffer.data() + bytes.position;
  bytes.position = bytes.buffer.size();
  const auto* values = static_cast<const char*>(array->GetVoidPointer(0));
  switch (size)
  {
    case 4:
      return CopyTuples<4>(values, ids, to);
    case 8:
      return CopyTuples<8>(values, ids, to);
    case 12:
      return CopyTuples<12>(values, ids, to);
    default:
      break;
  }
  for (const vtkIdType id : ids)
  {
    std::memcpy(to, values + static_cast<std::size_t>(id) * size, size);
    to += size;
  }
}

/** Writes values that are not plain as texts. */
void PutTexts(diy::MemoryBuffer& bytes, vtkAbstractArray* array, const std::vector<vtkIdType>& ids)
{
  const int components = array->GetNumberOfComponents();
  for (const vtkIdType id : ids)
  {
    for (int c = 0; c < components; ++c)
    {
      diy::save(
        bytes, static_cast<std::string>(array->GetVariantValue(id * components + c).ToString()));
    }
  }
}

void GetTuples(diy::MemoryBuffer& bytes, vtkAbstractArray* array, vtkIdType first, vtkIdType count)
{
  if (IsPlain(array))
  {
    const std::size_t size = TupleSize(array);
    bytes.load_binary(
      static_cast<char*>(array->GetVoidPointer(0)) + static_cast<std::size_t>(first) * size,
      static_cast<std::size_t>(count) * size);
    return;
  }
  const int components = array->GetNumberOfComponents();
  for (vtkIdType i = first * components; i < (first + count) * components; ++i)
  {
    std::string text;
    diy::load(bytes, text);
    array->SetVariantValue(i, vtkVariant(text));
  }
}

/** Packs the message for a rank: the number of tuples, then the tuples; empty if there are none. */
std::vector<char> Pack(const vtkSPHRanksArrays& arrays, const std::vector<vtkIdType>& ids)
{
  diy::MemoryBuffer bytes;
  if (ids.empty())
  {
    return bytes.buffer;
  }
  std::size_t size = sizeof(vtkIdType); // at least
  for (const vtkSmartPointer<vtkAbstractArray>& array : arrays)
  {
    size += IsPlain(array) ? ids.size() * TupleSize(array) : 0;
  }
  bytes.reserve(size);
  diy::save(bytes, static_cast<vtkIdType>(ids.size()));
  for (const vtkSmartPointer<vtkAbstractArray>& array : arrays)
  {
    IsPlain(array) ? PutPlain(bytes, array, ids) : PutTexts(bytes, array, ids);
  }
  return std::move(bytes.buffer);
}
}

namespace
{
/** Returns the array, or a copy whose values lie side by side. */
vtkSmartPointer<vtkAbstractArray> AsPlain(vtkAbstractArray* array)
{
  if (array->HasStandardMemoryLayout())
  {
    return array;
  }
  vtkSmartPointer<vtkAbstractArray> copy = MakeLike(array, 0);
  copy->DeepCopy(array);
  return copy;
}
}

vtkSPHRanksArrays vtkSPHListArrays(vtkPointData* data)
{
  vtkSPHRanksArrays arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    arrays.push_back(AsPlain(data->GetAbstractArray(i)));
  }
  return arrays;
}

vtkSPHRanksArrays vtkSPHListArrays(vtkPolyData* points)
{
  vtkSPHRanksArrays arrays = vtkSPHListArrays(points->GetPointData());
  arrays.insert(arrays.begin(), AsPlain(points->GetPoints()->GetData()));
  return arrays;
}

vtkSmartPointer<vtkPolyData> vtkSPHMakePoints(const vtkSPHRanksArrays& arrays, vtkPolyData* like)
{
  auto made = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetData(vtkDataArray::SafeDownCast(arrays[0]));
  made->SetPoints(points);
  for (int i = 0; i + 1 < static_cast<int>(arrays.size()); ++i)
  {
    const int at = made->GetPointData()->AddArray(arrays[static_cast<std::size_t>(i) + 1]);
    const int attribute = like->GetPointData()->IsArrayAnAttribute(i);
    if (attribute >= 0)
    {
      made->GetPointData()->SetActiveAttribute(at, attribute);
    }
  }
  return made;
}

vtkSPHRanksArrays vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& to, std::vector<vtkIdType>* from)
{
  std::vector<std::vector<char>> messages;
  for (const std::vector<vtkIdType>& ids : to)
  {
    messages.push_back(Pack(arrays, ids));
  }
  messages = ranks.Exchange(std::move(messages));
  std::vector<vtkIdType> counts(messages.size(), 0);
  std::vector<diy::MemoryBuffer> received(messages.size());
  for (std::size_t rank = 0; rank < messages.size(); ++rank)
  {
    received[rank].buffer.swap(messages[rank]);
    if (!received[rank].empty())
    {
      diy::load(received[rank], counts[rank]);
    }
  }
  const vtkIdType total = std::accumulate(counts.begin(), counts.end(), vtkIdType(0));
  vtkSPHRanksArrays came;
  for (const vtkSmartPointer<vtkAbstractArray>& array : arrays)
  {
    came.push_back(MakeLike(array, total));
    vtkIdType first = 0;
    for (std::size_t rank = 0; rank < received.size(); first += counts[rank++])
    {
      if (counts[rank] > 0)
      {
        GetTuples(received[rank], came.back(), first, counts[rank]);
      }
    }
  }
  if (from)
  {
    from->swap(counts);
  }
  return came;
}

vtkSPHRanksArrays vtkSPHReturnTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const vtkSPHRanksLists& back, const vtkSPHRanksLists& home, vtkIdType homeCount)
{
  vtkNew<vtkIdList> places, order;
  for (const std::vector<vtkIdType>& ids : home)
  {
    for (const vtkIdType id : ids)
    {
      order->InsertNextId(places->InsertNextId(id));
    }
  }
  vtkSPHRanksArrays returned;
  for (const vtkSmartPointer<vtkAbstractArray>& came : vtkSPHSendTuples(ranks, arrays, back))
  {
    returned.push_back(MakeLike(came, homeCount));
    if (auto* numbers = vtkArrayDownCast<vtkDataArray>(returned.back().Get()))
    {
      numbers->Fill(0.0);
    }
    returned.back()->InsertTuples(places, order, came);
  }
  return returned;
}
VTK_ABI_NAMESPACE_END

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksTuples.h"

#include "vtkAbstractArray.h"
#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHRanksBytes.h"
#include "vtkVariant.h"

#include <cstring>
#include <utility>

namespace
{
using Bytes = vtkSPHRanks::Bytes;

std::size_t TupleSize(vtkAbstractArray* array)
{
  return static_cast<std::size_t>(array->GetDataTypeSize()) *
    static_cast<std::size_t>(array->GetNumberOfComponents());
}

/** Whether values lie in bytes of their own, side by side. */
bool IsPlain(vtkAbstractArray* array)
{
  return array->GetDataType() != VTK_STRING && array->GetDataType() != VTK_BIT;
}

/** Of a size that is known early: several times as fast. */
template <std::size_t Size>
void CopyTuples(const char* values, const std::vector<vtkIdType>& ids, char* to)
{
  for (const vtkIdType id : ids)
  {
    std::memcpy(to, values + static_cast<std::size_t>(id) * Size, Size);
    to += Size;
  }
}

void PutTuples(Bytes& bytes, vtkAbstractArray* array, const std::vector<vtkIdType>& ids)
{
  if (IsPlain(array))
  {
    const std::size_t size = TupleSize(array), old = bytes.size();
    bytes.resize(old + ids.size() * size);
    char* to = bytes.data() + old;
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
    return;
  }
  const int components = array->GetNumberOfComponents();
  for (const vtkIdType id : ids)
  {
    for (int c = 0; c < components; ++c)
    {
      vtkSPHPutText(bytes, array->GetVariantValue(id * components + c).ToString());
    }
  }
}

void GetTuples(vtkSPHRanksReader& reader, vtkAbstractArray* array, vtkIdType first, vtkIdType count)
{
  if (IsPlain(array))
  {
    const std::size_t size = TupleSize(array);
    auto* values = static_cast<char*>(array->GetVoidPointer(0));
    reader.GetBytes(
      values + static_cast<std::size_t>(first) * size, static_cast<std::size_t>(count) * size);
    return;
  }
  const int components = array->GetNumberOfComponents();
  for (vtkIdType i = first * components; i < (first + count) * components; ++i)
  {
    array->SetVariantValue(i, vtkVariant(reader.GetText()));
  }
}

/** At least; of a message with so many tuples. */
std::size_t CountBytes(const vtkSPHRanksArrays& arrays, std::size_t count)
{
  std::size_t bytes = sizeof(std::int64_t);
  for (vtkAbstractArray* array : arrays)
  {
    bytes += IsPlain(array) ? count * TupleSize(array) : 0;
  }
  return bytes;
}
}

vtkSPHRanksArrays vtkSPHListArrays(vtkPointData* data)
{
  vtkSPHRanksArrays arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    arrays.push_back(data->GetAbstractArray(i));
  }
  return arrays;
}

vtkSPHRanksArrays vtkSPHListArrays(vtkPolyData* particles)
{
  vtkSPHRanksArrays arrays = vtkSPHListArrays(particles->GetPointData());
  arrays.insert(arrays.begin(), particles->GetPoints()->GetData());
  return arrays;
}

std::vector<Bytes> vtkSPHSendTuples(vtkSPHRanks& ranks, const vtkSPHRanksArrays& arrays,
  const std::vector<std::vector<vtkIdType>>& to)
{
  std::vector<Bytes> messages(to.size());
  for (std::size_t rank = 0; rank < to.size(); ++rank)
  {
    if (!to[rank].empty())
    {
      messages[rank].reserve(CountBytes(arrays, to[rank].size()));
      vtkSPHPutNumber(messages[rank], static_cast<std::int64_t>(to[rank].size()));
      for (vtkAbstractArray* array : arrays)
      {
        PutTuples(messages[rank], array, to[rank]);
      }
    }
  }
  return ranks.Exchange(std::move(messages));
}

std::vector<vtkIdType> vtkSPHCountTuples(const std::vector<Bytes>& received)
{
  std::vector<vtkIdType> counts;
  for (const Bytes& message : received)
  {
    counts.push_back(
      message.empty() ? 0 : static_cast<vtkIdType>(vtkSPHRanksReader(message).GetNumber()));
  }
  return counts;
}

void vtkSPHReceiveTuples(const std::vector<Bytes>& received, const vtkSPHRanksArrays& arrays)
{
  vtkIdType first = 0;
  for (const Bytes& message : received)
  {
    if (!message.empty())
    {
      vtkSPHRanksReader reader(message);
      const auto count = static_cast<vtkIdType>(reader.GetNumber());
      for (vtkAbstractArray* array : arrays)
      {
        GetTuples(reader, array, first, count);
      }
      first += count;
    }
  }
}

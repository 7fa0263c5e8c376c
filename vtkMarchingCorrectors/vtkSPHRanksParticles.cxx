// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHRanksParticles.h"

#include "vtkAbstractArray.h"
#include "vtkBitArray.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSPHParticles.h"
#include "vtkSPHRanks.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>

namespace
{
using Bytes = vtkSPHRanks::Bytes;

void PutBytes(Bytes& bytes, const void* data, std::size_t size)
{
  const auto* first = static_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

void PutNumber(Bytes& bytes, std::int64_t number)
{
  PutBytes(bytes, &number, sizeof(number));
}

void PutText(Bytes& bytes, const std::string& text)
{
  PutNumber(bytes, static_cast<std::int64_t>(text.size()));
  PutBytes(bytes, text.data(), text.size());
}

/** Reads what was put; both sides are of one program. */
class Reader
{
public:
  explicit Reader(const Bytes& bytes)
    : At(bytes.data())
  {
  }

  void GetBytes(void* to, std::size_t size)
  {
    std::copy(this->At, this->At + size, static_cast<char*>(to));
    this->At += size;
  }

  std::int64_t GetNumber()
  {
    std::int64_t number;
    this->GetBytes(&number, sizeof(number));
    return number;
  }

  std::string GetText()
  {
    std::string text(static_cast<std::size_t>(this->GetNumber()), '\0');
    this->GetBytes(&text[0], text.size());
    return text;
  }

private:
  const char* At;
};

/** What a point array is, but for its values. */
struct Form
{
  std::string Name;
  int Type;
  int Attribute; // of vtkDataSetAttributes, or -1
  std::vector<std::string> Components;
  bool HasLabels;

  bool IsLike(const Form& other) const
  {
    return this->Name == other.Name && this->Type == other.Type &&
      this->Components.size() == other.Components.size();
  }

  bool operator==(const Form& other) const
  {
    return this->IsLike(other) && this->Attribute == other.Attribute &&
      this->HasLabels == other.HasLabels && this->Components == other.Components;
  }
};

struct Layout
{
  std::int64_t Points = 0;
  std::int64_t IsDouble = 0;
  std::vector<Form> Forms;
};

Layout DescribeArrays(vtkPointData* arrays, vtkIdType count)
{
  Layout layout;
  layout.Points = count;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkAbstractArray* array = arrays->GetAbstractArray(i);
    const std::string name = array->GetName() ? array->GetName() : "";
    const bool isKnown =
      vtkArrayDownCast<vtkDataArray>(array) || array->GetDataType() == VTK_STRING;
    if (isKnown && !name.empty() && name != vtkDataSetAttributes::GhostArrayName() &&
      array->GetNumberOfTuples() == layout.Points)
    {
      Form form = { name, array->GetDataType(), arrays->IsArrayAnAttribute(i), {},
        array->HasAComponentName() };
      for (int c = 0; c < array->GetNumberOfComponents(); ++c)
      {
        const char* label = array->GetComponentName(c);
        form.Components.emplace_back(label ? label : "");
      }
      layout.Forms.push_back(form);
    }
  }
  return layout;
}

Layout Describe(vtkPolyData* particles)
{
  Layout layout = DescribeArrays(particles->GetPointData(), particles->GetNumberOfPoints());
  layout.IsDouble = particles->GetPoints() && particles->GetPoints()->GetDataType() != VTK_FLOAT;
  return layout;
}

Bytes Pack(const Layout& layout)
{
  Bytes bytes;
  PutNumber(bytes, layout.Points);
  PutNumber(bytes, layout.IsDouble);
  PutNumber(bytes, static_cast<std::int64_t>(layout.Forms.size()));
  for (const Form& form : layout.Forms)
  {
    PutText(bytes, form.Name);
    PutNumber(bytes, form.Type);
    PutNumber(bytes, form.Attribute);
    PutNumber(bytes, form.HasLabels);
    PutNumber(bytes, static_cast<std::int64_t>(form.Components.size()));
    for (const std::string& label : form.Components)
    {
      PutText(bytes, label);
    }
  }
  return bytes;
}

Layout Unpack(const Bytes& bytes)
{
  Reader reader(bytes);
  Layout layout;
  layout.Points = reader.GetNumber();
  layout.IsDouble = reader.GetNumber();
  layout.Forms.resize(static_cast<std::size_t>(reader.GetNumber()));
  for (Form& form : layout.Forms)
  {
    form.Name = reader.GetText();
    form.Type = static_cast<int>(reader.GetNumber());
    form.Attribute = static_cast<int>(reader.GetNumber());
    form.HasLabels = reader.GetNumber() != 0;
    form.Components.resize(static_cast<std::size_t>(reader.GetNumber()));
    for (std::string& label : form.Components)
    {
      label = reader.GetText();
    }
  }
  return layout;
}

/** What all ranks that have particles have. */
Layout AgreeOnLayout(vtkSPHRanks& ranks, const Layout& mine)
{
  Layout common;
  for (const Bytes& bytes : ranks.Gather(Pack(mine)))
  {
    const Layout other = Unpack(bytes);
    if (other.Points == 0)
    {
      continue;
    }
    if (common.Points == 0)
    {
      common.Forms = other.Forms;
    }
    common.Points += other.Points;
    common.IsDouble = common.IsDouble || other.IsDouble;
    const auto isMissing = [&other](const Form& form)
    {
      return std::none_of(other.Forms.begin(), other.Forms.end(),
        [&form](const Form& theirs) { return form.IsLike(theirs); });
    };
    common.Forms.erase(
      std::remove_if(common.Forms.begin(), common.Forms.end(), isMissing), common.Forms.end());
  }
  return common;
}

vtkSmartPointer<vtkAbstractArray> MakeArray(const Form& form, vtkIdType count)
{
  auto array = vtkSmartPointer<vtkAbstractArray>::Take(vtkAbstractArray::CreateArray(form.Type));
  const int components = static_cast<int>(form.Components.size());
  array->SetName(form.Name.c_str());
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(count);
  for (int c = 0; form.HasLabels && c < components; ++c)
  {
    array->SetComponentName(c, form.Components[static_cast<std::size_t>(c)].c_str());
  }
  return array;
}

/** Without values yet. */
void AddArrays(vtkPointData* data, const Layout& layout, vtkIdType count)
{
  for (const Form& form : layout.Forms)
  {
    const int at = data->AddArray(MakeArray(form, count));
    if (form.Attribute >= 0)
    {
      data->SetActiveAttribute(at, form.Attribute);
    }
  }
}

vtkSmartPointer<vtkPolyData> MakeParticles(const Layout& layout, vtkIdType count)
{
  auto particles = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT);
  points->SetNumberOfPoints(count);
  particles->SetPoints(points);
  AddArrays(particles->GetPointData(), layout, count);
  return particles;
}

/** Whether it can travel as it is. */
bool LiesPlain(vtkAbstractArray* array)
{
  const auto* numbers = vtkArrayDownCast<vtkDataArray>(array);
  return !numbers || numbers->HasStandardMemoryLayout();
}

/** The particles themselves, where they have these arrays and lie as the others will; else null. */
vtkSmartPointer<vtkPolyData> ShareParticles(const Layout& layout, vtkPolyData* particles)
{
  const Layout own = Describe(particles);
  if (own.Points == 0 || own.Forms != layout.Forms)
  {
    return nullptr;
  }
  vtkDataArray* positions = particles->GetPoints()->GetData();
  bool isPlain = positions->GetDataType() == (layout.IsDouble ? VTK_DOUBLE : VTK_FLOAT) &&
    LiesPlain(positions);
  for (const Form& form : layout.Forms)
  {
    isPlain =
      isPlain && LiesPlain(particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
  }
  if (!isPlain)
  {
    return nullptr;
  }
  auto shared = vtkSmartPointer<vtkPolyData>::New();
  shared->SetPoints(particles->GetPoints());
  for (const Form& form : layout.Forms)
  {
    const int at = shared->GetPointData()->AddArray(
      particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
    if (form.Attribute >= 0)
    {
      shared->GetPointData()->SetActiveAttribute(at, form.Attribute);
    }
  }
  return shared;
}

bool HasDuplicates(vtkPointSet* data)
{
  vtkUnsignedCharArray* marks = data ? data->GetPointGhostArray() : nullptr;
  const vtkIdType count = marks ? marks->GetNumberOfTuples() : 0;
  vtkIdType i = 0;
  while (i < count && !(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
  {
    ++i;
  }
  return i < count;
}

vtkSmartPointer<vtkIdList> ListOwn(vtkPointSet* data)
{
  auto own = vtkSmartPointer<vtkIdList>::New();
  const vtkIdType count = data ? data->GetNumberOfPoints() : 0;
  vtkUnsignedCharArray* marks = count > 0 ? data->GetPointGhostArray() : nullptr;
  own->Allocate(count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    if (!marks || !(marks->GetValue(i) & vtkDataSetAttributes::DUPLICATEPOINT))
    {
      own->InsertNextId(i);
    }
  }
  return own;
}

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
      PutText(bytes, array->GetVariantValue(id * components + c).ToString());
    }
  }
}

void GetTuples(Reader& reader, vtkAbstractArray* array, vtkIdType first, vtkIdType count)
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

using Arrays = std::vector<vtkAbstractArray*>;

Arrays ListArrays(vtkPointData* data)
{
  Arrays arrays;
  for (int i = 0; i < data->GetNumberOfArrays(); ++i)
  {
    arrays.push_back(data->GetAbstractArray(i));
  }
  return arrays;
}

/** The positions, then the point arrays. */
Arrays ListArrays(vtkPolyData* particles)
{
  Arrays arrays = ListArrays(particles->GetPointData());
  arrays.insert(arrays.begin(), particles->GetPoints()->GetData());
  return arrays;
}

/** At least; of a message with so many tuples. */
std::size_t CountBytes(const Arrays& arrays, std::size_t count)
{
  std::size_t bytes = sizeof(std::int64_t);
  for (vtkAbstractArray* array : arrays)
  {
    bytes += IsPlain(array) ? count * TupleSize(array) : 0;
  }
  return bytes;
}

/** Number i of the result came from rank i. */
std::vector<Bytes> SendTuples(
  vtkSPHRanks& ranks, const Arrays& arrays, const std::vector<std::vector<vtkIdType>>& to)
{
  std::vector<Bytes> messages(to.size());
  for (std::size_t rank = 0; rank < to.size(); ++rank)
  {
    if (!to[rank].empty())
    {
      messages[rank].reserve(CountBytes(arrays, to[rank].size()));
      PutNumber(messages[rank], static_cast<std::int64_t>(to[rank].size()));
      for (vtkAbstractArray* array : arrays)
      {
        PutTuples(messages[rank], array, to[rank]);
      }
    }
  }
  return ranks.Exchange(std::move(messages));
}

/** How many tuples came from each rank. */
std::vector<vtkIdType> CountTuples(const std::vector<Bytes>& received)
{
  std::vector<vtkIdType> counts;
  for (const Bytes& message : received)
  {
    counts.push_back(message.empty() ? 0 : static_cast<vtkIdType>(Reader(message).GetNumber()));
  }
  return counts;
}

/** To arrays that are as long as all of them together. */
void ReceiveTuples(const std::vector<Bytes>& received, const Arrays& arrays)
{
  vtkIdType first = 0;
  for (const Bytes& message : received)
  {
    if (!message.empty())
    {
      Reader reader(message);
      const auto count = static_cast<vtkIdType>(reader.GetNumber());
      for (vtkAbstractArray* array : arrays)
      {
        GetTuples(reader, array, first, count);
      }
      first += count;
    }
  }
}
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkSPHTakeParticles(
  vtkSPHRanks& ranks, vtkPointSet* data, vtkIdList* taken)
{
  vtkNew<vtkPolyData> view;
  if (data && data->GetNumberOfPoints() > 0)
  {
    view->SetPoints(data->GetPoints());
    view->GetPointData()->ShallowCopy(data->GetPointData());
  }
  const Layout common = AgreeOnLayout(ranks, Describe(view));
  if (const vtkSmartPointer<vtkPolyData> shared =
        taken || HasDuplicates(data) ? nullptr : ShareParticles(common, view))
  {
    return shared;
  }
  const vtkSmartPointer<vtkIdList> own = ListOwn(data);
  if (taken)
  {
    taken->DeepCopy(own);
  }
  auto particles = MakeParticles(common, own->GetNumberOfIds());
  if (data)
  {
    particles->GetFieldData()->ShallowCopy(data->GetFieldData());
  }
  if (own->GetNumberOfIds() > 0)
  {
    view->GetPoints()->GetData()->GetTuples(own, particles->GetPoints()->GetData());
    for (const Form& form : common.Forms)
    {
      view->GetPointData()
        ->GetAbstractArray(form.Name.c_str())
        ->GetTuples(own, particles->GetPointData()->GetAbstractArray(form.Name.c_str()));
    }
  }
  return particles;
}

//------------------------------------------------------------------------------
// In the order in which they are, and what was made of some of them last: so they are found again.
vtkSmartPointer<vtkPolyData> vtkSPHKeepUsed(vtkPolyData* own, const vtkSPHParticles& used)
{
  Arrays arrays = { used.SmoothingLength, used.Volume, used.Mass, used.Density, used.Fluid };
  for (const vtkSPHAttribute& attribute : used.Interpolated)
  {
    arrays.push_back(attribute.Array);
  }
  auto kept = vtkSmartPointer<vtkPolyData>::New();
  kept->SetPoints(own->GetPoints());
  vtkPointData *from = own->GetPointData(), *to = kept->GetPointData();
  for (int i = 0; i < from->GetNumberOfArrays(); ++i)
  {
    if (std::find(arrays.begin(), arrays.end(), from->GetAbstractArray(i)) != arrays.end())
    {
      const int at = to->AddArray(from->GetAbstractArray(i)),
                attribute = from->IsArrayAnAttribute(i);
      if (attribute >= 0)
      {
        to->SetActiveAttribute(at, attribute);
      }
    }
  }
  for (vtkAbstractArray* array : arrays)
  {
    if (array && !to->HasArray(array->GetName()))
    {
      to->AddArray(array);
    }
  }
  return kept;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> vtkSPHSendParticles(vtkSPHRanks& ranks, vtkPolyData* particles,
  const std::vector<std::vector<vtkIdType>>& to, std::vector<vtkIdType>* from)
{
  const std::vector<Bytes> received = SendTuples(ranks, ListArrays(particles), to);
  const std::vector<vtkIdType> counts = CountTuples(received);
  auto near =
    MakeParticles(Describe(particles), std::accumulate(counts.begin(), counts.end(), vtkIdType(0)));
  ReceiveTuples(received, ListArrays(near));
  if (from)
  {
    *from = counts;
  }
  return near;
}

//------------------------------------------------------------------------------
void vtkSPHReturnArrays(vtkSPHRanks& ranks, vtkPointData* results, vtkIdType count,
  const std::vector<std::vector<vtkIdType>>& back, const std::vector<std::vector<vtkIdType>>& home,
  vtkIdType homeCount, vtkPointData* to)
{
  const Layout layout = DescribeArrays(results, count);
  const std::vector<Bytes> received = SendTuples(ranks, ListArrays(results), back);
  vtkNew<vtkIdList> places;
  for (const std::vector<vtkIdType>& ids : home)
  {
    for (const vtkIdType id : ids)
    {
      places->InsertNextId(id);
    }
  }
  vtkNew<vtkPointData> came;
  AddArrays(came, layout, places->GetNumberOfIds());
  ReceiveTuples(received, ListArrays(came));
  vtkNew<vtkIdList> order;
  order->SetNumberOfIds(places->GetNumberOfIds());
  std::iota(order->begin(), order->end(), vtkIdType(0));
  for (const Form& form : layout.Forms)
  {
    vtkSmartPointer<vtkAbstractArray> array = MakeArray(form, homeCount);
    if (auto* numbers = vtkArrayDownCast<vtkDataArray>(array))
    {
      numbers->Fill(0.0);
    }
    array->InsertTuples(places, order, came->GetAbstractArray(form.Name.c_str()));
    to->AddArray(array);
  }
}

//------------------------------------------------------------------------------
void vtkSPHMatchEmpty(vtkSPHRanks& ranks, vtkPolyData* result)
{
  const Layout common = AgreeOnLayout(ranks, Describe(result));
  if (result->GetNumberOfPoints() == 0)
  {
    const vtkSmartPointer<vtkPolyData> empty = MakeParticles(common, 0);
    result->SetPoints(empty->GetPoints());
    result->GetPointData()->ShallowCopy(empty->GetPointData());
  }
}

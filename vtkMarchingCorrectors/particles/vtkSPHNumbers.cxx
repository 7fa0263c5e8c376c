// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkSPHNumbers.h"

#include "vtkDataArray.h"
#include "vtkSMPTools.h"
#include "vtkSPHReals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <sstream>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
namespace
{
const vtkIdType Grain = 8192; // particles that are worth a thread

using Numbers = std::vector<std::int64_t>;
using Partners = std::vector<vtkIdType>;

std::string NameOf(vtkDataArray* array)
{
  return array->GetName() ? array->GetName() : "";
}

/**
 * Reads whole numbers. Returns false if one is not whole; `bad` becomes the first such particle.
 */
bool ReadNumbers(vtkDataArray* array, Numbers& numbers, vtkIdType& bad)
{
  const vtkIdType count = array->GetNumberOfTuples();
  for (bad = 0; vtkSPHIsReal(array) && bad < count; ++bad)
  {
    // Beyond 2^53, floating point cannot hold all whole numbers, so distinct ones may have become
    // equal.
    const double real = array->GetComponent(bad, 0);
    if (!(std::floor(real) == real && std::abs(real) <= 9007199254740992.0))
    {
      return false;
    }
  }
  numbers.resize(static_cast<size_t>(count));
  vtkSPHForValues(array,
    [&numbers](auto values, vtkIdType first)
    {
      std::transform(values.begin(), values.end(), numbers.begin() + first,
        [](auto value) { return static_cast<std::int64_t>(value); });
    });
  return true;
}

std::string TellTwins(
  vtkDataArray* array, const std::string& set, vtkIdType one, vtkIdType other, std::int64_t number)
{
  return "Particles " + std::to_string(one) + " and " + std::to_string(other) + " in " + set +
    " have the same number " + std::to_string(number) + ", so they cannot be told apart: '" +
    NameOf(array) + "' is not an array of particle ids.";
}

using Entry = std::pair<std::int64_t, vtkIdType>;

Partners Search(const Numbers& numbers, const std::vector<Entry>& sorted)
{
  Partners partners(numbers.size());
  vtkSMPTools::For(0, static_cast<vtkIdType>(numbers.size()), Grain,
    [&](vtkIdType begin, vtkIdType end)
    {
      for (vtkIdType i = begin; i < end; ++i)
      {
        const std::int64_t number = numbers[static_cast<size_t>(i)];
        const auto found = std::lower_bound(sorted.begin(), sorted.end(), Entry(number, 0));
        partners[static_cast<size_t>(i)] =
          found != sorted.end() && found->first == number ? found->second : -1;
      }
    });
  return partners;
}

/** Inverts the partners. Returns false, and the two particles, where two have the same partner. */
bool Invert(const Partners& partners, Partners& inverse, Entry& twins)
{
  for (size_t i = 0; i < partners.size(); ++i)
  {
    if (partners[i] < 0)
    {
      continue;
    }
    vtkIdType& mine = inverse[static_cast<size_t>(partners[i])];
    if (mine >= 0)
    {
      twins = { mine, static_cast<vtkIdType>(i) };
      return false;
    }
    mine = static_cast<vtkIdType>(i);
  }
  return true;
}
}

// Sorts the numbers of the second set, and looks up those of the first one.
std::string vtkSPHMatchNumbers(const std::array<vtkDataArray*, 2>& arrays,
  const std::array<std::string, 2>& sets, const std::array<std::vector<vtkIdType>*, 2>& partners)
{
  Numbers numbers[2];
  for (size_t k = 0; k < 2; ++k)
  {
    vtkIdType bad = 0;
    if (!ReadNumbers(arrays[k], numbers[k], bad))
    {
      std::ostringstream sentence;
      sentence << "The number '" << NameOf(arrays[k]) << "' of particle " << bad << " in "
               << sets[k] << " is " << arrays[k]->GetComponent(bad, 0)
               << "; particles have whole numbers.";
      return sentence.str();
    }
  }
  const bool ascend = std::adjacent_find(numbers[0].begin(), numbers[0].end(),
                        std::greater_equal<std::int64_t>()) == numbers[0].end();
  if (ascend && numbers[0] == numbers[1])
  {
    partners[0]->resize(numbers[0].size());
    std::iota(partners[0]->begin(), partners[0]->end(), 0);
    *partners[1] = *partners[0];
    return "";
  }
  std::vector<Entry> sorted;
  for (const std::int64_t number : numbers[1])
  {
    sorted.emplace_back(number, static_cast<vtkIdType>(sorted.size()));
  }
  vtkSMPTools::Sort(sorted.begin(), sorted.end());
  const auto same = std::adjacent_find(sorted.begin(), sorted.end(),
    [](const Entry& a, const Entry& b) { return a.first == b.first; });
  if (same != sorted.end())
  {
    return TellTwins(arrays[1], sets[1], same->second, (same + 1)->second, same->first);
  }
  *partners[0] = Search(numbers[0], sorted);
  partners[1]->assign(numbers[1].size(), -1);
  Entry twins;
  if (!Invert(*partners[0], *partners[1], twins))
  {
    return TellTwins(
      arrays[0], sets[0], twins.first, twins.second, numbers[0][static_cast<size_t>(twins.second)]);
  }
  return "";
}
VTK_ABI_NAMESPACE_END

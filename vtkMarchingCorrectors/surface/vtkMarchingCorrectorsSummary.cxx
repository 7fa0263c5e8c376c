// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vtkMarchingCorrectorsSummary.h"

#include "vtkSPHReals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>

namespace
{
bool HasOneLength(const mcor_input& input)
{
  return input.estimate_smoothing_length || !input.smoothing_length.data;
}

double LengthOf(const mcor_input& input, std::int64_t i)
{
  return input.estimate_smoothing_length ? 1.0 : vtkSPHValueOf(input.smoothing_length, i);
}

/** Whether the particle is in the box. */
bool IsIn(const double box[6], const mcor_input& input, std::int64_t i)
{
  bool isIn = true;
  for (int a = 0; a < 3; ++a)
  {
    const double x = vtkSPHValueOf(input.positions, 3 * i + a);
    const double low = box[2 * a], high = box[2 * a + 1];
    isIn = isIn && x >= low && (x < high || x == low); // a flat box is around flat particles
  }
  return isIn;
}

std::string Text(double value)
{
  std::ostringstream text;
  text << value; // six digits
  return text.str();
}

std::string Name(const mcor_array& array)
{
  return array.data ? std::string("array ") + (array.name ? array.name : "") : Text(array.constant);
}
}

double vtkMarchingCorrectorsLeastLength(const mcor_input& input)
{
  double least = std::numeric_limits<double>::infinity();
  const bool isOne = HasOneLength(input);
  for (std::int64_t i = 0; i < input.count && !(isOne && std::isfinite(least)); ++i)
  {
    if (!input.solid || !input.solid[i])
    {
      least = std::min(least, LengthOf(input, i));
    }
  }
  return least;
}

double vtkMarchingCorrectorsEstimateCells(
  const mcor_input& input, const mcor_options& options, double least)
{
  // In units of the smoothing length or, as a factor of it, the support radius.
  double cubes = 0.0;
  const bool isPlane = mcor_find_dimension(&input, nullptr, options.dimension) == 2;
  const bool hasBox = mcor_has_box(&options) != 0;
  const std::int64_t read = HasOneLength(input) && !input.solid && !hasBox
    ? std::min<std::int64_t>(input.count, 1) // stands for all
    : input.count;
  for (std::int64_t i = 0; i < read; ++i)
  {
    if (!input.solid || !input.solid[i])
    {
      double h = LengthOf(input, i);
      for (int level = 0; level < options.level_limit && h >= 2.0 * least; ++level)
      {
        h *= 0.5; // its cubes are larger
      }
      cubes += !hasBox || IsIn(options.box, input, i) ? h * h * (isPlane ? 1.0 : h) : 0.0;
    }
  }
  cubes *= read < input.count ? static_cast<double>(input.count) : 1.0;
  const bool isKnown = !input.estimate_smoothing_length || options.cube_size <= 0.0;
  if (!std::isfinite(least) || !isKnown)
  {
    return 0.0;
  }
  const double perLength =
    input.smoothing_length_is_support_radius && !input.estimate_smoothing_length
    ? 1.0 / mcor_support_factor(options.sph_kernel)
    : 1.0;
  const double size =
    options.cube_size > 0.0 ? options.cube_size : options.cube_size_factor * least * perLength;
  const double spacing = perLength / 1.3;
  const double area = cubes * spacing * spacing, perArea = size * size;
  return size <= 0.0 ? 0.0 : isPlane ? area / perArea : area * spacing / (perArea * size);
}

std::string vtkMarchingCorrectorsDescribeSmoothingLength(
  const mcor_input& input, const mcor_statistics& statistics)
{
  std::string text = Text(statistics.smoothing_length_min);
  if (statistics.smoothing_length_max > statistics.smoothing_length_min)
  {
    text += " to " + Text(statistics.smoothing_length_max);
  }
  const bool isRadius = input.smoothing_length_is_support_radius != 0;
  if (input.estimate_smoothing_length)
  {
    return text + " (estimated)";
  }
  return text + (input.smoothing_length.data ? " (" + Name(input.smoothing_length) : " (given") +
    (isRadius ? ", support radius)" : ")");
}

std::string vtkMarchingCorrectorsDescribeVolume(const mcor_input& input)
{
  if (mcor_is_given(&input.volume))
  {
    return Name(input.volume);
  }
  if (mcor_is_given(&input.mass))
  {
    return Name(input.mass) + " / " +
      (mcor_is_given(&input.density) ? Name(input.density) : "density summed from it");
  }
  return "computed from the positions";
}

std::string vtkMarchingCorrectorsDescribeIsoValues(const mcor_options& options)
{
  std::string text;
  for (int i = 0; i < options.iso_count; ++i)
  {
    text += (i ? ", " : "") + Text(options.iso_values[i]);
  }
  return text;
}

std::string vtkMarchingCorrectorsDescribeMeasures(const mcor_statistics& statistics)
{
  if (statistics.dimension == 2 && statistics.length > 0.0)
  {
    return "two dimensions: length " + Text(statistics.length) +
      (statistics.area > 0.0 ? ", area " + Text(statistics.area)
                             : "; open, so that it has no area");
  }
  return statistics.area <= 0.0 ? ""
                                : "area " + Text(statistics.area) +
      (statistics.is_closed ? ", volume " + Text(statistics.volume)
                            : "; open, so that it has no volume");
}

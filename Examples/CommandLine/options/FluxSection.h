// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FluxSection_h
#define FluxSection_h

#include <string>
#include <vector>

/// A section that fluid flows through.
struct FluxSection
{
  enum Kind
  {
    Line,      ///< two points
    Rectangle, ///< a corner, two ends
    Disc,      ///< centre, normal, radius
    Box,       ///< bounds
    Surface    ///< of a file
  };
  std::string Name;
  Kind Shape = Surface;
  std::vector<double> Numbers;
  std::string File;
};

/// A section as it is written, for sentences.
extern const char* const FluxForm;

/// NAME=SECTION. Throws UsageError.
FluxSection ToFlux(const std::string& option, const std::string& text);

#endif

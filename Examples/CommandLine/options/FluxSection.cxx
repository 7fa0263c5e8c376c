// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "FluxSection.h"

#include "FileFormat.h"
#include "GaugeLine.h"
#include "OptionValue.h"

#include <sstream>

const char* const FluxForm = "NAME=X,Y,Z:X,Y,Z:X,Y,Z, NAME=disc:X,Y,Z:NX,NY,NZ:R, "
                             "NAME=box:X0,X1,Y0,Y1,Z0,Z1 or NAME=FILE";

FluxSection ToFlux(const std::string& option, const std::string& text)
{
  const std::size_t equals = text.find('=');
  const bool isNamed = equals != std::string::npos && equals > 0 && equals + 1 < text.size();
  Need(isNamed, option, std::string("a section with a name, ") + FluxForm, text);
  std::vector<std::string> parts;
  std::istringstream stream(text.substr(equals + 1));
  for (std::string part; std::getline(stream, part, ':');)
  {
    parts.push_back(part);
  }
  FluxSection section;
  section.Name = ToRowName(option, "section", text.substr(0, equals));
  const bool isDisc = parts[0] == "disc", isBox = parts[0] == "box";
  const auto isFileOf = [&text](const char* ending) { return EndsWith(text, ending); };
  if (isFileOf(".vtp") || isFileOf(".vtu") || isFileOf(".vtk") || isFileOf(".stl") ||
    isFileOf(".ply") || isFileOf(".obj"))
  {
    section.File = text.substr(equals + 1);
    return section;
  }
  section.Shape = isDisc ? FluxSection::Disc
    : isBox              ? FluxSection::Box
    : parts.size() == 2  ? FluxSection::Line
                         : FluxSection::Rectangle;
  const std::vector<std::size_t> counts = isDisc ? std::vector<std::size_t>{ 3, 3, 1 }
    : isBox                                      ? std::vector<std::size_t>{ 6 }
                                                 : std::vector<std::size_t>(parts.size(), 3);
  parts.erase(parts.begin(), parts.begin() + (isDisc || isBox ? 1 : 0));
  bool isGood =
    parts.size() == counts.size() && (isDisc || isBox || parts.size() == 2 || parts.size() == 3);
  for (std::size_t i = 0; i < counts.size() && isGood; ++i)
  {
    double numbers[6];
    isGood = ParseNumbers(option, parts[i], counts[i], numbers);
    section.Numbers.insert(section.Numbers.end(), numbers, numbers + counts[i]);
  }
  Need(isGood, option, std::string("a section with a name, ") + FluxForm, text);
  return section;
}

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef FileName_h
#define FileName_h

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

inline bool EndsWith(const std::string& text, const std::string& end)
{
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// Whether this is the name of a .pvd file, ParaView's list of files and their times.
inline bool IsCollectionFile(const std::string& file)
{
  return EndsWith(file, ".pvd");
}

/// Whether this is the name of a list of files and their times: .pvd, .vtk.series, ...
inline bool IsListOfSteps(const std::string& file)
{
  return IsCollectionFile(file) || EndsWith(file, ".series");
}

/// A file format: the ending of its names, and the function that reads or writes it.
template <typename FunctionT>
struct FileFormat
{
  const char* Ending;
  FunctionT Process;
};

/// Returns the format with the ending of this name; nullptr if there is none.
template <typename FunctionT>
const FileFormat<FunctionT>* FindFormat(
  const std::vector<FileFormat<FunctionT>>& formats, const std::string& file)
{
  for (const FileFormat<FunctionT>& format : formats)
  {
    if (EndsWith(file, format.Ending))
    {
      return &format;
    }
  }
  return nullptr;
}

/// Returns the endings as ".vtp, .vtu or .vtk".
template <typename FunctionT>
std::string ListEndings(const std::vector<FileFormat<FunctionT>>& formats)
{
  std::string list;
  for (std::size_t i = 0; i < formats.size(); ++i)
  {
    list += (i == 0 ? "" : i + 1 < formats.size() ? ", " : " or ") + std::string(formats[i].Ending);
  }
  return list;
}

/// Whether a film's name has one place for the number of a step, %d or %0Nd, and no other percent
/// sign.
inline bool HasStepNumber(const std::string& name)
{
  const std::size_t percent = name.find('%');
  const std::size_t letter =
    percent == std::string::npos ? percent : name.find_first_not_of("0123456789", percent + 1);
  return letter != std::string::npos && name[letter] == 'd' && letter - percent <= 3 &&
    std::count(name.begin(), name.end(), '%') == 1;
}

/// Returns the name of a step: frame_0007.png for frame_%04d.png.
inline std::string NameOfStep(const std::string& name, std::size_t step)
{
  const std::size_t percent = name.find('%');
  const auto width = static_cast<std::size_t>(std::atoi(name.c_str() + percent + 1));
  std::string number = std::to_string(step);
  number.insert(0, width > number.size() ? width - number.size() : 0, '0');
  return name.substr(0, percent) + number + name.substr(name.find('d', percent) + 1);
}

#endif

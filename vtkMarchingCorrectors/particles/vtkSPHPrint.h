// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/** Private to the module: prints settings in PrintSelf(). */
#ifndef vtkSPHPrint_h
#define vtkSPHPrint_h

#include "vtkIndent.h"

#include <cstddef>
#include <sstream>
#include <string>

/** Prints each member on a line of its own, such as "Cube Size: 0.1" for CubeSize. */
#define vtkSPHPrintMacro(...) vtkSPHPrint(os, indent, #__VA_ARGS__, __VA_ARGS__)

VTK_ABI_NAMESPACE_BEGIN
template <typename T>
void vtkSPHPrintValue(ostream& os, const T& value)
{
  os << " " << value;
}

inline void vtkSPHPrintValue(ostream& os, const std::string& text)
{
  os << " " << (text.empty() ? "(none)" : text);
}

template <typename T, std::size_t N>
void vtkSPHPrintValue(ostream& os, const T (&values)[N])
{
  for (const T& value : values)
  {
    os << " " << value;
  }
}

/** Prints each value behind its name. `names` has commas between the names. */
template <typename... ValueT>
void vtkSPHPrint(ostream& os, vtkIndent indent, const char* names, const ValueT&... values)
{
  std::istringstream stream(names);
  const auto print = [&](const auto& value)
  {
    std::string name;
    std::getline(stream >> std::ws, name, ',');
    os << indent << name[0];
    for (std::size_t i = 1; i < name.size(); ++i)
    {
      const bool isNaN = i >= 2 && name.compare(i - 2, 3, "NaN") == 0;
      os << (name[i] >= 'A' && name[i] <= 'Z' && !isNaN ? " " : "") << name[i];
    }
    os << ":";
    vtkSPHPrintValue(os, value);
    os << "\n";
    return 0;
  };
  const int printed[] = { print(values)... };
  static_cast<void>(printed);
}
VTK_ABI_NAMESPACE_END

#endif

// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "TableText.h"

#include "vtkDataArray.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

#include <charconv>
#include <cmath>

namespace
{

std::string Quoted(const std::string& text)
{
  if (text.find_first_of(",\"\n\r") == std::string::npos)
  {
    return text;
  }
  std::string quoted = "\"";
  for (const char c : text)
  {
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  }
  return quoted + "\"";
}

std::string Formatted(double number)
{
  if (std::isnan(number))
  {
    return "";
  }
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof(digits), number + 0.0); // no -0
  return std::string(digits, result.ptr);
}

std::string Field(vtkAbstractArray* column, vtkIdType row)
{
  if (auto* texts = vtkStringArray::SafeDownCast(column))
  {
    return Quoted(texts->GetValue(row));
  }
  return Formatted(vtkDataArray::SafeDownCast(column)->GetComponent(row, 0));
}

}

std::string TableHeader(vtkTable* table)
{
  std::string line;
  for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
  {
    line += (c ? "," : "") + Quoted(table->GetColumnName(c));
  }
  return line + "\n";
}

std::string TableRows(vtkTable* table)
{
  std::string text;
  for (vtkIdType row = 0; row < table->GetNumberOfRows(); ++row)
  {
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
    {
      text += (c ? "," : "") + Field(table->GetColumn(c), row);
    }
    text += "\n";
  }
  return text;
}

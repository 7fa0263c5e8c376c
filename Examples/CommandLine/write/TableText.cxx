// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "DataFile.h"

#include "SafeText.h"

#include "vtkDataArray.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <cmath>

std::string TableField(const std::string& text)
{
  const bool isFormula = !text.empty() && std::string("=+-@").find(text[0]) != std::string::npos;
  const std::string plain = (isFormula ? "'" : "") + text;
  if (plain.find_first_of(",\"\n\r") == std::string::npos)
  {
    return plain;
  }
  std::string quoted = "\"";
  for (const char c : plain)
  {
    quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  }
  return quoted + "\"";
}

std::string TableField(vtkAbstractArray* array, vtkIdType tuple, int component)
{
  if (auto* texts = vtkStringArray::SafeDownCast(array))
  {
    return TableField(texts->GetValue(tuple));
  }
  auto* numbers = vtkDataArray::SafeDownCast(array);
  if (array->GetDataTypeSize() == 8 && array->GetDataType() != VTK_DOUBLE) // beyond 2^53, too
  {
    const vtkVariant value =
      array->GetVariantValue(tuple * array->GetNumberOfComponents() + component);
    return numbers->GetDataTypeMin() < 0.0 ? DigitsOf(value.ToLongLong())
                                           : DigitsOf(value.ToUnsignedLongLong());
  }
  const double number = numbers->GetComponent(tuple, component) + 0.0; // no -0
  return std::isnan(number) ? "" : DigitsOf(number);
}

void AppendTable(std::string& text, vtkTable* table)
{
  const vtkIdType header = -1;
  for (vtkIdType row = text.empty() ? header : 0; row < table->GetNumberOfRows(); ++row)
  {
    for (vtkIdType c = 0; c < table->GetNumberOfColumns(); ++c)
    {
      text += (c ? "," : "") +
        (row == header ? TableField(table->GetColumnName(c))
                       : TableField(table->GetColumn(c), row));
    }
    text += "\n";
  }
}

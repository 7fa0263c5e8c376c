// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
/**
 * Private to the module: numbers and texts in the bytes that ranks send each other.
 */
#ifndef vtkSPHRanksBytes_h
#define vtkSPHRanksBytes_h

#include "vtkSPHRanks.h"

#include <algorithm>
#include <cstdint>
#include <string>

inline void vtkSPHPutBytes(vtkSPHRanks::Bytes& bytes, const void* data, std::size_t size)
{
  const auto* first = static_cast<const char*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

inline void vtkSPHPutNumber(vtkSPHRanks::Bytes& bytes, std::int64_t number)
{
  vtkSPHPutBytes(bytes, &number, sizeof(number));
}

inline void vtkSPHPutText(vtkSPHRanks::Bytes& bytes, const std::string& text)
{
  vtkSPHPutNumber(bytes, static_cast<std::int64_t>(text.size()));
  vtkSPHPutBytes(bytes, text.data(), text.size());
}

/** Reads what was put; both sides are of one program. */
class vtkSPHRanksReader
{
public:
  explicit vtkSPHRanksReader(const vtkSPHRanks::Bytes& bytes)
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

#endif

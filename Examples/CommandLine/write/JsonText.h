// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#ifndef JsonText_h
#define JsonText_h

#include "SafeText.h"

#include <charconv>
#include <cmath>
#include <string>
#include <vector>

/// Writes JSON, indented. VTK's own JSON library is private in some builds.
class JsonText
{
public:
  /// At depth 0 a text of its own, else what Raw() puts into another one at that depth.
  explicit JsonText(std::size_t depth = 0)
    : Depth(depth)
  {
  }

  /// An object. The key is empty for the outermost one and for elements of a list.
  void Begin(const std::string& key) { this->Open(key, "{"); }
  void End() { this->Close("}"); }
  void BeginList(const std::string& key) { this->Open(key, "["); }
  void EndList() { this->Close("]"); }

  void Value(const std::string& key, const std::string& text)
  {
    this->Line(key);
    this->Text += QuotedForJson(text);
  }

  void Value(const std::string& key, double number)
  {
    this->Line(key);
    this->Text += Formatted(number);
  }

  void Value(const std::string& key, const std::vector<double>& numbers)
  {
    this->Line(key);
    this->Text += "[";
    for (std::size_t i = 0; i < numbers.size(); ++i)
    {
      this->Text += (i ? ", " : "") + Formatted(numbers[i]);
    }
    this->Text += "]";
  }

  void Raw(const std::string& values)
  {
    this->Text += (this->First ? "" : ",") + values;
    this->First = false;
  }

  const std::string& Get() const { return this->Text; }

private:
  void Open(const std::string& key, const char* bracket)
  {
    this->Line(key);
    this->Text += bracket;
    ++this->Depth;
    this->First = true;
  }

  void Close(const char* bracket)
  {
    --this->Depth;
    if (!this->First)
    {
      this->NewLine();
    }
    this->First = false;
    this->Text += bracket;
  }

  /// Comma, line break and key before a value.
  void Line(const std::string& key)
  {
    if (this->Depth > 0)
    {
      this->Text += this->First ? "" : ",";
      this->NewLine();
    }
    this->First = false;
    this->Text += key.empty() ? "" : QuotedForJson(key) + ": ";
  }

  void NewLine() { this->Text += "\n" + std::string(2 * this->Depth, ' '); }

  /// Reads back as the same number; JSON has neither NaN nor infinity.
  static std::string Formatted(double number)
  {
    if (!std::isfinite(number))
    {
      return "null";
    }
    char digits[32];
    const auto result = std::to_chars(digits, digits + sizeof(digits), number);
    return std::string(digits, result.ptr);
  }

  std::string Text;
  std::size_t Depth;
  bool First = true;
};

#endif

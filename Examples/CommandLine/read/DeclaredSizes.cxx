// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "SafeText.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{

using View = std::string_view;

/// A file's bytes, as they lie there.
class MappedFile
{
public:
  explicit MappedFile(const std::string& file)
  {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status = {};
    if (descriptor >= 0 && fstat(descriptor, &status) == 0 && status.st_size > 0)
    {
      this->Size = static_cast<std::size_t>(status.st_size);
      this->Memory = mmap(nullptr, this->Size, PROT_READ, MAP_PRIVATE, descriptor, 0);
    }
    if (descriptor >= 0)
    {
      close(descriptor);
    }
  }

  ~MappedFile()
  {
    if (this->Memory != MAP_FAILED)
    {
      munmap(this->Memory, this->Size);
    }
  }

  MappedFile(const MappedFile&) = delete;
  void operator=(const MappedFile&) = delete;

  View Get() const
  {
    return this->Memory == MAP_FAILED ? View() : View(static_cast<char*>(this->Memory), this->Size);
  }

private:
  void* Memory = MAP_FAILED;
  std::size_t Size = 0;
};

/// Returns the whole numbers of a text, up to the first word that is none.
std::vector<double> Numbers(View text)
{
  std::vector<double> numbers;
  const std::string copy(text.substr(0, 200));
  const char* next = copy.c_str();
  for (char* end = nullptr;; next = end)
  {
    const double number = std::strtod(next, &end);
    if (end == next)
    {
      return numbers;
    }
    numbers.push_back(number);
  }
}

class Checker
{
public:
  Checker(const std::string& file, double most)
    : File(file)
    , Most(most)
  {
  }

  /// `count` times what stands as `name` in the file.
  void Check(View name, double value, double count = 1.0) const
  {
    if (!(value >= 0.0) || !(value * count <= this->Most))
    {
      char digits[32];
      std::snprintf(digits, sizeof(digits), "%.15g", value);
      FailToRead(this->File,
        std::string(name) + " is " + digits +
          (value >= 0.0 ? ", more than a file of its size can hold" : "") + "; it may be damaged");
    }
  }

private:
  const std::string File;
  const double Most;
};

/// The attributes of a tag.
std::map<View, View> AttributesOf(View tag)
{
  std::map<View, View> attributes;
  std::size_t equals = 0;
  while ((equals = tag.find('=', equals + 1)) != View::npos)
  {
    const std::size_t name = tag.find_last_of(" \t\r\n", equals) + 1;
    const std::size_t open = tag.find_first_of("\"'", equals);
    const std::size_t close = open == View::npos ? open : tag.find(tag[open], open + 1);
    if (close == View::npos)
    {
      break;
    }
    attributes[tag.substr(name, equals - name)] = tag.substr(open + 1, close - open - 1);
    equals = close;
  }
  return attributes;
}

void CheckExtent(const Checker& checker, View name, View text)
{
  const std::vector<double> extent = Numbers(text);
  for (std::size_t a = 0; 2 * a + 1 < extent.size(); ++a)
  {
    checker.Check(name, std::min(extent[2 * a + 1] - extent[2 * a] + 1.0, 0.0));
  }
}

/// Counts are attributes of tags: of pieces, and of their arrays, which have so many numbers for
/// each point or cell.
void CheckXml(const std::string& file, View text)
{
  const bool isPacked = text.substr(0, 1000).find("compressor") != View::npos;
  // Eight bits a byte; of all that VTK reads, LZMA packs zeros closest, 7,000 to 1.
  const Checker checker(file, static_cast<double>(text.size()) * (isPacked ? 1e4 : 8.0));
  double elements = 0.0;
  for (std::size_t begin = 0; (begin = text.find('<', begin)) != View::npos;)
  {
    const std::size_t end = std::min(text.find('>', begin), text.size());
    const View tag = text.substr(begin, end - begin);
    begin = end;
    if (tag.substr(0, 13) == "<AppendedData")
    {
      return;
    }
    for (const auto& [name, value] : AttributesOf(tag))
    {
      const std::vector<double> numbers = Numbers(value);
      if (name.substr(0, 8) == "NumberOf" && !numbers.empty())
      {
        const bool isWidth = name == "NumberOfComponents";
        checker.Check(name, numbers[0], isWidth ? std::max(elements, 1.0) : 1.0);
        elements = name == "NumberOfPoints" ? numbers[0] : elements;
      }
      else if (name == "Extent" || name == "WholeExtent")
      {
        CheckExtent(checker, name, value);
      }
    }
  }
}

/// Whether a line may consist of words, and not of values, as text or not.
bool MayDeclare(View line)
{
  const auto isPrinted = [](char c) { return (c >= ' ' && c <= '~') || c == '\t' || c == '\r'; };
  return !line.empty() && line.size() < 300 && std::strchr("0123456789-. \r", line[0]) == nullptr &&
    std::all_of(line.begin(), line.end(), isPrinted);
}

/// A line's words, in small letters.
std::vector<std::string> WordsOf(View line)
{
  std::istringstream stream{ std::string(line) };
  std::vector<std::string> words;
  for (std::string word; stream >> word;)
  {
    std::transform(word.begin(), word.end(), word.begin(),
      [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    words.push_back(word);
  }
  return words;
}

/// Counts stand behind words at the beginning of a line, and those of attributes in a line before
/// them. The arrays of a field have lines with a name, two counts and a type.
class LegacyChecker
{
public:
  LegacyChecker(const std::string& file, View text)
    : Sizes(file, 8.0 * static_cast<double>(text.size()))
  {
  }

  void Check(const std::vector<std::string>& words)
  {
    static const std::set<std::string> counted = { "points", "vertices", "lines", "polygons",
      "triangle_strips", "cells", "cell_types", "x_coordinates", "y_coordinates", "z_coordinates",
      "field", "lookup_table" };
    static const std::set<std::string> attributes = { "scalars", "vectors", "normals", "tensors",
      "color_scalars", "texture_coordinates" };
    std::vector<double> numbers;
    for (std::size_t i = 1; i < words.size(); ++i)
    {
      const std::vector<double> number = Numbers(words[i]);
      numbers.insert(numbers.end(), number.begin(), number.end());
    }
    const std::string& first = words.front();
    const bool isSection = first == "point_data" || first == "cell_data";
    for (const double number : numbers)
    {
      if (isSection || first == "dimensions") // of an image, which may have no values
      {
        this->Sizes.Check(first, std::min(number, 0.0));
        this->Section = isSection ? first : this->Section;
        this->Elements = isSection ? number : this->Elements;
      }
      if (counted.count(first) || attributes.count(first))
      {
        this->Sizes.Check(first, number);
      }
    }
    if (attributes.count(first))
    {
      this->Sizes.Check(this->Section, this->Elements, numbers.empty() ? 1.0 : numbers.back());
    }
    else if (words.size() == 4 && numbers.size() == 2 && Numbers(words[3]).empty())
    {
      this->Sizes.Check(first, numbers[0], std::max(numbers[1], 1.0));
      this->Sizes.Check(first, numbers[1]);
    }
  }

private:
  const Checker Sizes;
  std::string Section = "point_data"; ///< that the attributes are in
  double Elements = 0.0;              ///< values of each
};

void CheckLegacy(const std::string& file, View text)
{
  LegacyChecker checker(file, text);
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1)
  {
    end = std::min(text.find('\n', begin), text.size());
    const View line = text.substr(begin, end - begin);
    const std::vector<std::string> words =
      MayDeclare(line) ? WordsOf(line) : std::vector<std::string>();
    if (!words.empty())
    {
      checker.Check(words);
    }
  }
}

}

void CheckDeclaredSizes(const std::string& file)
{
  const MappedFile mapped(file);
  CheckDeclaredSizes(file, mapped.Get());
}

void CheckDeclaredSizes(const std::string& file, std::string_view text)
{
  if (text.substr(0, 5) == "# vtk")
  {
    CheckLegacy(file, text);
  }
  else if (std::filesystem::path(file).extension() != ".vtkhdf")
  {
    CheckXml(file, text);
  }
}

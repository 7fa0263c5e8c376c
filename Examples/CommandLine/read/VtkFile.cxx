// SPDX-FileCopyrightText: Copyright (c) The Marching Correctors developers
// SPDX-License-Identifier: BSD-3-Clause
#include "Formats.h"

#include "Failures.h"
#include "Text.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkGenericDataObjectReader.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"
#include "vtkXMLImageDataReader.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLRectilinearGridReader.h"
#include "vtkXMLStructuredGridReader.h"
#include "vtkXMLUnstructuredGridReader.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace
{

// ---- The counts that a file declares ----

/// Returns the numbers at the beginning of a text, up to the first word that is not a number. Reads
/// at most 200 characters.
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

/// Refuses the file if `value`, which it declares as `name`, is below 0, or if `count` times
/// `value` is more than `most`.
void CheckSize(const std::string& file, double most, View name, double value, double count = 1.0)
{
  if (!(value >= 0.0) || !(value * count <= most))
  {
    char digits[32];
    std::snprintf(digits, sizeof(digits), "%.15g", value);
    FailToRead(file,
      std::string(name) + " is " + digits +
        (value >= 0.0 ? ", more than a file of its size can hold" : "") + "; it may be damaged");
  }
}

/// Checks the counts that an XML element, and the elements inside it, declare. Each may be at
/// most `most`; a number of components at most `most` / `points`. points: the number of points of the last piece.
void CheckXmlSizes(const std::string& file, double most, vtkXMLDataElement* element, double& points)
{
  for (int i = 0; i < element->GetNumberOfAttributes(); ++i)
  {
    const View name = element->GetAttributeName(i);
    const std::vector<double> numbers = Numbers(element->GetAttributeValue(i));
    if (name.substr(0, 8) == "NumberOf" && !numbers.empty())
    {
      const bool isWidth = name == "NumberOfComponents";
      CheckSize(file, most, name, numbers[0], isWidth ? std::max(points, 1.0) : 1.0);
      points = name == "NumberOfPoints" ? numbers[0] : points;
    }
    const bool isExtent = name == "Extent" || name == "WholeExtent";
    for (std::size_t a = 1; isExtent && a < numbers.size(); a += 2)
    {
      CheckSize(file, most, name, std::min(numbers[a] - numbers[a - 1] + 1.0, 0.0));
    }
  }
  for (int i = 0; i < element->GetNumberOfNestedElements(); ++i)
  {
    CheckXmlSizes(file, most, element->GetNestedElement(i), points);
  }
}

/// Returns the words of a line in small letters; none if the line holds values, as text or as bytes.
std::vector<std::string> DeclaringWords(View line)
{
  const auto isPrinted = [](char c) { return (c >= ' ' && c <= '~') || c == '\t' || c == '\r'; };
  if (line.empty() || line.size() >= 300 || std::strchr("0123456789-. \r", line[0]) ||
    !std::all_of(line.begin(), line.end(), isPrinted))
  {
    return {};
  }
  std::istringstream words(Small(line));
  return { std::istream_iterator<std::string>(words), {} };
}

bool AreDigits(View word)
{
  return !word.empty() && word.find_first_not_of("0123456789") == View::npos;
}

/// Whether the text begins with `count` whole numbers.
bool BeginsWithNumbers(View text, double count)
{
  const char* const blanks = " \t\r\n";
  std::size_t at = text.find_first_not_of(blanks);
  for (double i = 0.0; i < count; ++i)
  {
    const std::size_t end = std::min(text.find_first_of(blanks, at), text.size());
    if (at == View::npos || !AreDigits(text.substr(at, end - at)))
    {
      return false;
    }
    at = text.find_first_not_of(blanks, end);
  }
  return true;
}

/// Checks the counts in a legacy file. A line with counts begins with a word. Attributes have the count that an
/// earlier line gives. The arrays of a field have lines with a name, two counts and a type.
void CheckLegacy(const std::string& file, View text)
{
  using Words = std::set<std::string>;
  static const Words cells = { "vertices", "lines", "polygons", "triangle_strips", "cells" };
  static const Words counted = { "points", "cell_types", "x_coordinates", "y_coordinates",
    "z_coordinates", "field", "lookup_table" };
  // These counts may exceed the file's size, because an image may have points and cells without values.
  static const Words unlimited = { "point_data", "cell_data", "dimensions" };
  // VTK's reader crashes if other words stand where a type must stand.
  static const Words types = { "bit", "char", "signed_char", "unsigned_char", "short",
    "unsigned_short", "int", "unsigned_int", "long", "unsigned_long", "vtkidtype", "vtktypeint64",
    "vtktypeuint64", "float", "double", "string", "utf8_string", "variant" };
  static const Words attributes = { "scalars", "vectors", "normals", "tensors", "color_scalars",
    "texture_coordinates" };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double most = 8.0 * static_cast<double>(text.size());
  std::string section = "point_data"; // the kind of elements, points or cells
  double elements = 0.0;              // how many elements there are
  const bool isText = text.substr(0, 600).find("\nASCII") != View::npos;
  double fields = 0.0; // how many arrays of a FIELD are still to come, which may have any names
  const std::size_t title = std::min(text.find('\n'), text.size() - 1) + 1; // a title of any words
  for (std::size_t begin = text.find('\n', title), end = 0; begin < text.size(); begin = end + 1)
  {
    end = std::min(text.find('\n', begin), text.size());
    const std::vector<std::string> words = DeclaringWords(text.substr(begin, end - begin));
    const std::string first = words.empty() ? "" : words.front();
    std::vector<double> numbers;
    for (std::size_t i = 1; i < words.size(); ++i)
    {
      const std::vector<double> number = Numbers(words[i]);
      numbers.insert(numbers.end(), number.begin(), number.end());
    }
    const auto checkArray = [&]
    {
      CheckSize(file, most, first, numbers[0], std::max(numbers[1], 1.0));
      CheckSize(file, most, first, numbers[1]);
    };
    const bool isArray =
      words.size() == 4 && AreDigits(words[1]) && AreDigits(words[2]) && types.count(words[3]);
    if (fields > 0.0 && isArray)
    {
      --fields;
      checkArray();
      continue;
    }
    const double room = 0.5 * static_cast<double>(text.size() - end); // two bytes each, or more
    if (numbers.size() == 2 && cells.count(first))
    {
      CheckSize(file, room, first, numbers[1]);
      const std::size_t next = text.find_first_not_of(" \t\r\n", end);
      const bool isList = isText && next != View::npos && text[next] != 'O'; // 'O': OFFSETS
      RequireToRead(!isList || BeginsWithNumbers(text.substr(end), numbers[1]), file,
        "its " + first + " are no whole numbers; it may be damaged");
    }
    else if (first == "points" && !numbers.empty())
    {
      CheckSize(file, room, first, numbers[0], 3.0);
    }
    else if (first == "field")
    {
      RequireToRead(words.size() == 3 && AreDigits(words[2]), file,
        "the line of its FIELD has no number of arrays; it may be damaged");
      fields = numbers.back();
    }
    const bool isSection = first == "point_data" || first == "cell_data";
    const bool isUnlimited = unlimited.count(first) > 0, hasAttribute = attributes.count(first) > 0;
    for (const double number : numbers)
    {
      if (isUnlimited || hasAttribute || cells.count(first) || counted.count(first))
      {
        CheckSize(file, isUnlimited ? infinity : most, first, number);
      }
      section = isSection ? first : section;
      elements = isSection ? number : elements;
    }
    if (hasAttribute)
    {
      CheckSize(file, most, section, elements, numbers.empty() ? 1.0 : numbers.back());
    }
    else if (words.size() == 4 && numbers.size() == 2 && Numbers(words[3]).empty())
    {
      RequireToRead(isArray, file,
        "its array '" + words[0] + "' has the numbers and the type '" + words[1] + " " + words[2] +
          " " + words[3] + "', which are not known");
      checkArray();
    }
  }
}

// ---- Reading ----

/// A parser that turns a delay off. Since version 2.6, and in security updates of older versions,
/// Expat waits before it parses a token that may be incomplete. A VTK that does not know this yet
/// (ParaView 5.11 of Debian 12) then overlooks the place where XML ends and appended data begin,
/// and cannot read the file.
class PromptParser : public vtkXMLDataParser
{
public:
  static PromptParser* New();
  vtkTypeMacro(PromptParser, vtkXMLDataParser);

protected:
  int CreateParser() override
  {
    const int result = this->Superclass::CreateParser();
    using SwitchType = unsigned char (*)(void*, unsigned char);
    const auto setDeferral =
      reinterpret_cast<SwitchType>(dlsym(RTLD_DEFAULT, "XML_SetReparseDeferralEnabled"));
    if (result && setDeferral)
    {
      setDeferral(this->Parser, 0);
    }
    return result;
  }
};
vtkStandardNewMacro(PromptParser);

/// A reader that checks the counts in a file before it takes memory for them.
template <typename ReaderT>
class CarefulReader : public ReaderT
{
public:
  static vtkSmartPointer<vtkXMLReader> New()
  {
    auto* reader = new CarefulReader;
    reader->InitializeObjectBase();
    return vtk::TakeSmartPointer<vtkXMLReader>(reader);
  }

protected:
  void CreateXMLParser() override
  {
    if (this->XMLParser)
    {
      this->XMLParser->Delete();
    }
    this->XMLParser = PromptParser::New();
  }

  int ReadVTKFile(vtkXMLDataElement* root) override
  {
    const std::string file = this->FileName ? this->FileName : "";
    const std::size_t size = file.empty() ? this->InputString.size() : BytesOf(file)->size();
    // The smallest values are bits, so a byte holds at most eight values. A packed byte may hold more:
    // 7,000 zeros with LZMA, the best packer that VTK reads.
    const double most = static_cast<double>(size) * (root->GetAttribute("compressor") ? 1e4 : 8.0);
    double points = 0.0;
    CheckXmlSizes(file, most, root, points);
    return ReaderT::ReadVTKFile(root);
  }
};

const std::vector<FileFormat<vtkSmartPointer<vtkXMLReader> (*)()>> XmlReaders = {
  { ".vtp", CarefulReader<vtkXMLPolyDataReader>::New },
  { ".vtu", CarefulReader<vtkXMLUnstructuredGridReader>::New },
  { ".vti", CarefulReader<vtkXMLImageDataReader>::New },
  { ".vtr", CarefulReader<vtkXMLRectilinearGridReader>::New },
  { ".vts", CarefulReader<vtkXMLStructuredGridReader>::New },
};

// ---- Times ----

/// These functions return the text of an empty data set that has the field data of a file's
/// beginning, in the file's own format, so that VTK's reader can read the field data alone. They
/// return "" if no complete field data are found.
std::string FieldOfXml(const std::string& head)
{
  // A search from npos on finds nothing, so `close` is npos if `tag`, `tagEnd` or `begin` is.
  const std::size_t tag = head.find("<VTKFile"), type = head.find("type=", tag);
  const std::size_t tagEnd = head.find('>', tag), begin = head.find("<FieldData", tagEnd);
  const std::size_t close = head.find("</FieldData>", begin);
  const std::size_t typeEnd =
    type == std::string::npos ? type : head.find(head[type + 5], type + 6);
  if (close == std::string::npos || typeEnd >= tagEnd)
  {
    return "";
  }
  return head.substr(tag, type - tag) + "type=\"PolyData\"" +
    head.substr(typeEnd + 1, tagEnd - typeEnd) + "<PolyData>" + head.substr(begin, close - begin) +
    "</FieldData><Piece NumberOfPoints=\"0\"><Points></Points></Piece></PolyData></VTKFile>";
}

std::string FieldOfLegacy(const std::string& head)
{
  const std::size_t set = head.find("\nDATASET "), field = head.find("\nFIELD ", set);
  const std::size_t points = head.find("\nPOINTS ", field);
  if (points == std::string::npos)
  {
    return "";
  }
  return head.substr(0, set) + "\nDATASET POLYDATA" + head.substr(field, points - field) +
    "\nPOINTS 0 float\n";
}

}

FileBytes BytesOf(const std::string& file)
{
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  struct stat status = {};
  const bool isFile = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  const auto size = static_cast<std::size_t>(isFile ? status.st_size : 0);
  void* const memory =
    size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  close(descriptor);
  RequireToRead(memory != MAP_FAILED, file, "it cannot be mapped into memory");
  return FileBytes(new View(static_cast<const char*>(memory), size),
    [memory, size](const View* bytes)
    {
      munmap(memory, size);
      delete bytes;
    });
}

vtkSmartPointer<vtkDataObject> ReadXml(const std::string& file, std::size_t)
{
  const FileBytes bytes = BytesOf(file);
  // VTK reads appended data that end too early without an error, and the rest of the arrays then has
  // random values.
  const View end = bytes->substr(bytes->size() - std::min<std::size_t>(bytes->size(), 256));
  Require(end.find("</VTKFile>") != View::npos,
    file + " is not a complete VTK XML file: its end is missing");
  const vtkSmartPointer<vtkXMLReader> reader = FindFormat(XmlReaders, file)->Process();
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutputDataObject(0);
}

vtkSmartPointer<vtkDataObject> ReadLegacy(const std::string& file, std::size_t)
{
  CheckLegacy(file, *BytesOf(file));
  vtkNew<vtkGenericDataObjectReader> reader;
  reader->SetFileName(file.c_str());
  // By default only the first array of each kind is read.
  reader->ReadAllScalarsOn();
  reader->ReadAllVectorsOn();
  reader->ReadAllFieldsOn();
  reader->Update();
  return reader->GetOutput();
}

std::vector<double> ListTimesOfVtk(const std::string& file)
{
  return NumberInVtk(file, { "TimeValue", "TIME", "Time", "time" });
}

std::vector<double> NumberInVtk(const std::string& file, const std::vector<std::string>& names)
{
  const std::string head(BytesOf(file)->substr(0, 1 << 16)); // field data farther behind are ignored
  const bool isLegacy = head.compare(0, 5, "# vtk") == 0;
  const std::string text = isLegacy ? FieldOfLegacy(head) : FieldOfXml(head);
  vtkSmartPointer<vtkDataObject> data;
  const auto read = [&]
  {
    if (isLegacy)
    {
      CheckLegacy(file, text);
      vtkNew<vtkGenericDataObjectReader> reader;
      reader->ReadFromInputStringOn();
      reader->SetBinaryInputString(text.data(), static_cast<int>(text.size()));
      reader->ReadAllFieldsOn();
      reader->Update();
      data = reader->GetOutput();
    }
    else if (text.find("\"appended\"") == std::string::npos)
    {
      const auto reader = CarefulReader<vtkXMLPolyDataReader>::New();
      reader->ReadFromInputStringOn();
      reader->SetInputString(text);
      reader->Update();
      data = reader->GetOutputDataObject(0);
    }
  };
  if (!text.empty())
  {
    FailureOf([&] { ReadWithCare(file, read); }); // an error is reported when the whole file is read
  }
  Messages() = {};
  for (const std::string& name : names)
  {
    vtkDataArray* array = data ? data->GetFieldData()->GetArray(name.c_str()) : nullptr;
    if (array && array->GetNumberOfValues() == 1 && std::isfinite(array->GetComponent(0, 0)))
    {
      return { array->GetComponent(0, 0) };
    }
  }
  // If an XML file has field data at its end, a tag at its beginning has the least and the greatest
  // value of each array. If an array holds a single finite number, both values are this number.
  for (const std::string& name : names)
  {
    const std::size_t at = text.find("Name=\"" + name + "\"");
    const std::size_t low = text.find("RangeMin=\"", at), close = text.find('>', at);
    const std::string number =
      low < close ? text.substr(low + 10, text.find('"', low + 10) - low - 10) : "";
    double value = 0.0;
    if (text.find("RangeMax=\"" + number + '"', at) < close && close != std::string::npos &&
      ParseNumber(number, value))
    {
      return { value };
    }
  }
  return {};
}

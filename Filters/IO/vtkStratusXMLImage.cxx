// SPDX-License-Identifier: BSD-3-Clause
// Reads the XML of a .vti file.
#include "vtkStratusXMLImage.h"

#include "vtkStratusImageFile.h"
#include "vtkStratusText.h"

#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLDataParser.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstring>

namespace {
constexpr double Flat = 1e-6; // three axes of length 1 that span a smaller volume are in one plane

std::string AttributeOf(vtkXMLDataElement* element, const char* name)
{
  const char* const text = element->GetAttribute(name);
  return text ? text : "";
}

std::vector<vtkXMLDataElement*> ListNested(vtkXMLDataElement* element, const char* name)
{
  std::vector<vtkXMLDataElement*> found;
  for (int i = 0; element && i < element->GetNumberOfNestedElements(); ++i) {
    vtkXMLDataElement* const one = element->GetNestedElement(i);
    if (!name || std::strcmp(one->GetName(), name) == 0) {
      found.push_back(one);
    }
  }
  return found;
}

// The elements of a file.
class Document
{
public:
  explicit Document(const std::string& path);
  std::string WhyNot() const;
  vtkStratusXMLImage Read() const;

private:
  [[noreturn]] void Fail(const std::string& why) const { throw vtkStratusReadError{ this->Path + ": " + why }; }
  void ReadFrame(vtkStratusXMLImage& image) const;
  void ReadArrays(bool cells, vtkStratusXMLImage& image) const;
  vtkStratusXMLArray ReadArray(vtkXMLDataElement* element, bool cells, const vtkStratusXMLImage& image) const;
  int64_t ReadInteger(vtkXMLDataElement* element, const char* name, int64_t least, int64_t most, int64_t usual) const;
  template <class Number, size_t Count>
  void ReadNumbers(vtkXMLDataElement* element, const char* name, bool needed, std::array<Number, Count>& to) const;

  std::string Path;
  vtkNew<vtkXMLDataParser> Parser;
  vtkXMLDataElement *Root = nullptr, *Image = nullptr, *Piece = nullptr, *Appended = nullptr;
};

Document::Document(const std::string& path) : Path(path)
{
  std::string heard;
  vtkNew<vtkCallbackCommand> listener;
  listener->SetClientData(&heard);
  listener->SetCallback([](vtkObject*, unsigned long, void* text, void* message) {
    *static_cast<std::string*>(text) += message ? static_cast<const char*>(message) : "";
  });
  this->Parser->AddObserver("ErrorEvent", listener);
  this->Parser->SetFileName(path.c_str());
  const int parsed = this->Parser->Parse();
  this->Root = parsed ? this->Parser->GetRootElement() : nullptr;
  if (!this->Root) {
    const size_t at = heard.find("): "), end = heard.find('\n', at == std::string::npos ? 0 : at);
    const std::string why = at == std::string::npos ? "" : ": " + heard.substr(at + 3, end == std::string::npos ? end : end - at - 3);
    this->Fail("its XML can't be read" + why);
  }
  this->Image = this->Root->FindNestedElementWithName("ImageData");
  this->Piece = this->Image ? this->Image->FindNestedElementWithName("Piece") : nullptr;
  this->Appended = this->Root->FindNestedElementWithName("AppendedData");
}

std::string Document::WhyNot() const
{
  const std::string compressor = AttributeOf(this->Root, "compressor"),
                    encoding = this->Appended ? AttributeOf(this->Appended, "encoding") : "";
  if (std::strcmp(this->Root->GetName(), "VTKFile") != 0 || AttributeOf(this->Root, "type") != "ImageData" || !this->Image) {
    return "it is no image";
  }
  if (ListNested(this->Image, "Piece").size() != 1) {
    return "it has " + std::to_string(ListNested(this->Image, "Piece").size()) + " pieces";
  }
  if (this->Image->GetAttribute("TimeValues")) {
    return "it has time steps";
  }
  if (encoding != "raw") {
    return "its values are not appended as raw bytes";
  }
  if (compressor != "" && compressor != "vtkZLibDataCompressor" && compressor != "vtkLZ4DataCompressor") {
    return "its values are compressed by " + compressor;
  }
  for (const char* of : { "PointData", "CellData" }) {
    for (vtkXMLDataElement* one : ListNested(this->Piece->FindNestedElementWithName(of), nullptr)) {
      int type = VTK_VOID;
      const bool known = std::strcmp(one->GetName(), "DataArray") == 0 && one->GetWordTypeAttribute("type", type) && type != VTK_BIT;
      if (!known || AttributeOf(one, "format") != "appended") {
        return "the array " + vtkStratusShown(AttributeOf(one, "Name")) + " is not appended as numbers";
      }
    }
  }
  return "";
}

int64_t Document::ReadInteger(vtkXMLDataElement* element, const char* name, int64_t least, int64_t most, int64_t usual) const
{
  const std::string text = AttributeOf(element, name);
  int64_t value = usual;
  if (element->GetAttribute(name) ? !vtkStratusParse(vtkStratusTrimmed(text), value) || value < least || value > most : usual < least) {
    this->Fail("the attribute " + std::string(name) + " of " + element->GetName() + " " + vtkStratusShown(AttributeOf(element, "Name")) +
      " is " + (element->GetAttribute(name) ? vtkStratusShown(text) : "missing") + ", must be an integer from " + std::to_string(least) +
      " to " + std::to_string(most));
  }
  return value;
}

template <class Number, size_t Count>
void Document::ReadNumbers(vtkXMLDataElement* element, const char* name, bool needed, std::array<Number, Count>& to) const
{
  const std::string text = AttributeOf(element, name);
  const std::vector<std::string> words = vtkStratusSplit(text);
  if (!element->GetAttribute(name) && !needed) {
    return;
  }
  bool good = words.size() == Count;
  for (size_t i = 0; good && i < Count; ++i) {
    double value = 0.0;
    good =
      vtkStratusParse(words[i], value) && std::isfinite(value) && (std::is_floating_point_v<Number> || std::fabs(value) <= INT_MAX / 2);
    to[i] = good ? static_cast<Number>(value) : to[i];
    good = good && static_cast<double>(to[i]) == value;
  }
  if (!good) {
    this->Fail("the attribute " + std::string(name) + " is " + (element->GetAttribute(name) ? vtkStratusShown(text) : "missing") +
      ", must be " + std::to_string(Count) + (std::is_floating_point_v<Number> ? " finite numbers" : " integers"));
  }
}

void Document::ReadFrame(vtkStratusXMLImage& image) const
{
  std::array<int, 6> piece;
  this->ReadNumbers(this->Image, "WholeExtent", true, image.Extent);
  this->ReadNumbers(this->Image, "Origin", false, image.Origin);
  this->ReadNumbers(this->Image, "Spacing", false, image.Spacing);
  this->ReadNumbers(this->Image, "Direction", false, image.Direction);
  this->ReadNumbers(this->Piece, "Extent", true, piece);
  for (size_t a = 0; a < 3; ++a) {
    if (image.Extent[2 * a] > image.Extent[2 * a + 1]) {
      image.Fail("the attribute WholeExtent is " + std::to_string(image.Extent[2 * a]) + " to " + std::to_string(image.Extent[2 * a + 1]) +
        " along " + "xyz"[a] + ", must rise");
    }
    if (!(image.Spacing[a] > 0.0)) {
      image.Fail(
        std::string("the attribute Spacing is ") + vtkStratusWriteNumber(image.Spacing[a]) + " along " + "xyz"[a] + ", must be above 0");
    }
  }
  if (piece != image.Extent) {
    image.Fail("the attribute Extent of the piece is " + vtkStratusShown(AttributeOf(this->Piece, "Extent")) + ", must be WholeExtent, " +
      vtkStratusShown(AttributeOf(this->Image, "WholeExtent")));
  }
  double axes[3][3];
  std::copy(image.Direction.begin(), image.Direction.end(), &axes[0][0]);
  if (!(std::fabs(vtkMath::Determinant3x3(axes)) >= Flat)) {
    image.Fail("the axes of the attribute Direction are in one plane, an image needs three directions");
  }
}

vtkStratusXMLArray Document::ReadArray(vtkXMLDataElement* element, bool cells, const vtkStratusXMLImage& image) const
{
  constexpr double most = 0x1p58; // bytes
  vtkStratusXMLArray array;
  array.Name = AttributeOf(element, "Name");
  array.Cells = cells;
  element->GetWordTypeAttribute("type", array.Type);
  array.Components = static_cast<int>(this->ReadInteger(element, "NumberOfComponents", 1, INT_MAX, 1));
  double bytes = static_cast<double>(array.Components) * vtkDataArray::GetDataTypeSize(array.Type);
  for (size_t a = 0; a < 3; ++a) {
    const int64_t count = static_cast<int64_t>(image.Extent[2 * a + 1]) - image.Extent[2 * a];
    array.Sizes[a] = cells ? std::max<int64_t>(count, 1) : count + 1;
    bytes *= static_cast<double>(array.Sizes[a]);
  }
  if (bytes > most) {
    this->Fail("the array " + vtkStratusShown(array.Name) + " has more values than any memory holds");
  }
  if (AttributeOf(element, "IdType") == "1" && vtkDataArray::GetDataTypeSize(array.Type) == static_cast<int>(sizeof(vtkIdType))) {
    array.Type = VTK_ID_TYPE;
  }
  array.Offset = this->Parser->GetAppendedDataPosition() + this->ReadInteger(element, "offset", 0, INT64_MAX / 4, -1);
  for (vtkXMLDataElement* key : ListNested(element, "InformationKey")) {
    if (AttributeOf(key, "name") == "UNITS_LABEL" && key->GetCharacterData()) {
      array.Units = vtkStratusTrimmed(key->GetCharacterData());
    }
  }
  return array;
}

void Document::ReadArrays(bool cells, vtkStratusXMLImage& image) const
{
  vtkXMLDataElement* const data = this->Piece->FindNestedElementWithName(cells ? "CellData" : "PointData");
  for (int i = 0; data && i < vtkDataSetAttributes::NUM_ATTRIBUTES; ++i) {
    image.Active[cells ? 1 : 0][static_cast<size_t>(i)] = AttributeOf(data, vtkDataSetAttributes::GetAttributeTypeAsString(i));
  }
  for (vtkXMLDataElement* one : ListNested(data, nullptr)) {
    image.Arrays.push_back(this->ReadArray(one, cells, image));
  }
}

vtkStratusXMLImage Document::Read() const
{
  const std::string compressor = AttributeOf(this->Root, "compressor");
  vtkStratusXMLImage image;
  image.Path = this->Path;
  if (this->Parser->GetAppendedDataPosition() <= 0) {
    this->Fail("the appended data have no '_' before them");
  }
  image.BigEndian = AttributeOf(this->Root, "byte_order") == "BigEndian"; // the parser has checked both
  image.HeaderBytes = AttributeOf(this->Root, "header_type") == "UInt64" ? 8 : 4;
  image.Compressor = compressor.empty()    ? vtkStratusXMLImage::NONE
    : compressor == "vtkLZ4DataCompressor" ? vtkStratusXMLImage::LZ4
                                           : vtkStratusXMLImage::ZLIB;
  image.HasFieldData = this->Image->FindNestedElementWithName("FieldData") || this->Piece->FindNestedElementWithName("FieldData");
  this->ReadFrame(image);
  this->ReadArrays(false, image);
  this->ReadArrays(true, image);
  return image;
}
} // namespace

bool vtkStratusXMLImage::Swaps() const
{
#ifdef VTK_WORDS_BIGENDIAN
  return !this->BigEndian;
#else
  return this->BigEndian;
#endif
}

std::string vtkStratusWhyNoXMLImage(const std::string& path)
{
  return Document(path).WhyNot();
}

vtkStratusXMLImage vtkStratusReadXMLImage(const std::string& path)
{
  const Document document(path);
  const std::string why = document.WhyNot();
  if (!why.empty()) {
    throw vtkStratusReadError{ path + ": " + why + "; vtkXMLImageDataReader may read it" };
  }
  return document.Read();
}

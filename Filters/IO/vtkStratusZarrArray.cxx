// SPDX-License-Identifier: BSD-3-Clause
// The metadata of vtkStratusZarrArray; its values are read in vtkStratusZarrChunks.cxx.
#include "vtkStratusZarrArray.h"

#include "vtkStratusNetCDFModel.h"
#include "vtkStratusZarrShard.h"

#include "vtkType.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

namespace {
constexpr std::uintmax_t MostJson = std::uintmax_t(1) << 28;
constexpr size_t MostChunk = size_t(1) << 31; // bytes, which blosc and lz4 cannot exceed either
constexpr size_t MostRank = 32;

#ifdef VTK_WORDS_BIGENDIAN
constexpr bool IsBig = true;
#else
constexpr bool IsBig = false;
#endif

std::string Shown(const Json::Value& value)
{
  constexpr size_t most = 60;
  Json::StreamWriterBuilder writer;
  writer["indentation"] = "";
  const std::string text = Json::writeString(writer, value);
  return text.size() > most ? text.substr(0, most) + "..." : text;
}

// Throws std::string, which names the value and the values that are allowed.
[[noreturn]] void Wrong(const char* what, const Json::Value& value, const std::string& expected)
{
  throw std::string(what) + " is " + (value.isNull() ? "missing" : Shown(value)) + ", it must be " + expected;
}

std::string TextOf(const Json::Value& object, const char* key)
{
  const Json::Value& value = object.isObject() ? object[key] : Json::Value::nullSingleton();
  return value.isString() ? value.asString() : "";
}

std::vector<size_t> SizesOf(const char* what, const Json::Value& value, size_t least)
{
  std::vector<size_t> sizes;
  for (const Json::Value& one : value) {
    if (!one.isUInt64() || one.asUInt64() < least || one.asUInt64() > std::numeric_limits<size_t>::max() / 4) {
      Wrong(what, value, "a list of integers of at least " + std::to_string(least));
    }
    sizes.push_back(static_cast<size_t>(one.asUInt64()));
  }
  if (!value.isArray() || sizes.size() > MostRank) {
    Wrong(what, value, "a list of at most " + std::to_string(MostRank) + " integers");
  }
  return sizes;
}

// Returns the product of sizes, or `most` if it is greater.
size_t ProductUpTo(const std::vector<size_t>& sizes, size_t most)
{
  size_t product = 1;
  for (size_t one : sizes) {
    product = one > 0 && product > most / one ? most : product * one;
  }
  return std::min(product, most);
}

// The number that JSON has no word for, or that has the text of its bits. Returns false for other text.
bool SpecialNumber(const std::string& text, size_t bytes, double& number)
{
  if (text == "NaN" || text == "Infinity" || text == "-Infinity") {
    number = text == "NaN" ? std::nan("") : text[0] == '-' ? -HUGE_VAL : HUGE_VAL;
    return true;
  }
  if (text.size() != 2 + 2 * bytes || text.compare(0, 2, "0x") != 0 ||
    text.find_first_not_of("0123456789abcdefABCDEF", 2) != std::string::npos) {
    return false;
  }
  const uint64_t bits = std::strtoull(text.c_str() + 2, nullptr, 16);
  if (bytes == 8) {
    std::memcpy(&number, &bits, 8);
    return true;
  }
  if (bytes == 4) {
    const uint32_t word = static_cast<uint32_t>(bits);
    float real;
    std::memcpy(&real, &word, 4);
    number = real;
    return true;
  }
  number = vtkStratusHalf(static_cast<uint16_t>(bits));
  return bytes == 2;
}

template <class Value> std::vector<char> BytesOf(Value value)
{
  std::vector<char> bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

template <class Value> std::vector<char> BytesOfInteger(const Json::Value& value)
{
  using limits = std::numeric_limits<Value>;
  if (value.isBool()) {
    return BytesOf(static_cast<Value>(value.asBool()));
  }
  const bool fits = limits::is_signed ? value.isInt64() && value.asInt64() >= static_cast<Json::Int64>(limits::min()) &&
      value.asInt64() <= static_cast<Json::Int64>(limits::max())
                                      : value.isUInt64() && value.asUInt64() <= static_cast<Json::UInt64>(limits::max());
  if (!fits) {
    Wrong("fill_value", value, "null or a value of the array's type");
  }
  return BytesOf(limits::is_signed ? static_cast<Value>(value.asInt64()) : static_cast<Value>(value.asUInt64()));
}
} // namespace

bool vtkStratusReadJson(const std::string& path, Json::Value& value)
{
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return false;
  }
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error || bytes > MostJson) {
    throw vtkStratusReadError{ path + ": " +
      (error ? error.message() : "has " + std::to_string(bytes) + " bytes, JSON of at most " + std::to_string(MostJson) + " is read") };
  }
  std::string text(static_cast<size_t>(bytes), ' '), why;
  std::ifstream file(path, std::ios::binary);
  if (!file.read(&text[0], static_cast<std::streamsize>(text.size()))) {
    throw vtkStratusReadError{ path + ": cannot be read" };
  }
  Json::CharReaderBuilder builder;
  builder["collectComments"] = false;
  builder["allowSpecialFloats"] = true; // Python writes NaN
  builder["stackLimit"] = 64;
  const std::unique_ptr<Json::CharReader> reader(builder.newCharReader());
  bool read = false;
  try {
    read = reader->parse(text.data(), text.data() + text.size(), &value, &why);
  } catch (const Json::Exception& exception) { // of nesting
    why = exception.what();
  }
  if (!read || !value.isObject()) {
    std::replace(why.begin(), why.end(), '\n', ' ');
    throw vtkStratusReadError{ path + ": is no object of JSON" + (why.empty() ? "" : ": " + why) };
  }
  return true;
}

vtkStratusZarrArray::vtkStratusZarrArray(const std::string& folder, const Json::Value& metadata, const Json::Value& attributes)
    : Folder(folder), Attributes(attributes.isObject() ? attributes : Json::Value(Json::objectValue))
{
  try {
    if (metadata["zarr_format"] == 2) {
      this->MetadataFiles = { ".zarray", ".zattrs" };
      this->ReadVersion2(metadata);
    } else {
      this->MetadataFiles = { "zarr.json" };
      this->ReadVersion3(metadata);
    }
    this->CheckSizes();
  } catch (const std::string& why) {
    this->Fault = why;
  } catch (const Json::Exception& why) {
    this->Fault = std::string("its metadata are not as the format says: ") + why.what();
  }
  const size_t rank = this->Shape.size();
  if (this->Chunk.size() != rank) {
    this->SetFault("chunks have " + std::to_string(this->Chunk.size()) + " dimensions, the array has " + std::to_string(rank));
    this->Chunk = this->Shape;
  }
  this->Type = this->Type == 0 ? static_cast<int>(vtkStratusNetCDFOther) : this->Type;
  this->Names.resize(rank);
  std::set<std::string> there;
  for (std::string& name : this->Names) { // a name that comes twice names no dimension
    name = there.insert(name).second ? name : "";
  }
}

void vtkStratusZarrArray::ReadVersion2(const Json::Value& metadata)
{
  this->ReadNames(std::as_const(this->Attributes)["_ARRAY_DIMENSIONS"]);
  this->Shape = SizesOf("shape", metadata["shape"], 0);
  this->Chunk = this->Shard = SizesOf("chunks", metadata["chunks"], 1);
  this->ReadType2(metadata["dtype"]);
  this->ReadFill(metadata["fill_value"]);
  this->Missing = this->Names.empty() ? Json::Value() : metadata["fill_value"];
  const std::string order = TextOf(metadata, "order"), separator = TextOf(metadata, "dimension_separator");
  if (order != "C" && order != "F") {
    Wrong("order", metadata["order"], "\"C\" or \"F\"");
  }
  this->Order.resize(this->Chunk.size());
  std::iota(this->Order.begin(), this->Order.end(), 0);
  if (order == "F") {
    std::reverse(this->Order.begin(), this->Order.end());
  }
  if (!metadata["dimension_separator"].isNull() && separator != "." && separator != "/") {
    Wrong("dimension_separator", metadata["dimension_separator"], "\".\" or \"/\"");
  }
  this->Separator = separator.empty() ? '.' : separator[0];
  if (!metadata["compressor"].isNull()) {
    this->AddCodec(TextOf(metadata["compressor"], "id"), metadata["compressor"]);
  }
  const Json::Value& filters = metadata["filters"];
  for (Json::ArrayIndex i = filters.isArray() ? filters.size() : 0; i-- > 0;) {
    this->AddCodec(TextOf(filters[i], "id"), filters[i]);
  }
}

void vtkStratusZarrArray::ReadVersion3(const Json::Value& metadata)
{
  static const std::set<std::string> known = { "zarr_format", "node_type", "shape", "data_type", "chunk_grid", "chunk_key_encoding",
    "fill_value", "codecs", "attributes", "storage_transformers", "dimension_names", "consolidated_metadata" };
  this->ReadNames(metadata["dimension_names"]);
  this->Shape = SizesOf("shape", metadata["shape"], 0);
  const Json::Value& grid = metadata["chunk_grid"];
  if (TextOf(grid, "name") != "regular") {
    Wrong("chunk_grid", grid, "of the name \"regular\"");
  }
  this->Chunk = this->Shard = SizesOf("chunk_shape", grid["configuration"]["chunk_shape"], 1);
  this->ReadType3(metadata["data_type"]);
  this->ReadFill(metadata["fill_value"]);
  this->ReadKeys3(metadata["chunk_key_encoding"]);
  this->Order.resize(this->Chunk.size());
  std::iota(this->Order.begin(), this->Order.end(), 0);
  this->ReadCodecs3(metadata["codecs"], false);
  if (metadata["storage_transformers"].isArray() && !metadata["storage_transformers"].empty()) {
    throw "storage transformers are not read: " + Shown(metadata["storage_transformers"]);
  }
  for (const std::string& name : metadata.getMemberNames()) {
    const Json::Value& value = metadata[name];
    if (known.count(name) == 0 && !(value.isObject() && value["must_understand"].isBool() && !value["must_understand"].asBool())) {
      throw "the extension '" + name + "' of the metadata is not known, and not said to be optional";
    }
  }
}

void vtkStratusZarrArray::ReadNames(const Json::Value& names)
{
  for (Json::ArrayIndex i = 0; names.isArray() && i < names.size(); ++i) {
    this->Names.push_back(names[i].isString() ? names[i].asString() : "");
  }
}

// kind: 'b', 'i', 'u' or 'f'.
void vtkStratusZarrArray::SetType(char kind, size_t bytes)
{
  static constexpr struct {
    char Kind;
    size_t Bytes;
    int Type;
  } types[] = { { 'b', 1, vtkStratusNetCDFUInt8 }, { 'i', 1, vtkStratusNetCDFInt8 }, { 'i', 2, vtkStratusNetCDFInt16 },
    { 'i', 4, vtkStratusNetCDFInt32 }, { 'i', 8, vtkStratusNetCDFInt64 }, { 'u', 1, vtkStratusNetCDFUInt8 },
    { 'u', 2, vtkStratusNetCDFUInt16 }, { 'u', 4, vtkStratusNetCDFUInt32 }, { 'u', 8, vtkStratusNetCDFUInt64 },
    { 'f', 2, vtkStratusNetCDFFloat32 }, { 'f', 4, vtkStratusNetCDFFloat32 }, { 'f', 8, vtkStratusNetCDFFloat64 } };
  for (const auto& one : types) {
    if (one.Kind == kind && one.Bytes == bytes) {
      this->Type = one.Type;
      this->StoredBytes = bytes;
      this->Half = kind == 'f' && bytes == 2;
      this->ValueBytes = this->Half ? sizeof(float) : bytes;
    }
  }
}

// "<f4": the order of bytes, the kind, and the bytes of a value.
void vtkStratusZarrArray::ReadType2(const Json::Value& type)
{
  const std::string text = type.isString() ? type.asString() : "";
  if (text.size() == 3 && std::strchr("<>|", text[0]) && text[2] >= '1' && text[2] <= '8') {
    this->SetType(text[1], static_cast<size_t>(text[2] - '0'));
    this->Swapped = this->StoredBytes > 1 && (text[0] == '>') != IsBig;
  }
  if (this->Type == 0) {
    Wrong("dtype", type, "a type of booleans, integers or reals of 1 to 8 bytes to be read, such as \"<f4\"");
  }
}

void vtkStratusZarrArray::ReadType3(const Json::Value& type)
{
  const std::string text = type.isString() ? type.asString() : "";
  const size_t digits = text.find_first_of("0123456789");
  const std::string kind = text.substr(0, digits), bits = digits == std::string::npos ? "" : text.substr(digits);
  if (text == "bool") {
    this->SetType('b', 1);
  } else if ((kind == "int" || kind == "uint" || kind == "float") && (bits == "8" || bits == "16" || bits == "32" || bits == "64")) {
    this->SetType(kind[0], static_cast<size_t>(std::stoi(bits)) / 8);
  }
  if (this->Type == 0) {
    Wrong("data_type", type, "\"bool\" or a type of integers or reals of 8 to 64 bits to be read, such as \"float32\"");
  }
}

void vtkStratusZarrArray::ReadFill(const Json::Value& value)
{
  if (value.isNull()) { // undefined
    this->Fill.assign(this->ValueBytes, 0);
    return;
  }
  double real = 0.0;
  switch (this->Type) {
    case vtkStratusNetCDFInt8:
      this->Fill = BytesOfInteger<int8_t>(value);
      return;
    case vtkStratusNetCDFInt16:
      this->Fill = BytesOfInteger<int16_t>(value);
      return;
    case vtkStratusNetCDFInt32:
      this->Fill = BytesOfInteger<int32_t>(value);
      return;
    case vtkStratusNetCDFInt64:
      this->Fill = BytesOfInteger<int64_t>(value);
      return;
    case vtkStratusNetCDFUInt8:
      this->Fill = BytesOfInteger<uint8_t>(value);
      return;
    case vtkStratusNetCDFUInt16:
      this->Fill = BytesOfInteger<uint16_t>(value);
      return;
    case vtkStratusNetCDFUInt32:
      this->Fill = BytesOfInteger<uint32_t>(value);
      return;
    case vtkStratusNetCDFUInt64:
      this->Fill = BytesOfInteger<uint64_t>(value);
      return;
    default:
      if (value.isNumeric()) {
        real = value.asDouble();
      } else if (!value.isString() || !SpecialNumber(value.asString(), this->StoredBytes, real)) {
        Wrong("fill_value", value, "null or a number");
      }
      this->Fill = this->Type == vtkStratusNetCDFFloat32 ? BytesOf(static_cast<float>(real)) : BytesOf(real);
  }
}

void vtkStratusZarrArray::ReadKeys3(const Json::Value& encoding)
{
  const std::string name = TextOf(encoding, "name"), separator = TextOf(encoding["configuration"], "separator");
  if ((name != "default" && name != "v2") || (!separator.empty() && separator != "." && separator != "/")) {
    Wrong("chunk_key_encoding", encoding, "of the name \"default\" or \"v2\", with the separator \".\" or \"/\"");
  }
  this->Separator = !separator.empty() ? separator[0] : name == "v2" ? '.' : '/';
  this->Prefix = name == "v2" ? "" : "c";
}

// inner: of the chunks of a shard.
void vtkStratusZarrArray::ReadCodecs3(const Json::Value& codecs, bool inner)
{
  bool is_bytes = false;
  for (Json::ArrayIndex i = 0; codecs.isArray() && i < codecs.size(); ++i) {
    const Json::Value& configuration = codecs[i].isObject() ? codecs[i]["configuration"] : Json::Value::nullSingleton();
    const std::string name = codecs[i].isString() ? codecs[i].asString() : TextOf(codecs[i], "name");
    if (name == "transpose" && !is_bytes) {
      const std::vector<size_t> order = SizesOf("order of transpose", configuration["order"], 0), before = this->Order;
      std::vector<size_t> sorted = order, all(before.size());
      std::sort(sorted.begin(), sorted.end());
      std::iota(all.begin(), all.end(), 0);
      if (sorted != all) {
        Wrong("order of transpose", configuration["order"], "each dimension once");
      }
      std::transform(order.begin(), order.end(), this->Order.begin(), [&before](size_t a) { return before[a]; });
    } else if (name == "bytes" && !is_bytes) {
      const std::string endian = TextOf(configuration, "endian");
      if (endian != "little" && endian != "big" && this->StoredBytes > 1) {
        Wrong("endian of bytes", configuration["endian"], "\"little\" or \"big\"");
      }
      this->Swapped = this->StoredBytes > 1 && (endian == "big") != IsBig;
      is_bytes = true;
    } else if (name == "sharding_indexed" && !is_bytes && !inner) {
      if (i > 0 || codecs.size() > 1) {
        throw std::string("codecs before or after 'sharding_indexed' are not read");
      }
      this->ReadSharding(configuration);
      return;
    } else {
      const size_t before = this->Codecs.size();
      this->AddCodec(name, configuration);
      if (!is_bytes && this->Codecs.size() > before) {
        throw "the codec '" + name + "' comes before 'bytes'";
      }
    }
  }
  if (!is_bytes) {
    Wrong("codecs", codecs, "a list of codecs with 'bytes' in it");
  }
  std::reverse(this->Codecs.begin(), this->Codecs.end());
}

void vtkStratusZarrArray::ReadSharding(const Json::Value& configuration)
{
  const std::vector<size_t> chunk = SizesOf("chunk_shape of sharding_indexed", configuration["chunk_shape"], 1);
  constexpr size_t most = size_t(1) << 32;
  bool divides = chunk.size() == this->Shard.size();
  std::vector<size_t> many;
  for (size_t a = 0; divides && a < chunk.size(); ++a) {
    divides = this->Shard[a] % chunk[a] == 0;
    many.push_back(this->Shard[a] / chunk[a]);
  }
  if (!divides || ProductUpTo(many, most) >= most) {
    Wrong("chunk_shape of sharding_indexed", configuration["chunk_shape"], "divisors of the shards' sizes, for fewer than 2^32 chunks");
  }
  this->Chunk = chunk;
  this->IsSharded = true;
  this->ReadCodecs3(configuration["codecs"], true);
  const std::string location = TextOf(configuration, "index_location");
  if (!location.empty() && location != "start" && location != "end") {
    Wrong("index_location", configuration["index_location"], "\"start\" or \"end\"");
  }
  this->IndexFirst = location == "start";
  for (const Json::Value& codec : configuration["index_codecs"]) {
    const std::string name = TextOf(codec, "name");
    this->IndexSum = this->IndexSum || name == "crc32c";
    if ((name != "bytes" || TextOf(codec["configuration"], "endian") != "little") && name != "crc32c") {
      throw "index_codecs of sharding_indexed are read if they are 'bytes', little, and 'crc32c'; there is " + Shown(codec);
    }
  }
  this->Index = std::make_shared<ShardIndex>();
}

void vtkStratusZarrArray::AddCodec(const std::string& name, const Json::Value& configuration)
{
  const Json::Value& element = configuration.isObject() ? configuration["elementsize"] : Json::Value::nullSingleton();
  const size_t bytes = element.isUInt() && element.asUInt() > 0 ? element.asUInt() : this->StoredBytes;
  vtkStratusZarrCodec codec;
  if (vtkStratusFindZarrCodec(name, TextOf(configuration, "cname"), bytes, codec)) {
    this->Codecs.push_back(codec);
  }
}

void vtkStratusZarrArray::CheckSizes()
{
  const size_t chunk = ProductUpTo(this->Chunk, MostChunk);
  if (chunk >= MostChunk / std::max<size_t>(this->ValueBytes, 1)) {
    throw "a chunk has " + std::to_string(MostChunk) + " bytes or more, which is more than is read at once";
  }
  constexpr size_t most = std::numeric_limits<size_t>::max() / 64;
  if (ProductUpTo(this->Shape, most) >= most) {
    throw std::string("the array has more values than can be counted");
  }
  this->ChunkBytes = chunk * this->StoredBytes;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusImageValues.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"
#include "vtkSetGet.h"

#include "vtk_zlib.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>

namespace {
constexpr size_t BufferBytes = size_t(1) << 18;
constexpr int64_t StepBytes = int64_t(1) << 24; // between two reports of progress
constexpr int64_t MostInflated = 1040;          // bytes that deflate makes of one, at most (1032), and some

// A file that is read from its begin to its end.
class Input
{
public:
  explicit Input(const std::string& path) : Path(path), File(std::fopen(path.c_str(), "rb"))
  {
    if (!this->File) {
      this->Fail(std::strerror(errno));
    }
  }
  ~Input() { std::fclose(this->File); }
  Input(const Input&) = delete;
  void operator=(const Input&) = delete;

  [[noreturn]] void Fail(const std::string& why) const { throw vtkStratusReadError{ this->Path + ": " + why }; }

  size_t Read(char* to, size_t count)
  {
    const size_t got = std::fread(to, 1, count, this->File);
    if (got < count && std::ferror(this->File)) {
      this->Fail(std::strerror(errno));
    }
    return got;
  }

  void Skip(int64_t count)
  {
    if (fseeko(this->File, static_cast<off_t>(count), SEEK_CUR) != 0) {
      this->Fail(std::strerror(errno));
    }
  }

  void SkipLines(int64_t count)
  {
    for (int64_t i = 0; i < count;) {
      const int c = std::fgetc(this->File);
      if (c == EOF) {
        this->Fail("has " + std::to_string(i) + " lines before its end, line skip is " + std::to_string(count));
      }
      i += c == '\n' ? 1 : 0;
    }
  }

  int64_t GetPlace() const { return static_cast<int64_t>(ftello(this->File)); }

private:
  std::string Path;
  std::FILE* File;
};

class RawBytes : public vtkStratusImageBytes
{
public:
  RawBytes(const vtkStratusImageFile& file, const std::string& path, int64_t bytes) : In(path)
  {
    std::error_code error;
    const int64_t length = static_cast<int64_t>(std::filesystem::file_size(path, error));
    this->In.Skip(file.HeaderBytes);
    this->In.SkipLines(file.LineSkip);
    this->In.Skip(file.ByteSkip < 0 ? length - bytes - this->In.GetPlace() : file.ByteSkip);
    const int64_t begin = this->In.GetPlace();
    if (!error && length - begin < bytes) {
      this->In.Fail("has " + std::to_string(std::max<int64_t>(length - begin, 0)) + " bytes of values, must have " + std::to_string(bytes));
    }
  }
  void Next(char* to, int64_t values, size_t size) override
  {
    const size_t bytes = static_cast<size_t>(values) * size;
    if (this->In.Read(to, bytes) < bytes) {
      this->In.Fail("ends before the last of its values");
    }
  }
  void Skip(int64_t values, size_t size) override { this->In.Skip(values * static_cast<int64_t>(size)); }

private:
  Input In;
};

// Streams of zlib and gzip, also several ones of gzip one behind the other, which are one.
class InflatedBytes : public vtkStratusImageBytes
{
public:
  InflatedBytes(const std::string& path, int64_t header, int64_t lines) : In(path), Buffer(BufferBytes)
  {
    constexpr int zlib_or_gzip = 32;
    this->In.Skip(header);
    this->In.SkipLines(lines);
    if (inflateInit2(&this->Stream, MAX_WBITS + zlib_or_gzip) != Z_OK) {
      throw std::bad_alloc();
    }
  }
  ~InflatedBytes() override { inflateEnd(&this->Stream); }

  // Returns fewer than `count` bytes only at the stream's end.
  size_t Inflate(char* to, size_t count)
  {
    size_t done = 0;
    while (done < count && !this->AtEnd) {
      const size_t part = std::min<size_t>(count - done, std::numeric_limits<uInt>::max());
      this->Stream.next_out = reinterpret_cast<Bytef*>(to + done);
      this->Stream.avail_out = static_cast<uInt>(part);
      if (this->Stream.avail_in == 0 && !this->Fill()) {
        this->In.Fail("the compressed values end early: the file is cut short");
      }
      const int result = inflate(&this->Stream, Z_NO_FLUSH);
      done += part - this->Stream.avail_out;
      if (result == Z_STREAM_END) {
        this->AtEnd = !this->HasAnother() || inflateReset(&this->Stream) != Z_OK;
      } else if (result != Z_OK && result != Z_BUF_ERROR) {
        this->In.Fail(
          std::string("the compressed values are damaged: ") + (this->Stream.msg ? this->Stream.msg : "zlib can't inflate them"));
      }
    }
    return done;
  }

  void Next(char* to, int64_t values, size_t size) override
  {
    const size_t bytes = static_cast<size_t>(values) * size, got = this->Inflate(to, bytes);
    if (got < bytes) {
      this->In.Fail("inflates to fewer values than the header requires");
    }
  }
  void Skip(int64_t values, size_t size) override
  {
    std::vector<char> away(BufferBytes);
    for (int64_t left = values * static_cast<int64_t>(size); left > 0;) {
      const int64_t part = std::min<int64_t>(left, BufferBytes);
      this->Next(away.data(), part, 1);
      left -= part;
    }
  }

private:
  bool Fill()
  {
    this->Stream.next_in = reinterpret_cast<Bytef*>(this->Buffer.data());
    this->Stream.avail_in = static_cast<uInt>(this->In.Read(this->Buffer.data(), this->Buffer.size()));
    return this->Stream.avail_in > 0;
  }
  bool HasAnother() { return (this->Stream.avail_in > 0 || this->Fill()) && this->Stream.next_in[0] == 0x1f; }

  Input In;
  std::vector<char> Buffer;
  z_stream Stream = {};
  bool AtEnd = false;
};

// Numbers with blanks or commas between them.
class TextBytes : public vtkStratusImageBytes
{
public:
  TextBytes(const vtkStratusImageFile& file, const std::string& path) : Type(file.Type), In(path), Buffer(BufferBytes)
  {
    this->In.Skip(file.HeaderBytes);
    this->In.SkipLines(file.LineSkip);
    this->In.Skip(std::max<int64_t>(file.ByteSkip, 0));
  }
  void Next(char* to, int64_t values, size_t) override
  {
    switch (this->Type) {
      vtkTemplateMacro(this->Parse(reinterpret_cast<VTK_TT*>(to), values));
    }
  }
  void Skip(int64_t values, size_t) override
  {
    for (int64_t i = 0; i < values; ++i) {
      this->NextWord();
    }
  }

private:
  int NextCharacter()
  {
    if (this->Begin == this->End) {
      this->Begin = 0;
      this->End = this->In.Read(this->Buffer.data(), this->Buffer.size());
    }
    return this->Begin < this->End ? static_cast<unsigned char>(this->Buffer[this->Begin++]) : EOF;
  }
  const std::string& NextWord()
  {
    constexpr size_t longest = 512;
    const auto separates = [](int c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); };
    int c = this->NextCharacter();
    while (separates(c)) {
      c = this->NextCharacter();
    }
    this->Word.clear();
    for (; c != EOF && !separates(c) && this->Word.size() < longest; c = this->NextCharacter()) {
      this->Word += static_cast<char>(c);
    }
    if (this->Word.empty()) {
      this->In.Fail("ends after " + std::to_string(this->Count) + " values, must have more");
    }
    ++this->Count;
    return this->Word;
  }
  template <class T> void Parse(T* to, int64_t values)
  {
    for (int64_t i = 0; i < values; ++i) {
      const std::string& word = this->NextWord();
      const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
      const char* const end = word.data() + word.size();
      T value{};
      std::from_chars_result result;
      if constexpr (sizeof(T) == 1) { // from_chars() takes a char for a number, too, but not every library's
        int wide = 0;
        result = std::from_chars(word.data() + (plus ? 1 : 0), end, wide);
        value = static_cast<T>(wide);
        if (result.ec == std::errc() && static_cast<int>(value) != wide) {
          result.ec = std::errc::result_out_of_range;
        }
      } else {
        result = std::from_chars(word.data() + (plus ? 1 : 0), end, value);
      }
      if (result.ec != std::errc() || result.ptr != end) {
        this->In.Fail("value " + std::to_string(this->Count) + " is " + vtkStratusShown(word) +
          (result.ec == std::errc::result_out_of_range ? ", out of the range of " : ", must be ") +
          vtkImageScalarTypeNameMacro(this->Type));
      }
      to[i] = value;
    }
  }

  int Type;
  Input In;
  std::vector<char> Buffer;
  size_t Begin = 0, End = 0;
  std::string Word;
  int64_t Count = 0;
};
} // namespace

vtkStratusImageValues::vtkStratusImageValues(const vtkStratusImageFile& file, const std::function<void(double)>& progress)
    : File(file), Progress(progress), Size(static_cast<size_t>(vtkDataArray::GetDataTypeSize(file.Type))), All(file.CountValues()),
      PerFile(All / static_cast<int64_t>(file.Files.size()))
{
  for (const std::string& path : file.Files) {
    this->CheckLength(path);
  }
}

vtkStratusImageValues::~vtkStratusImageValues() = default;

void vtkStratusImageValues::CheckLength(const std::string& path) const
{
  const auto fail = [&path](const std::string& why) { throw vtkStratusReadError{ path + ": " + why }; };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    fail("there is no such file" + (path == this->File.Path ? "" : ", which " + this->File.Path + " names"));
  }
  if (!std::filesystem::is_regular_file(status)) {
    fail("is no regular file");
  }
  const int64_t length = static_cast<int64_t>(std::filesystem::file_size(path, error)), there = length - this->File.HeaderBytes;
  const int64_t bytes = this->PerFile * static_cast<int64_t>(this->Size), skip = std::max<int64_t>(this->File.ByteSkip, 0);
  const bool fits = this->File.Encoding == vtkStratusImageFile::RAW ? there - skip >= bytes
    : this->File.Encoding == vtkStratusImageFile::DEFLATE           ? there >= (bytes + skip) / MostInflated
                                                                    : (there - skip + 1) / 2 >= this->PerFile;
  if (error || !fits) {
    fail("has " + std::to_string(std::max<int64_t>(there - skip, 0)) + " bytes, which can't be the " + std::to_string(this->PerFile) +
      " values of " + std::to_string(this->Size) + " bytes that the header requires");
  }
}

template <class Work> void vtkStratusImageValues::Walk(int64_t values, const Work& work)
{
  const int64_t step = std::max<int64_t>(StepBytes / static_cast<int64_t>(this->Size), 1);
  for (int64_t before = 0; before < values;) {
    const int64_t index = this->Done / this->PerFile, within = this->Done % this->PerFile;
    if (within == 0) {
      const std::string& path = this->File.Files[static_cast<size_t>(index)];
      const int64_t bytes = this->PerFile * static_cast<int64_t>(this->Size);
      this->Bytes.reset();
      if (this->File.Encoding == vtkStratusImageFile::RAW) {
        this->Bytes = std::make_unique<RawBytes>(this->File, path, bytes);
      } else if (this->File.Encoding == vtkStratusImageFile::TEXT) {
        this->Bytes = std::make_unique<TextBytes>(this->File, path);
      } else {
        this->Bytes = std::make_unique<InflatedBytes>(path, this->File.HeaderBytes, this->File.LineSkip);
        this->Bytes->Skip(this->File.ByteSkip, 1);
      }
    }
    const int64_t part = std::min({ values - before, this->PerFile - within, step });
    work(part, before);
    before += part;
    this->Done += part;
    this->Progress(static_cast<double>(this->Done) / static_cast<double>(this->All));
  }
}

void vtkStratusImageValues::Next(void* to, int64_t values)
{
  const bool swaps = this->File.Encoding != vtkStratusImageFile::TEXT;
  this->Walk(values, [&](int64_t part, int64_t before) {
    char* const at = static_cast<char*>(to) + static_cast<size_t>(before) * this->Size;
    this->Bytes->Next(at, part, this->Size);
    const size_t count = static_cast<size_t>(part);
    if (swaps && this->Size == 2) {
      this->File.BigEndian ? vtkByteSwap::Swap2BERange(at, count) : vtkByteSwap::Swap2LERange(at, count);
    } else if (swaps && this->Size == 4) {
      this->File.BigEndian ? vtkByteSwap::Swap4BERange(at, count) : vtkByteSwap::Swap4LERange(at, count);
    } else if (swaps && this->Size == 8) {
      this->File.BigEndian ? vtkByteSwap::Swap8BERange(at, count) : vtkByteSwap::Swap8LERange(at, count);
    }
  });
}

void vtkStratusImageValues::Skip(int64_t values)
{
  this->Walk(values, [this](int64_t part, int64_t) { this->Bytes->Skip(part, this->Size); });
}

std::string vtkStratusReadStart(const std::string& path, size_t count)
{
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw vtkStratusReadError{ path + ": there is no such file" };
  }
  std::string start(count, '\0');
  Input in(path);
  start.resize(in.Read(start.data(), count));
  if (start.compare(0, 2, "\x1f\x8b") == 0) {
    start.assign(count, '\0');
    InflatedBytes inflated(path, 0, 0);
    start.resize(inflated.Inflate(start.data(), count));
  }
  return start;
}

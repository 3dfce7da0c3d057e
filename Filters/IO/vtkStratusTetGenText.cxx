// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenText.h"

#include "vtkErrorCode.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <locale>
#include <sstream>
#include <system_error>

namespace {
const size_t ChunkBytes = size_t(1) << 20;
const vtkIdType SmallCount = 1000000;     // numbers to allocate before the file's size is checked
const size_t LineBytes = size_t(1) << 26; // far above TetGen's lines, because a binary file may be one line

bool IsBlank(char c)
{
  return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\v' || c == '\f';
}

// A token in printable form, for a message.
std::string Shown(std::string_view token)
{
  std::string shown(token.substr(0, 40));
  std::replace_if(
    shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown + (token.size() > 40 ? "..." : "");
}

// Parses a whole token. It skips a plus sign, which from_chars refuses.
template <typename T> std::errc Parse(std::string_view token, T& value)
{
  const char* end = token.data() + token.size();
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-';
  const std::from_chars_result result = std::from_chars(token.data() + (plus ? 1 : 0), end, value);
  return result.ec == std::errc() && result.ptr != end ? std::errc::invalid_argument : result.ec;
}
} // namespace

vtkStratusTetGenInput::vtkStratusTetGenInput(const std::string& path, const vtkStratusTetGenProgress& progress)
    : Path(path), Progress(progress)
{
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw vtkStratusTetGenError{ "there is no file " + path, vtkErrorCode::FileNotFoundError };
  }
  if (!std::filesystem::is_regular_file(status)) { // the size bounds allocations
    throw vtkStratusTetGenError{ path + " is not a regular file", vtkErrorCode::CannotOpenFileError };
  }
  this->Size = std::filesystem::file_size(path, error);
  this->Buffer.resize(ChunkBytes);
  this->File = error ? nullptr : std::fopen(path.c_str(), "rb");
  if (!this->File) {
    throw vtkStratusTetGenError{ "can't open " + path + ": " + std::strerror(errno), vtkErrorCode::CannotOpenFileError };
  }
}

vtkStratusTetGenInput::~vtkStratusTetGenInput()
{
  if (this->File) {
    std::fclose(this->File);
  }
}

void vtkStratusTetGenInput::Fail(const std::string& text) const
{
  throw vtkStratusTetGenError{ this->Path + ", line " + std::to_string(this->Line) + ": " + text, vtkErrorCode::FileFormatError };
}

void vtkStratusTetGenInput::FailEarly(const std::string& text) const
{
  throw vtkStratusTetGenError{ this->Path + " ends after line " + std::to_string(this->Line) + ": " + text,
    vtkErrorCode::PrematureEndOfFileError };
}

// Moves the unread bytes to the buffer's start and reads more behind them. Returns false at the end of the file.
bool vtkStratusTetGenInput::Fill()
{
  if (this->AtEnd) {
    return false;
  }
  std::copy(this->Buffer.begin() + static_cast<std::ptrdiff_t>(this->Begin), this->Buffer.begin() + static_cast<std::ptrdiff_t>(this->End),
    this->Buffer.begin());
  this->End -= this->Begin;
  this->Begin = 0;
  if (this->End == this->Buffer.size()) {
    if (this->Buffer.size() >= LineBytes) {
      ++this->Line;
      this->Fail("the line is longer than " + std::to_string(LineBytes) + " bytes");
    }
    this->Buffer.resize(2 * this->Buffer.size());
  }
  const size_t read = std::fread(this->Buffer.data() + this->End, 1, this->Buffer.size() - this->End, this->File);
  if (std::ferror(this->File)) {
    throw vtkStratusTetGenError{ "can't read " + this->Path + ": " + std::strerror(errno), vtkErrorCode::UnknownError };
  }
  this->AtEnd = read == 0;
  this->End += read;
  this->Progress(read);
  return read > 0;
}

void vtkStratusTetGenInput::Skip()
{
  size_t blanks = 0;
  while (blanks < this->Rest.size() && IsBlank(this->Rest[blanks])) {
    ++blanks;
  }
  this->Rest.remove_prefix(blanks);
}

bool vtkStratusTetGenInput::NextLine()
{
  for (;;) {
    const char* begin = this->Buffer.data() + this->Begin;
    const size_t available = this->End - this->Begin;
    const char* newline = available ? static_cast<const char*>(std::memchr(begin, '\n', available)) : nullptr;
    if (!newline && this->Fill()) {
      continue;
    }
    if (!newline && this->Begin == this->End) {
      return false;
    }
    begin = this->Buffer.data() + this->Begin; // the last line may lack a newline, and Fill() moves the buffer
    const size_t length = newline ? static_cast<size_t>(newline - begin) : this->End - this->Begin;
    this->Begin += length + (newline ? 1 : 0);
    this->Consumed += length + (newline ? 1 : 0);
    ++this->Line;
    this->Rest = std::string_view(begin, length);
    this->Rest = this->Rest.substr(0, this->Rest.find('#'));
    this->Skip();
    if (!this->Rest.empty()) {
      return true;
    }
  }
}

void vtkStratusTetGenInput::NeedLine(const char* things, vtkIdType done, vtkIdType all)
{
  if (!this->NextLine()) {
    this->FailEarly("it holds " + std::to_string(done) + " of " + std::to_string(all) + " " + things);
  }
}

int vtkStratusTetGenInput::GetNumbersLeft() const
{
  int numbers = 0;
  bool blank = true;
  for (const char c : this->Rest) {
    numbers += blank && !IsBlank(c) ? 1 : 0;
    blank = IsBlank(c);
  }
  return numbers;
}

std::string_view vtkStratusTetGenInput::Next(const char* name)
{
  if (this->Rest.empty()) {
    this->Fail(std::string("the line ends where ") + name + " must be");
  }
  size_t length = 0;
  while (length < this->Rest.size() && !IsBlank(this->Rest[length])) {
    ++length;
  }
  const std::string_view token = this->Rest.substr(0, length);
  this->Rest.remove_prefix(length);
  this->Skip();
  return token;
}

vtkIdType vtkStratusTetGenInput::GetInteger(const char* name, vtkIdType lower, vtkIdType upper)
{
  const std::string_view token = this->Next(name);
  vtkIdType value = 0;
  if (Parse(token, value) != std::errc() || value < lower || value > upper) {
    const std::string allowed = lower == upper ? std::to_string(lower)
      : lower < upper                          ? "an integer from " + std::to_string(lower) + " to " + std::to_string(upper)
                                               : "none at all";
    this->Fail(std::string(name) + " is '" + Shown(token) + "', it must be " + allowed);
  }
  return value;
}

double vtkStratusTetGenInput::GetReal(const char* name)
{
  const std::string_view token = this->Next(name);
  double value = 0.0;
  const std::errc error = Parse(token, value);
  if (error == std::errc::result_out_of_range) { // a number too small for double is 0, one too large stays an error
    std::istringstream stream{ std::string(token) };
    stream.imbue(std::locale::classic()); // strtod() would look for the decimal comma of the process's locale
    stream >> value;
  }
  if (error == std::errc::invalid_argument || (error == std::errc::result_out_of_range && !(std::abs(value) < 1.0))) {
    this->Fail(std::string(name) + " is '" + Shown(token) + "', it must be a number of double precision");
  }
  return value;
}

double vtkStratusTetGenInput::GetFinite(const char* name)
{
  const double value = this->GetReal(name);
  if (!std::isfinite(value)) {
    this->Fail(std::string(name) + " is " + std::to_string(value) + ", it must be finite");
  }
  return value;
}

vtkIdType vtkStratusTetGenInput::GetCount(const char* name, vtkIdType numbers)
{
  const vtkIdType count = this->GetInteger(name, 0, VTK_ID_MAX);
  this->CheckCount(name, count, numbers);
  return count;
}

void vtkStratusTetGenInput::CheckCount(const char* name, vtkIdType count, vtkIdType numbers) const
{
  // Each number takes a digit and a separator; the very last may lack the separator.
  const std::uintmax_t bytes = this->Size - std::min(this->Size, this->Consumed) + this->Rest.size() + 1;
  const vtkIdType room = static_cast<vtkIdType>(bytes / 2) / numbers;
  // A small count passes in a file that is too short, because NeedLine() then reports how many lines there are.
  if (count > room && count > SmallCount / numbers) {
    this->Fail(std::string(name) + " is " + std::to_string(count) + ", but the rest of the file, of " + std::to_string(this->Size) +
      " bytes, can hold no more than " + std::to_string(room));
  }
}

void vtkStratusTetGenInput::EndLine()
{
  if (!this->Rest.empty()) {
    this->Fail("there is more on the line than expected: '" + Shown(this->Rest) + "'");
  }
}

void vtkStratusTetGenInput::EndFile(const char* things, vtkIdType all)
{
  if (this->NextLine()) {
    this->Fail("there is more than the " + std::to_string(all) + " " + things + " that the file announces: '" + Shown(this->Rest) + "'");
  }
}

vtkStratusTetGenOutput::vtkStratusTetGenOutput(const std::string& path, const vtkStratusTetGenProgress& progress)
    : Path(path), Progress(progress)
{
  this->Buffer.reserve(ChunkBytes + 64);
  if (const int reason = this->File.Open(path)) {
    throw vtkStratusTetGenError{ "can't open " + path + ": " + std::strerror(reason), vtkErrorCode::CannotOpenFileError };
  }
}

void vtkStratusTetGenOutput::Fail(const char* doing, int reason) const
{
  throw vtkStratusTetGenError{ std::string("can't ") + doing + " " + this->Path + ": " + std::strerror(reason),
    reason == ENOSPC ? vtkErrorCode::OutOfDiskSpaceError : vtkErrorCode::UnknownError };
}

void vtkStratusTetGenOutput::Put(vtkIdType value)
{
  char text[32];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  this->Buffer.append(text, result.ptr);
  this->Buffer += ' ';
}

void vtkStratusTetGenOutput::Put(double value)
{
  char text[32];
  const std::to_chars_result result = std::to_chars(text, text + sizeof text, value);
  this->Buffer.append(text, result.ptr);
  this->Buffer += ' ';
}

void vtkStratusTetGenOutput::EndLine()
{
  if (!this->Buffer.empty() && this->Buffer.back() == ' ') {
    this->Buffer.pop_back();
  }
  this->Buffer += '\n';
  if (this->Buffer.size() >= ChunkBytes) {
    this->Flush();
  }
}

void vtkStratusTetGenOutput::Flush()
{
  const size_t bytes = this->Buffer.size();
  if (std::fwrite(this->Buffer.data(), 1, bytes, this->File.Get()) != bytes) {
    this->Fail("write", errno);
  }
  this->Buffer.clear();
  this->Progress(bytes);
}

void vtkStratusTetGenOutput::Close()
{
  this->Flush();
  if (const int reason = this->File.Close()) {
    this->Fail("write", reason);
  }
}

void vtkStratusTetGenOutput::Commit()
{
  if (const int reason = this->File.Rename()) {
    this->Fail("rename the file just written to", reason);
  }
}

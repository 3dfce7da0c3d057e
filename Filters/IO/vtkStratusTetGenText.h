// SPDX-License-Identifier: BSD-3-Clause
// Lines of numbers, in and out: the text that all of TetGen's files are made of. Files are read and written a megabyte at a time, so that
// their size does not matter; numbers are written with as many digits as bring back the same bits. Private to the module.
#ifndef vtkStratusTetGenText_h
#define vtkStratusTetGenText_h

#include "vtkType.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#ifdef _WIN32
#define VTK_STRATUS_PRIVATE
#else
#define VTK_STRATUS_PRIVATE __attribute__((visibility("hidden")))
#endif

// Thrown inside the module, caught where a reader or writer begins.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenError {
  std::string Text;
  unsigned long Code; // of vtkErrorCode
};

// Gets how many bytes were read or written since the last call; throws to stop.
using vtkStratusTetGenProgress = std::function<void(std::uintmax_t)>;

// A file as lines of numbers. Blank lines and what follows a '#' are passed over, as TetGen does; numbers are parted by blanks, tabs or
// commas.
class VTK_STRATUS_PRIVATE vtkStratusTetGenInput
{
public:
  vtkStratusTetGenInput(const std::string& path, const vtkStratusTetGenProgress& progress);
  ~vtkStratusTetGenInput();
  vtkStratusTetGenInput(const vtkStratusTetGenInput&) = delete;
  void operator=(const vtkStratusTetGenInput&) = delete;

  // To the next line with a number on it. The first tells whether there is one, the second fails where there is none: `done` of `all`
  // `things` are read.
  bool NextLine();
  void NeedLine(const char* things, vtkIdType done, vtkIdType all);
  // Numbers left on this line.
  int GetNumbersLeft() const;
  bool HasNumber() const { return !this->Rest.empty(); }

  // The next number of this line, which must be there and, if an integer, in lower..upper.
  vtkIdType GetInteger(const char* name, vtkIdType lower, vtkIdType upper);
  double GetReal(const char* name);
  double GetFinite(const char* name);
  // How many lines of at least `numbers` numbers follow: no more than the rest of the file can hold, so that
  // nothing large is allocated for a lie.
  vtkIdType GetCount(const char* name, vtkIdType numbers);
  void CheckCount(const char* name, vtkIdType count, vtkIdType numbers) const;

  // No number may be left on the line, no line in the file.
  void EndLine();
  void EndFile(const char* things, vtkIdType all);
  [[noreturn]] void Fail(const std::string& text) const;

private:
  bool Fill();
  std::string_view Next(const char* name);
  void Skip();
  [[noreturn]] void FailEarly(const std::string& text) const;

  std::string Path;
  vtkStratusTetGenProgress Progress;
  std::FILE* File = nullptr;
  std::uintmax_t Size = 0;
  std::uintmax_t Consumed = 0; // by lines
  std::vector<char> Buffer;
  size_t Begin = 0; // of what is not yet a line
  size_t End = 0;
  bool AtEnd = false;
  vtkIdType Line = 0;
  std::string_view Rest; // of the line, beginning at a number
};

// A file being written, beside its final name. It takes the name by Commit() and is gone if destroyed before.
class VTK_STRATUS_PRIVATE vtkStratusTetGenOutput
{
public:
  vtkStratusTetGenOutput(const std::string& path, const vtkStratusTetGenProgress& progress);
  ~vtkStratusTetGenOutput();
  vtkStratusTetGenOutput(const vtkStratusTetGenOutput&) = delete;
  void operator=(const vtkStratusTetGenOutput&) = delete;

  void Put(vtkIdType value);
  void Put(double value);
  void EndLine();
  void Close();
  void Commit();

private:
  void Flush();
  [[noreturn]] void Fail(const char* doing) const;

  std::string Path;
  std::string Target;
  std::string Part;
  vtkStratusTetGenProgress Progress;
  std::FILE* File = nullptr;
  std::string Buffer;
  bool Committed = false;
};

#endif

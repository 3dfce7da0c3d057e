// SPDX-License-Identifier: BSD-3-Clause
// Reads and writes lines of numbers, the text that all of TetGen's files consist of. Files of any size pass through a buffer of a megabyte.
// Numbers are written with as many digits as restore the same bits. Private to the module.
#ifndef vtkStratusTetGenText_h
#define vtkStratusTetGenText_h

#include "vtkStratusPrivate.h"
#include "vtkStratusTemporaryFile.h"

#include "vtkType.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

// Thrown inside the module and caught by the reader's or writer's entry point.
struct VTK_STRATUS_PRIVATE vtkStratusTetGenError {
  std::string Text;
  unsigned long Code; // one of vtkErrorCode
};

// Gets the number of bytes read or written since the last call. Throws to stop.
using vtkStratusTetGenProgress = std::function<void(std::uintmax_t)>;

// A file as lines of numbers. As in TetGen, blank lines and text after a '#' are skipped. Blanks, tabs and commas separate numbers.
class VTK_STRATUS_PRIVATE vtkStratusTetGenInput
{
public:
  vtkStratusTetGenInput(const std::string& path, const vtkStratusTetGenProgress& progress);
  ~vtkStratusTetGenInput();
  vtkStratusTetGenInput(const vtkStratusTetGenInput&) = delete;
  void operator=(const vtkStratusTetGenInput&) = delete;

  // Both move to the next line with a number on it. NextLine() returns false where there is none; NeedLine() throws and says that `done` of
  // `all` `things` are read.
  bool NextLine();
  void NeedLine(const char* things, vtkIdType done, vtkIdType all);
  // Counts the numbers left on this line.
  int GetNumbersLeft() const;
  bool HasNumber() const { return !this->Rest.empty(); }

  // Return the next number of this line. They throw where there is none, or where an integer is not in lower..upper.
  vtkIdType GetInteger(const char* name, vtkIdType lower, vtkIdType upper);
  double GetReal(const char* name);
  double GetFinite(const char* name);
  // GetCount() reads how many lines of at least `numbers` numbers follow. CheckCount() throws if the rest of the file cannot hold `count`
  // of them, so that a wrong number allocates nothing large.
  vtkIdType GetCount(const char* name, vtkIdType numbers);
  void CheckCount(const char* name, vtkIdType count, vtkIdType numbers) const;

  // Throw where a number is left on the line, or a line in the file.
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
  std::uintmax_t Consumed = 0; // bytes of lines read so far
  std::vector<char> Buffer;
  size_t Begin = 0; // of the bytes that are not yet a line
  size_t End = 0;
  bool AtEnd = false;
  vtkIdType Line = 0;
  std::string_view Rest; // of the line, starting at a number
};

// A file being written. Commit() replaces the file at its path; without it, that one stays.
class VTK_STRATUS_PRIVATE vtkStratusTetGenOutput
{
public:
  vtkStratusTetGenOutput(const std::string& path, const vtkStratusTetGenProgress& progress);
  vtkStratusTetGenOutput(const vtkStratusTetGenOutput&) = delete;
  void operator=(const vtkStratusTetGenOutput&) = delete;

  void Put(vtkIdType value);
  void Put(double value);
  void EndLine();
  void Close();
  void Commit();

private:
  void Flush();
  [[noreturn]] void Fail(const char* doing, int reason) const;

  std::string Path;
  vtkStratusTetGenProgress Progress;
  vtkStratusReplacingFile File;
  std::string Buffer;
};

#endif

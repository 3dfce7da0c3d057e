// SPDX-License-Identifier: BSD-3-Clause
// The contents of an image file's header, in one form for NRRD, MetaImage and NIfTI. Private to the module.
#ifndef vtkStratusImageFile_h
#define vtkStratusImageFile_h

#include "vtkStratusPrivate.h"
#include "vtkStratusReadError.h"

#include "vtkType.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

// One index of the stored values.
struct vtkStratusImageAxis {
  enum Kinds { SPACE, COMPONENT, TIME };
  int64_t Size = 1;
  Kinds Kind = SPACE;
  std::array<double, 3> Step = { 0.0, 0.0, 0.0 }; // of space: the vector from one sample to the next, in the file's coordinates
};

// A header. The functions below fill it; they throw vtkStratusReadError for invalid and for unsupported headers.
struct VTK_STRATUS_PRIVATE vtkStratusImageFile {
  enum Encodings { RAW, DEFLATE, TEXT }; // DEFLATE: as gzip or zlib write it

  std::string Path;      // the header's
  std::string Format;    // with the version, where it matters
  std::string ArrayName; // as VTK's reader of the format calls it
  std::string Content;   // a line about the values, or ""
  std::string Units;     // of the values
  std::string LengthUnits;
  std::string TimeUnits;
  std::vector<std::string> Notes; // what GetDescription() says about this file

  int Type = VTK_VOID;                              // of the stored values, one of VTK's numbers for types
  std::vector<vtkStratusImageAxis> Axes;            // the fastest first
  std::array<double, 3> Origin = { 0.0, 0.0, 0.0 }; // the first sample's place
  std::vector<double> Times;                        // one for each sample of the axis of time; empty without one
  bool IsVector = false;                            // the components are a direction's, not colours or a list's entries
  double Slope = 1.0, Intercept = 0.0;              // value = Slope * stored + Intercept

  // All files have the same number of values. In each come HeaderBytes, then LineSkip lines, then ByteSkip bytes, then values. Of DEFLATE
  // the ByteSkip bytes are the first of the inflated ones.
  Encodings Encoding = RAW;
  bool BigEndian = false;
  std::vector<std::string> Files;
  int64_t HeaderBytes = 0;
  int64_t LineSkip = 0;
  int64_t ByteSkip = 0; // -1, only for RAW: the values are the file's last bytes

  [[noreturn]] void Fail(const std::string& why) const { throw vtkStratusReadError{ this->Path + ": " + why }; }
  int64_t CountValues() const; // throws where the number is too large
  // Adds the axis of time, whose steps are numbered where `step` is no length of time.
  void AddTime(int64_t size, double first, double step);
};

enum class vtkStratusImageFormat { NONE, NRRD, META, NIFTI };
// Finds the format by the file's first bytes. If `path` names the file of the values (.img), it becomes the header's.
VTK_STRATUS_PRIVATE vtkStratusImageFormat vtkStratusFindImageFormat(std::string& path);

VTK_STRATUS_PRIVATE vtkStratusImageFile vtkStratusReadNrrdHeader(const std::string& path);
VTK_STRATUS_PRIVATE vtkStratusImageFile vtkStratusReadMetaHeader(const std::string& path);
VTK_STRATUS_PRIVATE vtkStratusImageFile vtkStratusReadNiftiHeader(const std::string& path);
// Returns up to `count` bytes from the file's begin, inflated if it is one of gzip.
VTK_STRATUS_PRIVATE std::string vtkStratusReadStart(const std::string& path, size_t count);

// The lines of a header, without their ends of line.
class VTK_STRATUS_PRIVATE vtkStratusHeaderLines
{
public:
  explicit vtkStratusHeaderLines(const std::string& path);
  // Returns false at the file's end. Throws for a header that is too long to be one.
  bool Next(std::string& line);
  int GetNumber() const { return this->Number; }   // of the last line, from 1
  int64_t GetBytes() const { return this->Bytes; } // from the file's begin to the next line
  [[noreturn]] void Fail(const std::string& why) const;

private:
  std::string Path;
  std::ifstream Stream;
  int Number = 0;
  int64_t Bytes = 0;
};

// Text of headers. Numbers are read in the same way in every locale.
VTK_STRATUS_PRIVATE std::string vtkStratusShown(std::string_view text); // in printable form, shortened, in quotes
VTK_STRATUS_PRIVATE std::vector<std::string> vtkStratusSplit(std::string_view text);
VTK_STRATUS_PRIVATE bool vtkStratusParse(std::string_view text, int64_t& value);
VTK_STRATUS_PRIVATE bool vtkStratusParse(std::string_view text, double& value);
VTK_STRATUS_PRIVATE std::string vtkStratusWriteNumber(double value);

// Lists the files "name%03d.raw" for numbers from first to last, by `step`. Throws where there are not `wanted` of them; 0: any number up
// to `most`.
VTK_STRATUS_PRIVATE std::vector<std::string> vtkStratusNumberedFiles(
  const vtkStratusImageFile& file, const std::string& pattern, const std::string numbers[3], int64_t wanted, int64_t most);
// Returns the path of a file that a header names: relative to the header's folder.
VTK_STRATUS_PRIVATE std::string vtkStratusBeside(const std::string& header, const std::string& name);

#endif

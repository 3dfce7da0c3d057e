// SPDX-License-Identifier: BSD-3-Clause
// Pictures as OpenEXR files: OpenEXR's own library reads back the written values, bit for bit and right side up. A picture that cannot be
// written is refused, and the file that was there stays. Argument: a folder to write to.
#include "Testing/support/exr_reading.h"
#include "mapper_testing.h"

#include "vtkStratusEXRWriter.h"

#include "vtkBitArray.h"
#include "vtkCallbackCommand.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIntArray.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkStringArray.h"
#include "vtkTypeUInt32Array.h"
#include "vtkTypeUInt64Array.h"
#include "vtkUnsignedCharArray.h"

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <malloc.h>
#include <random>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>

namespace {
std::string Folder;

std::string ReadText(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

vtkSmartPointer<vtkImageData> MakeImage(int width, int height)
{
  vtkSmartPointer<vtkImageData> image = vtkSmartPointer<vtkImageData>::New();
  image->SetExtent(3, 2 + width, -5, -6 + height, 7, 7); // a picture begins anywhere
  return image;
}

// Random values of any bits, or what `make` gives.
template <typename Array>
vtkSmartPointer<Array> AddArray(vtkImageData* image, const char* name, int components, typename Array::ValueType (*make)(std::mt19937&))
{
  static std::mt19937 random(7);
  vtkSmartPointer<Array> array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  for (vtkIdType value = 0; value < array->GetNumberOfValues(); ++value) {
    array->SetValue(value, make(random));
  }
  image->GetPointData()->AddArray(array);
  return array;
}

float AnyFloat(std::mt19937& random)
{
  const auto bits = static_cast<uint32_t>(random());
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

vtkSmartPointer<vtkFloatArray> AddFloats(vtkImageData* image, const char* name, int components)
{
  return AddArray<vtkFloatArray>(image, name, components, AnyFloat);
}

// The channel is the array's component upside down, bit for bit.
void CheckChannel(const ExrPicture& picture, const std::string& name, vtkDataArray* array, int component)
{
  const auto found = picture.Channels.find(name);
  CHECK(found != picture.Channels.end(), "%d x %d: there is no channel %s", picture.Width, picture.Height, name.c_str());
  int differing = 0;
  for (int y = 0; found != picture.Channels.end() && y < picture.Height; ++y) {
    for (int x = 0; x < picture.Width; ++x) {
      const vtkIdType tuple = static_cast<vtkIdType>(picture.Height - 1 - y) * picture.Width + x;
      const float is = found->second[static_cast<size_t>(y) * static_cast<size_t>(picture.Width) + static_cast<size_t>(x)];
      if (vtkFloatArray* floats = vtkFloatArray::SafeDownCast(array)) { // by bits: a NaN comes back as it was, and -0
        const float was = floats->GetTypedComponent(tuple, component);
        differing += std::memcmp(&was, &is, sizeof was) == 0 ? 0 : 1;
      } else {
        differing += static_cast<double>(is) == array->GetComponent(tuple, component) ? 0 : 1;
      }
    }
  }
  CHECK(differing == 0, "%d x %d: %d values of channel %s differ", picture.Width, picture.Height, differing, name.c_str());
}

void CheckRoundTrip(int width, int height)
{
  vtkSmartPointer<vtkImageData> image = MakeImage(width, height);
  const auto rgba = AddFloats(image, "RGBA", 4);
  const auto depth = AddFloats(image, "Depth", 1);
  depth->SetValue(0, std::numeric_limits<float>::infinity());
  const auto samples =
    AddArray<vtkTypeUInt32Array>(image, "Samples", 1, [](std::mt19937& random) { return static_cast<vtkTypeUInt32>(random() >> 8); });
  const auto wide = AddArray<vtkTypeUInt64Array>(image, "wide", 1, [](std::mt19937& random) { return vtkTypeUInt64(random() >> 8) << 40; });
  const auto bytes = AddArray<vtkUnsignedCharArray>(
    image, "a name of more than thirty-one characters", 2, [](std::mt19937& random) { return static_cast<unsigned char>(random()); });
  const auto exact = AddArray<vtkDoubleArray>(
    image, "exact", 1, [](std::mt19937& random) { return static_cast<double>(static_cast<int>(random() >> 8)) / -1024.0; });
  vtkNew<vtkStratusEXRWriter> writer;
  vtkNew<ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/all.exr").c_str());
  CHECK(writer->Write() == 1 && errors->Count == 0 && writer->GetErrorCode() == 0, "%d x %d: %s", width, height, errors->Text.c_str());
  ExrPicture picture;
  CHECK(ReadExr(Folder + "/all.exr", picture), "%d x %d: the library reads it", width, height);
  CHECK(picture.Width == width && picture.Height == height, "%d x %d came back as %d x %d", width, height, picture.Width, picture.Height);
  CHECK(picture.Compression == EXR_COMPRESSION_ZIP, "compression %d", static_cast<int>(picture.Compression));
  CHECK(picture.Channels.size() == 10, "%zu channels", picture.Channels.size());
  for (int c = 0; c < 4; ++c) {
    CheckChannel(picture, std::string(1, "RGBA"[c]), rgba, c);
  }
  CheckChannel(picture, "Z", depth, 0);
  CheckChannel(picture, "Samples", samples, 0);
  CheckChannel(picture, "wide", wide, 0);
  CheckChannel(picture, "exact", exact, 0);
  CheckChannel(picture, "a name of more than thirty-one characters.0", bytes, 0);
  CheckChannel(picture, "a name of more than thirty-one characters.1", bytes, 1);
}

// Arrays without names, as most image sources give them.
void UnnamedArrays()
{
  const char* const names[] = { "Y", "", "RGB", "RGBA" };
  for (int components : { 1, 3, 4 }) {
    vtkSmartPointer<vtkImageData> image = MakeImage(5, 4);
    const auto array = AddFloats(image, nullptr, components);
    vtkNew<vtkStratusEXRWriter> writer;
    writer->SetInputData(image);
    writer->SetFileName((Folder + "/unnamed.exr").c_str());
    writer->Write();
    ExrPicture picture;
    CHECK(
      ReadExr(Folder + "/unnamed.exr", picture) && picture.Channels.size() == static_cast<size_t>(components), "%d components", components);
    for (int c = 0; c < components; ++c) {
      CheckChannel(picture, std::string(1, names[components - 1][c]), array, c);
    }
  }
}

// Components in arrays of their own, as simulations in situ give them.
void SplitArrays()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(37, 17);
  const auto array =
    AddArray<vtkSOADataArrayTemplate<float>>(image, "RGBA", 4, [](std::mt19937& random) { return static_cast<float>(random() >> 8); });
  vtkNew<vtkStratusEXRWriter> writer;
  vtkNew<ErrorObserver> errors;
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  vtkNew<ErrorObserver> warnings; // VTK warns once of a copy that GetVoidPointer() makes
  array->AddObserver(vtkCommand::WarningEvent, warnings);
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/split.exr").c_str());
  CHECK(writer->Write() == 1 && errors->Count == 0, "%s", errors->Text.c_str());
  CHECK(warnings->Count == 0, "%d warnings: %s", warnings->Count, warnings->Text.c_str());
  ExrPicture picture;
  CHECK(ReadExr(Folder + "/split.exr", picture), "the library reads it");
  for (int c = 0; c < 4; ++c) {
    CheckChannel(picture, std::string(1, "RGBA"[c]), array, c);
  }
}

size_t BytesInUse()
{
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// One picture's buffers are far larger than the memory that all pictures together may leave in use.
void KeepsNothing()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(512, 32);
  AddFloats(image, "RGBA", 4);
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/again.exr").c_str());
  size_t first = 0;
  for (int time = 0; time < 24; ++time) {
    if (time == 4) {
      first = BytesInUse();
    }
    writer->Write();
  }
  const size_t last = BytesInUse();
  CHECK(last < first + 65536, "20 pictures left %zu bytes behind", last - first);
}

// Expects one error with these words; the old file stays, and no other file is left.
void CheckRefused(vtkStratusEXRWriter* writer, const char* words)
{
  const std::string path = Folder + "/old.exr";
  std::ofstream(path, std::ios::binary) << "old";
  vtkNew<ErrorObserver> errors;
  const unsigned long tag = writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->Write();
  writer->RemoveObserver(tag);
  CHECK(errors->Count == 1 && errors->Text.find(words) != std::string::npos, "%d errors, wanted '%s': %s", errors->Count, words,
    errors->Text.c_str());
  CHECK(writer->GetErrorCode() != 0 || !writer->GetInput(), "%s: an error code", words);
  CHECK(ReadText(path) == "old", "%s: the old file is gone", words);
  for (const auto& file : std::filesystem::directory_iterator(Folder)) {
    CHECK(file.path().extension() != ".part", "%s: half a file was left", words);
  }
}

void CheckImageRefused(vtkImageData* image, const char* words)
{
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/old.exr").c_str());
  CheckRefused(writer, words);
}

void RefusesImages()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  CheckImageRefused(image, "no channel");
  image->SetDimensions(4, 3, 2);
  AddFloats(image, "a", 1);
  CheckImageRefused(image, "4 x 3 x 2 points");
  image = MakeImage(4, 3);
  AddFloats(image, "Depth", 1);
  AddFloats(image, "Z", 1);
  CheckImageRefused(image, "two channels have the name 'Z'");
  image = MakeImage(4, 3);
  AddFloats(image, std::string(256, 'x').c_str(), 1);
  CheckImageRefused(image, "256 bytes");
  image = MakeImage(4, 3);
  AddFloats(image, "short", 1)->SetNumberOfTuples(11);
  CheckImageRefused(image, "'short' has 11 tuples");
}

template <typename Array> void CheckTypeRefused(const char* words)
{
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  vtkNew<Array> array;
  array->SetName("odd");
  array->SetNumberOfTuples(12);
  image->GetPointData()->AddArray(array);
  CheckImageRefused(image, words);
}

template <typename Array> void CheckValueRefused(typename Array::ValueType value, const char* words)
{
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  vtkNew<Array> array;
  array->SetName("odd");
  array->SetNumberOfTuples(12);
  array->FillValue(0);
  array->SetValue(10, value);
  image->GetPointData()->AddArray(array);
  CheckImageRefused(image, words);
}

void RefusesArrays()
{
  CheckTypeRefused<vtkStringArray>("'odd' is of type string");
  CheckTypeRefused<vtkBitArray>("'odd' is of type bit");
  CheckValueRefused<vtkDoubleArray>(0.1, "'odd' holds 0.100000 in tuple 10");
  CheckValueRefused<vtkDoubleArray>(1e300, "in tuple 10");
  CheckValueRefused<vtkIntArray>(16777217, "'odd' holds 16777217 in tuple 10");
  CheckValueRefused<vtkIntArray>(std::numeric_limits<int>::max(), "'odd' holds 2147483647");
  CheckValueRefused<vtkTypeUInt64Array>(
    (vtkTypeUInt64(1) << 53) + 1, "'odd' holds 9007199254740993"); // a double would round it to a float's value
  CheckValueRefused<vtkTypeUInt64Array>(std::numeric_limits<vtkTypeUInt64>::max(), "'odd' holds 18446744073709551615");
}

void RefusesPaths()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  AddFloats(image, "RGBA", 4);
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetFileName((Folder + "/old.exr").c_str());
  CheckRefused(writer, "No input");
  writer->SetInputData(image);
  writer->SetFileName(nullptr);
  CheckRefused(writer, "FileName is not set");
  writer->SetFileName((Folder + "/nowhere/old.exr").c_str());
  CheckRefused(writer, "can't open");
  const std::string longest = Folder + "/" + std::string(251, 'n') + ".exr"; // a name of 255 bytes, which is as long as file systems take
  writer->SetFileName(longest.c_str());
  writer->Write();
  CHECK(writer->GetErrorCode() == 0 && std::filesystem::exists(longest), "a long name is not written");
  std::filesystem::create_directories(Folder + "/folder.exr/in");
  writer->SetFileName((Folder + "/folder.exr").c_str());
  CheckRefused(writer, "folder.exr: Is a directory");
}

// The file that a link leads to is written, there or not, and stays for those for whom it was.
void KeepsLinksAndPermissions()
{
  namespace files = std::filesystem;
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  AddFloats(image, "RGBA", 4);
  const files::path target = Folder + "/target.exr", link = Folder + "/link.exr";
  files::create_symlink("target.exr", link);
  const files::perms few = files::perms::owner_read | files::perms::owner_write;
  for (const bool exists : { false, true }) {
    if (exists) {
      std::error_code error;
      files::permissions(target, few, error);
    }
    vtkNew<vtkStratusEXRWriter> writer;
    writer->SetInputData(image);
    writer->SetFileName(link.c_str());
    writer->Write();
    CHECK(
      writer->GetErrorCode() == 0 && files::is_symlink(link) && files::is_regular_file(target), "exists %d: the link was replaced", exists);
  }
  CHECK(files::status(target).permissions() == few, "the permissions are others");
}

// A rename would put a file in the place of a pipe, as of a device.
void KeepsPipes()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(4, 3);
  AddFloats(image, "RGBA", 4);
  const std::string path = Folder + "/pipe.exr";
  CHECK(mkfifo(path.c_str(), 0600) == 0, "no pipe");
  std::string got;
  std::thread reader([&] {
    std::ifstream file(path, std::ios::binary);
    got.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  });
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  writer->Write();
  reader.join();
  CHECK(writer->GetErrorCode() == 0 && std::filesystem::is_fifo(path), "the pipe was replaced");
  CHECK(got.compare(0, 4, "\x76\x2f\x31\x01") == 0 && got.size() > 4 * 3 * 16, "%zu bytes came out of the pipe", got.size());
}

// As a full disk would: the file may have so many bytes, from 3, which the old file has, to all of its bytes but one.
void RefusesFullDisks()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(40, 30);
  AddFloats(image, "RGBA", 4);
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/whole.exr").c_str());
  writer->Write();
  const rlim_t bytes = std::filesystem::file_size(Folder + "/whole.exr");
  writer->SetFileName((Folder + "/old.exr").c_str());
  struct rlimit before, few;
  getrlimit(RLIMIT_FSIZE, &before);
  few = before;
  std::signal(SIGXFSZ, SIG_IGN);
  CHECK(bytes > 1000, "%llu bytes", static_cast<unsigned long long>(bytes));
  for (rlim_t n = 3; n < bytes; n += n < 400 ? 1 : std::max<rlim_t>(1, std::min<rlim_t>(397, bytes - 1 - n))) {
    few.rlim_cur = n;
    setrlimit(RLIMIT_FSIZE, &few);
    CheckRefused(writer, "File too large");
    setrlimit(RLIMIT_FSIZE, &before);
  }
}

void StopsWhenAborted()
{
  vtkSmartPointer<vtkImageData> image = MakeImage(40, 100);
  AddFloats(image, "RGBA", 4);
  vtkNew<vtkStratusEXRWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName((Folder + "/old.exr").c_str());
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback([](vtkObject* caller, unsigned long, void*, void*) { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  writer->AddObserver(vtkCommand::ProgressEvent, stop);
  CheckRefused(writer, "was aborted");
}
} // namespace

int main(int argc, char** argv)
{
  Folder = std::string(argc > 1 ? argv[1] : ".") + "/exr";
  std::filesystem::remove_all(Folder);
  std::filesystem::create_directories(Folder);
  for (const auto& size : { std::pair<int, int>(1, 1), { 1, 40 }, { 53, 1 }, { 37, 15 }, { 37, 16 }, { 37, 17 }, { 128, 100 } }) {
    CheckRoundTrip(size.first, size.second);
  }
  UnnamedArrays();
  SplitArrays();
  KeepsNothing();
  RefusesImages();
  RefusesArrays();
  RefusesPaths();
  KeepsLinksAndPermissions();
  KeepsPipes();
  RefusesFullDisks();
  StopsWhenAborted();
  std::filesystem::remove_all(Folder);
  return Failures == 0 ? 0 : 1;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusImageTest.h"

#include "vtkStratusPictureFile.h"
#include "vtkStratusText.h"
#include "vtkStratusSimilarity.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Factory.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

vtkStandardNewMacro(vtkStratusImageTest);

namespace {
using Stop = std::runtime_error;

vtkDataArray* ColorsOf(vtkImageData* picture, const std::string& what)
{
  const int* size = picture->GetDimensions();
  if (size[0] < 1 || size[1] < 1 || size[2] != 1) {
    throw Stop(what + " has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) +
      " points, a picture has at least one along x and y, and one along z");
  }
  vtkPointData* data = picture->GetPointData();
  vtkDataArray* colors = data->GetArray("RGBA") ? data->GetArray("RGBA")
    : data->GetArray("RGB")                     ? data->GetArray("RGB")
                                                : data->GetScalars();
  if (!colors) {
    throw Stop(what + " has no colours: no array RGBA or RGB, and no scalars");
  }
  const int components = colors->GetNumberOfComponents(), type = colors->GetDataType();
  if (components > 4 || colors->GetNumberOfTuples() != picture->GetNumberOfPoints()) {
    throw Stop(what + " has colours of " + std::to_string(components) + " components for " + std::to_string(colors->GetNumberOfTuples()) +
      " pixels, 1..4 for " + std::to_string(picture->GetNumberOfPoints()) + " are needed");
  }
  if (type != VTK_UNSIGNED_CHAR && type != VTK_UNSIGNED_SHORT && type != VTK_FLOAT && type != VTK_DOUBLE) {
    throw Stop(what + " has colours of " + colors->GetDataTypeAsString() + ", unsigned char, unsigned short, float or double are needed");
  }
  return colors;
}

// A name for messages.
std::string NameOf(const char* file, vtkImageData* image, const char* fallback)
{
  return image || !file ? fallback : std::string("'") + file + "'";
}

// ---- differences

// Colours in 0..1, component by component: Planes[c][y * width + x].
struct Colors {
  std::vector<std::vector<double>> Planes;
  bool HasAlpha = false;
};

Colors PlanesOf(vtkDataArray* array)
{
  const int components = array->GetNumberOfComponents();
  const double unit = array->GetDataType() == VTK_UNSIGNED_CHAR ? 255.0 : array->GetDataType() == VTK_UNSIGNED_SHORT ? 65535.0 : 1.0;
  Colors colors;
  colors.HasAlpha = components % 2 == 0;
  for (int c = 0; c < components; ++c) {
    std::vector<double> plane(static_cast<size_t>(array->GetNumberOfTuples()));
    for (size_t i = 0; i < plane.size(); ++i) {
      plane[i] = array->GetComponent(static_cast<vtkIdType>(i), c) / unit;
    }
    colors.Planes.push_back(std::move(plane));
  }
  return colors;
}

double Difference(double a, double b)
{
  const double d = std::abs(a - b);
  return a == b || (a != a && b != b) ? 0.0 : std::isfinite(d) ? d : std::numeric_limits<double>::infinity();
}

// Marks the pixels of which bits differ, and names the arrays that they are of. Returns why the arrays cannot be the same, else "".
std::string CompareBits(vtkImageData* a, vtkImageData* b, std::vector<bool>& differs, std::string& names)
{
  vtkPointData *one = a->GetPointData(), *other = b->GetPointData();
  const auto described = [](vtkAbstractArray* array) {
    return "'" + std::string(array->GetName() ? array->GetName() : "") + "' of " + std::to_string(array->GetNumberOfComponents()) + " x " +
      array->GetDataTypeAsString();
  };
  const auto list = [&described](vtkPointData* data) {
    std::vector<std::string> names;
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) {
      names.push_back(described(data->GetAbstractArray(i)));
    }
    std::sort(names.begin(), names.end());
    std::string text;
    for (const std::string& name : names) {
      text += (text.empty() ? "" : ", ") + name;
    }
    return text;
  };
  // A file names its only array after itself or the format, which is no difference of pictures.
  const bool unnamed = one->GetNumberOfArrays() == 1 && other->GetNumberOfArrays() == 1;
  for (int i = 0; i < one->GetNumberOfArrays(); ++i) {
    vtkDataArray* here = vtkDataArray::SafeDownCast(one->GetAbstractArray(i));
    vtkDataArray* there = !here ? nullptr : unnamed ? other->GetArray(0) : other->GetArray(here->GetName());
    if (!there || there->GetDataType() != here->GetDataType() || there->GetNumberOfComponents() != here->GetNumberOfComponents() ||
      one->GetNumberOfArrays() != other->GetNumberOfArrays()) {
      return "the image has the arrays " + list(one) + ", the baseline " + list(other);
    }
    const size_t bytes = static_cast<size_t>(here->GetNumberOfComponents()) * static_cast<size_t>(here->GetDataTypeSize());
    const auto *from = static_cast<const char*>(here->GetVoidPointer(0)), *to = static_cast<const char*>(there->GetVoidPointer(0));
    bool same = true;
    for (size_t pixel = 0; pixel < differs.size(); ++pixel) {
      if (std::memcmp(from + pixel * bytes, to + pixel * bytes, bytes) != 0) {
        differs[pixel] = true;
        same = false;
      }
    }
    if (!same) {
      names += std::string(names.empty() ? "" : ", ") + (here->GetName() ? here->GetName() : "the colours");
    }
  }
  return "";
}
} // namespace

struct vtkStratusImageTest::vtkInternals {
  vtkSmartPointer<vtkImageData> Image, Baseline; // as they were set
  vtkSmartPointer<vtkImageData> Judged, Held;    // of the last comparison
  std::string OtherArrays;                       // why no bits could be compared
  std::string DifferentArrays;                   // names of arrays whose bits differ
  std::string Reason;
};

vtkStratusImageTest::vtkStratusImageTest() : Internals(new vtkInternals) {}

vtkStratusImageTest::~vtkStratusImageTest()
{
  this->SetFileName(nullptr);
  this->SetBaselineFileName(nullptr);
}

void vtkStratusImageTest::SetImage(vtkImageData* image)
{
  if (this->Internals->Image != image) {
    this->Internals->Image = image;
    this->Modified();
  }
}

vtkImageData* vtkStratusImageTest::GetImage()
{
  return this->Internals->Image;
}

void vtkStratusImageTest::SetBaseline(vtkImageData* image)
{
  if (this->Internals->Baseline != image) {
    this->Internals->Baseline = image;
    this->Modified();
  }
}

vtkImageData* vtkStratusImageTest::GetBaseline()
{
  return this->Internals->Baseline;
}

std::string vtkStratusImageTest::GetReason()
{
  return this->Internals->Reason;
}

void vtkStratusImageTest::CheckLimits() const
{
  const auto check = [](const char* name, double value, bool good, const char* range) {
    if (!good) {
      throw Stop(std::string(name) + " is " + std::to_string(value) + ", it must be " + range);
    }
  };
  check("Tolerance", this->Tolerance, this->Tolerance == -1.0 || this->Tolerance >= 0.0, "0 and above, or -1");
  check(
    "MaximumDifference", this->MaximumDifference, this->MaximumDifference == -1.0 || this->MaximumDifference >= 0.0, "0 and above, or -1");
  check("LeastSSIM", this->LeastSSIM, this->LeastSSIM == -2.0 || (this->LeastSSIM >= -1.0 && this->LeastSSIM <= 1.0), "-1..1, or -2");
}

void vtkStratusImageTest::Load()
{
  vtkInternals& own = *this->Internals;
  const auto load = [](vtkImageData* image, const char* file, const char* what) {
    if (!image && (!file || !file[0])) {
      throw Stop(std::string("there is no ") + what);
    }
    return image ? vtkSmartPointer<vtkImageData>(image) : vtkStratusReadPicture(file);
  };
  own.Judged = load(own.Image, this->FileName, "image");
  own.Held = load(own.Baseline, this->BaselineFileName, "baseline");
}

void vtkStratusImageTest::Measure()
{
  vtkInternals& own = *this->Internals;
  const std::string names[2] = { NameOf(this->FileName, own.Image, "the image"),
    NameOf(this->BaselineFileName, own.Baseline, "the baseline") };
  vtkDataArray *image = ColorsOf(own.Judged, names[0]), *baseline = ColorsOf(own.Held, names[1]);
  const int *size = own.Judged->GetDimensions(), *held = own.Held->GetDimensions();
  if (size[0] != held[0] || size[1] != held[1]) {
    throw Stop("the image has " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " pixels, the baseline " +
      std::to_string(held[0]) + " x " + std::to_string(held[1]));
  }
  std::copy(size, size + 2, this->Size);
  const auto pixels = static_cast<size_t>(size[0]) * static_cast<size_t>(size[1]);
  std::vector<bool> differs(pixels);
  own.OtherArrays = CompareBits(own.Judged, own.Held, differs, own.DifferentArrays);

  const Colors a = PlanesOf(image), b = PlanesOf(baseline);
  const size_t colors[2] = { a.Planes.size() - a.HasAlpha, b.Planes.size() - b.HasAlpha };
  if (colors[0] != colors[1]) {
    throw Stop("the image has " + std::to_string(a.Planes.size()) + " components, the baseline " + std::to_string(b.Planes.size()));
  }
  const size_t components = colors[0] + (a.HasAlpha && b.HasAlpha);
  double squares = 0.0;
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    bool lit = false;
    for (size_t c = 0; c < components; ++c) {
      const double from = a.Planes[c][pixel], to = b.Planes[c][pixel], difference = Difference(from, to);
      lit = lit || from != 0.0 || to != 0.0;
      squares += difference * difference;
      if (difference > this->LargestDifference) {
        this->LargestDifference = difference;
        this->LargestDifferencePixel[0] = static_cast<int>(pixel % static_cast<size_t>(size[0]));
        this->LargestDifferencePixel[1] = static_cast<int>(pixel / static_cast<size_t>(size[0]));
      }
      if (difference > 0.0) {
        differs[pixel] = true; // colours of other types have no bits to compare
      }
    }
    this->NumberOfLitPixels += lit;
  }
  this->NumberOfDifferentPixels = std::count(differs.begin(), differs.end(), true);
  if (this->NumberOfLitPixels > 0) {
    this->RootMeanSquare = std::sqrt(squares / (static_cast<double>(components) * static_cast<double>(this->NumberOfLitPixels)));
  }
  if (this->LeastSSIM != -2.0) {
    if (size[0] < vtkStratusSimilarityWindow || size[1] < vtkStratusSimilarityWindow) {
      throw Stop(
        "the pictures have " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " pixels, structural similarity needs 11 x 11");
    }
    this->SSIM = 0.0;
    for (size_t c = 0; c < components; ++c) {
      this->SSIM += vtkStratusSimilarity(a.Planes[c], b.Planes[c], size[0], size[1]) / static_cast<double>(components);
    }
  }
}

std::string vtkStratusImageTest::Judge() const
{
  char text[256];
  const bool exact = this->Exact || (this->Tolerance == -1.0 && this->MaximumDifference == -1.0 && this->LeastSSIM == -2.0);
  if (exact && !this->Internals->OtherArrays.empty()) {
    return this->Internals->OtherArrays;
  }
  // Negated, so that a number that is none is no pass.
  if (exact && this->NumberOfDifferentPixels > 0) {
    std::snprintf(text, sizeof text, "%lld of %lld pixels differ in ", static_cast<long long>(this->NumberOfDifferentPixels),
      static_cast<long long>(this->Size[0]) * this->Size[1]);
    const std::string count = text + this->Internals->DifferentArrays;
    std::snprintf(text, sizeof text, ", the largest difference of a colour is %.6g at %d, %d", this->LargestDifference,
      this->LargestDifferencePixel[0], this->LargestDifferencePixel[1]);
    return this->LargestDifference > 0.0 ? count + text : count + ", no colour differs by a value";
  }
  if (this->Tolerance != -1.0 && !(this->RootMeanSquare <= this->Tolerance)) {
    std::snprintf(
      text, sizeof text, "the root mean square difference is %.6g, at most %g is allowed", this->RootMeanSquare, this->Tolerance);
    return text;
  }
  if (this->MaximumDifference != -1.0 && !(this->LargestDifference <= this->MaximumDifference)) {
    std::snprintf(text, sizeof text, "the largest difference is %.6g at %d, %d, at most %g is allowed", this->LargestDifference,
      this->LargestDifferencePixel[0], this->LargestDifferencePixel[1], this->MaximumDifference);
    return text;
  }
  if (this->LeastSSIM != -2.0 && !(this->SSIM >= this->LeastSSIM)) {
    std::snprintf(text, sizeof text, "the structural similarity is %.6g, at least %g is wanted", this->SSIM, this->LeastSSIM);
    return text;
  }
  return "";
}

bool vtkStratusImageTest::Compare()
{
  vtkInternals& own = *this->Internals;
  own.Judged = own.Held = nullptr;
  own.OtherArrays.clear();
  own.DifferentArrays.clear();
  own.Reason.clear();
  this->Failed = false;
  this->Size[0] = this->Size[1] = 0;
  this->NumberOfDifferentPixels = this->NumberOfLitPixels = 0;
  this->LargestDifference = this->RootMeanSquare = 0.0;
  this->LargestDifferencePixel[0] = this->LargestDifferencePixel[1] = 0;
  this->SSIM = -2.0;
  try {
    this->CheckLimits();
    this->Load();
    this->Measure();
    own.Reason = this->Judge();
    return own.Reason.empty();
  } catch (const std::bad_alloc&) {
    own.Reason = "out of memory while comparing pictures";
  } catch (const std::exception& error) {
    own.Reason = error.what();
  }
  this->Failed = true;
  vtkErrorMacro(<< own.Reason);
  return false;
}

bool vtkStratusImageTest::Write(vtkImageData* image, const char* path)
{
  try {
    vtkStratusWritePicture(image, path ? path : "");
    return true;
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    return false;
  }
}

bool vtkStratusImageTest::WriteDifference(const char* path)
{
  vtkInternals& own = *this->Internals;
  if (!own.Judged || !own.Held || this->Failed) {
    vtkErrorMacro(<< "there is no difference to write: no two pictures were compared");
    return false;
  }
  const Colors a = PlanesOf(ColorsOf(own.Judged, "the image")), b = PlanesOf(ColorsOf(own.Held, "the baseline"));
  const size_t colors = a.Planes.size() - a.HasAlpha, components = colors + (a.HasAlpha && b.HasAlpha);
  const bool floats = vtkStratusEndsWith(path ? path : "", ".exr");
  const auto shown = static_cast<int>(floats ? components : colors);
  vtkSmartPointer<vtkDataArray> array;
  array.TakeReference(vtkDataArray::CreateDataArray(floats ? VTK_FLOAT : VTK_UNSIGNED_CHAR));
  array->SetName(shown == 4 ? "RGBA" : shown == 3 ? "RGB" : "Y");
  array->SetNumberOfComponents(shown);
  array->SetNumberOfTuples(own.Judged->GetNumberOfPoints());
  // Alpha may differ most, but is not shown.
  double largest = 0.0;
  for (size_t c = 0; c < colors; ++c) {
    for (size_t i = 0; i < a.Planes[c].size(); ++i) {
      const double difference = Difference(a.Planes[c][i], b.Planes[c][i]);
      largest = std::isfinite(difference) ? std::max(largest, difference) : largest;
    }
  }
  for (int c = 0; c < shown; ++c) {
    const auto& from = a.Planes[static_cast<size_t>(c)];
    const auto& to = b.Planes[static_cast<size_t>(c)];
    for (size_t i = 0; i < from.size(); ++i) {
      const double stretched = largest > 0.0 ? std::min(1.0, Difference(from[i], to[i]) / largest) : Difference(from[i], to[i]) > 0.0;
      array->SetComponent(static_cast<vtkIdType>(i), c, floats ? static_cast<float>(from[i] - to[i]) : std::round(255.0 * stretched));
    }
  }
  vtkNew<vtkImageData> image;
  image->SetDimensions(this->Size[0], this->Size[1], 1);
  image->GetPointData()->SetScalars(array);
  return this->Write(image, path);
}

bool vtkStratusImageTest::WriteImage(const char* path)
{
  try {
    vtkSmartPointer<vtkImageData> image = this->Internals->Image;
    if (!image) {
      if (!this->FileName || !this->FileName[0]) {
        throw Stop("there is no image");
      }
      image = vtkStratusReadPicture(this->FileName);
    }
    if (vtkStratusEndsWith(path ? path : "", ".exr")) {
      return this->Write(image, path);
    }
    vtkDataArray* colors = ColorsOf(image, "the image");
    vtkNew<vtkImageData> bytes;
    bytes->SetDimensions(image->GetDimensions());
    if (colors->GetDataType() == VTK_FLOAT || colors->GetDataType() == VTK_DOUBLE) {
      vtkNew<vtkUnsignedCharArray> rounded;
      rounded->SetNumberOfComponents(colors->GetNumberOfComponents());
      rounded->SetNumberOfTuples(colors->GetNumberOfTuples());
      for (vtkIdType i = 0; i < colors->GetNumberOfTuples(); ++i) {
        for (int c = 0; c < colors->GetNumberOfComponents(); ++c) {
          const double value = colors->GetComponent(i, c);
          rounded->SetComponent(i, c, std::round(255.0 * (value > 0.0 ? std::min(value, 1.0) : 0.0)));
        }
      }
      bytes->GetPointData()->SetScalars(rounded);
    } else {
      bytes->GetPointData()->SetScalars(colors);
    }
    return this->Write(bytes, path);
  } catch (const std::exception& error) {
    vtkErrorMacro(<< error.what());
    return false;
  }
}

void vtkStratusImageTest::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Image: " << this->Internals->Image.Get() << "\n";
  os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n";
  os << indent << "Baseline: " << this->Internals->Baseline.Get() << "\n";
  os << indent << "BaselineFileName: " << (this->BaselineFileName ? this->BaselineFileName : "(none)") << "\n";
  os << indent << "Exact: " << (this->Exact ? "On\n" : "Off\n");
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "MaximumDifference: " << this->MaximumDifference << "\n";
  os << indent << "LeastSSIM: " << this->LeastSSIM << "\n";
  os << indent << "Failed: " << (this->Failed ? "Yes\n" : "No\n");
  os << indent << "Reason: " << this->Internals->Reason << "\n";
  os << indent << "Size: " << this->Size[0] << " " << this->Size[1] << "\n";
  os << indent << "NumberOfDifferentPixels: " << this->NumberOfDifferentPixels << "\n";
  os << indent << "NumberOfLitPixels: " << this->NumberOfLitPixels << "\n";
  os << indent << "LargestDifference: " << this->LargestDifference << "\n";
  os << indent << "LargestDifferencePixel: " << this->LargestDifferencePixel[0] << " " << this->LargestDifferencePixel[1] << "\n";
  os << indent << "RootMeanSquare: " << this->RootMeanSquare << "\n";
  os << indent << "SSIM: " << this->SSIM << "\n";
}

// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusPictureFile.h"
#include "vtkStratusText.h"

#ifdef STRATUS_EXR
#include "vtkStratusEXRReader.h"
#include "vtkStratusEXRWriter.h"
#endif

#include "vtkStratusTIFFFile.h"

#include "vtkCallbackCommand.h"
#include "vtkDataArray.h"
#include "vtkErrorCode.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkImageReader2Factory.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

namespace {
using Stop = std::runtime_error;

// Errors of readers become a sentence of the comparison, so that they are not printed twice.
class Listener
{
public:
  explicit Listener(vtkObject* object)
  {
    this->Command->SetClientData(&this->Text);
    this->Command->SetCallback([](vtkObject*, unsigned long, void* text, void* message) {
      if (message && static_cast<std::string*>(text)->empty()) {
        *static_cast<std::string*>(text) = static_cast<const char*>(message);
      }
    });
    object->AddObserver(vtkCommand::ErrorEvent, this->Command);
  }
  std::string Text;

private:
  vtkNew<vtkCallbackCommand> Command;
};

// VTK puts "ERROR: In file, line N\nclass (address): " before a message.
std::string BareMessage(const std::string& text)
{
  const size_t at = text.find("): ");
  std::string bare = at == std::string::npos ? text : text.substr(at + 3);
  while (!bare.empty() && std::isspace(static_cast<unsigned char>(bare.back()))) {
    bare.pop_back();
  }
  return bare;
}

// VTK's reader of TIFF puts the first row at the bottom, its other readers put it at the top.
vtkSmartPointer<vtkImageData> WithRowsReversed(vtkImageData* image)
{
  vtkSmartPointer<vtkImageData> reversed = vtkSmartPointer<vtkImageData>::New();
  reversed->DeepCopy(image);
  int size[3];
  image->GetDimensions(size);
  vtkDataArray* const from = image->GetPointData()->GetScalars();
  for (vtkIdType y = 0; from && y < size[1]; ++y) {
    reversed->GetPointData()->GetScalars()->InsertTuples(y * size[0], size[0], (size[1] - 1 - y) * size[0], from);
  }
  return reversed;
}

template <typename Writer> void Write(vtkImageData* image, const std::string& path)
{
  vtkNew<Writer> writer;
  const Listener listener(writer);
  writer->SetFileName(path.c_str());
  writer->SetInputData(image);
  writer->Write();
  if (writer->GetErrorCode() != vtkErrorCode::NoError || !listener.Text.empty()) {
    throw Stop(listener.Text.empty() ? "can't write " + path : BareMessage(listener.Text));
  }
}
} // namespace

vtkSmartPointer<vtkImageData> vtkStratusReadPicture(const std::string& path)
{
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw Stop("there is no file " + path);
  }
  const int orientation = vtkStratusTIFFOrientation(path);
  if (orientation > 1) {
    throw Stop("can't read " + path + ": the TIFF tag Orientation is " + std::to_string(orientation) + ", must be 1");
  }
  vtkSmartPointer<vtkImageAlgorithm> reader;
  if (vtkStratusEndsWith(path, ".exr")) {
#ifdef STRATUS_EXR
    vtkNew<vtkStratusEXRReader> exr;
    exr->SetFileName(path.c_str());
    reader = exr;
#else
    throw Stop("can't read " + path + ": this is built without OpenEXR");
#endif
  } else {
    const auto usual = vtkSmartPointer<vtkImageReader2>::Take(vtkImageReader2Factory::CreateImageReader2(path.c_str()));
    if (!usual) {
      throw Stop("can't read " + path + ": it is of no kind that VTK reads as an image, and no .exr");
    }
    usual->SetFileName(path.c_str());
    reader = usual;
  }
  const Listener listener(reader);
  reader->Update();
  if (reader->GetErrorCode() != vtkErrorCode::NoError || !listener.Text.empty()) {
    throw Stop(listener.Text.empty() ? "can't read " + path : BareMessage(listener.Text));
  }
  if (orientation == 1) {
    return WithRowsReversed(reader->GetOutput());
  }
  return reader->GetOutput();
}

void vtkStratusWritePicture(vtkImageData* image, const std::string& path)
{
  if (vtkStratusEndsWith(path, ".png")) {
    Write<vtkPNGWriter>(image, path);
  } else if (vtkStratusEndsWith(path, ".exr")) {
#ifdef STRATUS_EXR
    Write<vtkStratusEXRWriter>(image, path);
#else
    throw Stop("can't write " + path + ": this is built without OpenEXR");
#endif
  } else {
    throw Stop("can't write '" + path + "': its name must end in .png or .exr");
  }
}

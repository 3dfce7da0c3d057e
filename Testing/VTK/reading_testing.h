// SPDX-License-Identifier: BSD-3-Clause
// Helpers for tests of readers that read variables: readers whose errors are kept, and files that are cut.
#pragma once

#include "vtkCommand.h"
#include "vtkDataSet.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <string>

static int failures = 0;

static void check(bool right, const std::string& what)
{
  if (!right) {
    std::printf("FAILED: %s\n", what.c_str());
    ++failures;
  }
}

inline bool near(double a, double b, double tolerance = 1e-9)
{
  return std::fabs(a - b) <= tolerance * std::fmax(1.0, std::fabs(b));
}

// Keeps what a reader complains of.
class complaints : public vtkCommand
{
public:
  static complaints* New() { return new complaints; }
  void Execute(vtkObject*, unsigned long, void* text) override { this->heard += static_cast<const char*>(text); }
  std::string heard;
};

template <class Reader> struct variable_reader {
  vtkSmartPointer<Reader> reader = vtkSmartPointer<Reader>::New();
  vtkSmartPointer<complaints> errors = vtkSmartPointer<complaints>::New();

  variable_reader(const std::string& path, const char* variable)
  {
    this->reader->AddObserver(vtkCommand::ErrorEvent, this->errors);
    this->reader->SetFileName(path.c_str());
    this->reader->SetVariableName(variable);
  }

  // Reads a time.
  vtkDataSet* read(double time = 0.0)
  {
    this->errors->heard.clear();
    this->reader->UpdateInformation();
    this->reader->UpdateTimeStep(time);
    return this->reader->GetOutput();
  }
};

template <class Reader> void refuse(const std::string& path, const char* variable, const std::string& words)
{
  variable_reader<Reader> reader(path, variable);
  vtkDataSet* output = reader.read();
  check(reader.errors->heard.find(words) != std::string::npos,
    path + " must be refused with '" + words + "', not '" + reader.errors->heard + "'");
  check(!output || output->GetNumberOfPoints() == 0, path + ": something was put out with an error");
}

// Copies the first part of a file.
inline std::string cut(const std::string& path, const std::string& to, double part)
{
  std::ifstream in(path, std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  std::ofstream(to, std::ios::binary) << all.substr(0, static_cast<size_t>(static_cast<double>(all.size()) * part));
  return to;
}

// SPDX-License-Identifier: BSD-3-Clause
// A process whose locale writes decimal commas reads TetGen's files as any other: numbers too small for double are 0, numbers too large are
// refused. Argument: a folder to write to.
#include "Testing/support/comma_locale.h"
#include "tetgen_testing.h"

#include "vtkStratusTetGenReader.h"

#include "vtkExecutive.h"

namespace {
// Reads one point, and returns its x. Errors are counted.
double ReadPoint(const std::string& path, const char* x, int& errors)
{
  WriteText(path, std::string("1 3 0 0\n1 ") + x + " 2.5 3\n");
  vtkNew<vtkStratusTetGenReader> reader;
  vtkNew<ErrorObserver> observer, silence;
  reader->AddObserver(vtkCommand::ErrorEvent, observer);
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, silence);
  reader->SetFileName(path.c_str());
  reader->Update();
  errors = observer->Count;
  if (errors > 0) {
    return -1.0;
  }
  CHECK(
    reader->GetOutput()->GetNumberOfPoints() == 1, "%s: %lld points", x, static_cast<long long>(reader->GetOutput()->GetNumberOfPoints()));
  CHECK(reader->GetOutput()->GetPoint(0)[1] == 2.5, "%s: y is %g", x, reader->GetOutput()->GetPoint(0)[1]);
  return reader->GetOutput()->GetPoint(0)[0];
}
} // namespace

int main(int argc, char** argv)
{
  const std::string path = std::string(argc > 1 ? argv[1] : ".") + "/locale.node";
  for (int commas = 0; commas < 2; ++commas) {
    if (commas && !comma_locale_begin()) {
      comma_locale_end();
      std::printf("SKIPPED: no locale with decimal commas (Debian: locales)\n");
      return Failures == 0 ? 77 : 1;
    }
    int errors = 0;
    for (const char* small : { "1.5e-400", "-123.5e-4000", "0.5e-999" }) {
      const double x = ReadPoint(path, small, errors);
      CHECK(errors == 0 && x == 0.0, "commas %d: %s is %g, %d errors", commas, small, x, errors);
    }
    CHECK(ReadPoint(path, "1.25e-3", errors) == 1.25e-3 && errors == 0, "commas %d: 1.25e-3, %d errors", commas, errors);
    for (const char* large : { "1.5e400", "-0.5e999" }) {
      ReadPoint(path, large, errors);
      CHECK(errors == 1, "commas %d: %s is taken, %d errors", commas, large, errors);
    }
  }
  comma_locale_end();
  std::filesystem::remove(path);
  return Failures == 0 ? 0 : 1;
}

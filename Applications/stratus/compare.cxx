// SPDX-License-Identifier: BSD-3-Clause
#include "compare.h"

#include "json.h"
#include "output.h"
#include "support.h"

#include "vtkStratusImageTest.h"

#include <vtkNew.h>
#include <vtkXMLDataElement.h>

#include <cmath>
#include <sstream>

namespace cli {
namespace {

std::string json_of(const options& o, vtkStratusImageTest* test, bool alike)
{
  const int *size = test->GetSize(), *pixel = test->GetLargestDifferencePixel();
  std::string text = "{\n  \"image\": " + json_text(o.source) + ",\n  \"baseline\": " + json_text(o.baseline) + ",\n  \"verdict\": ";
  text += test->GetFailed() ? "\"error\"" : alike ? "\"alike\"" : "\"differ\"";
  text += ",\n  \"reason\": " + json_text(test->GetReason());
  if (!test->GetFailed()) {
    text += format(",\n  \"width\": %d,\n  \"height\": %d", size[0], size[1]);
    text += format(",\n  \"different_pixels\": %lld", static_cast<long long>(test->GetNumberOfDifferentPixels()));
    text += format(",\n  \"lit_pixels\": %lld", static_cast<long long>(test->GetNumberOfLitPixels()));
    text += ",\n  \"largest_difference\": " + json_number(test->GetLargestDifference());
    text += format(",\n  \"largest_difference_pixel\": [%d, %d]", pixel[0], pixel[1]);
    text += ",\n  \"root_mean_square\": " + json_number(test->GetRootMeanSquare());
    if (o.least_ssim != -2.0) {
      text += ",\n  \"ssim\": " + json_number(test->GetSSIM());
    }
  }
  return text + "\n}\n";
}

// JUnit's form, which continuous integration reads: one case, which passes, fails, or has an error.
std::string junit_of(const options& o, vtkStratusImageTest* test, bool alike)
{
  const bool error = test->GetFailed();
  vtkNew<vtkXMLDataElement> suite, one, trouble;
  suite->SetName("testsuite");
  suite->SetAttribute("name", "stratus compare");
  suite->SetIntAttribute("tests", 1);
  suite->SetIntAttribute("failures", !alike && !error);
  suite->SetIntAttribute("errors", error);
  one->SetName("testcase");
  one->SetAttribute("classname", "stratus.compare");
  one->SetAttribute("name", o.source.c_str());
  suite->AddNestedElement(one);
  if (!alike) {
    trouble->SetName(error ? "error" : "failure");
    trouble->SetAttribute("message", (o.source + " and " + o.baseline + ": " + test->GetReason()).c_str());
    one->AddNestedElement(trouble);
  }
  std::ostringstream text;
  text << "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  suite->PrintXML(text, vtkIndent());
  return text.str() + "\n";
}

void print(const options& o, vtkStratusImageTest* test)
{
  const int *size = test->GetSize(), *pixel = test->GetLargestDifferencePixel();
  const auto count = [](vtkIdType pixels) { return grouped(static_cast<unsigned long long>(pixels)); };
  row("size", format("%d x %d pixels", size[0], size[1]));
  row("different", count(test->GetNumberOfDifferentPixels()) + " pixels");
  if (test->GetLargestDifference() > 0.0) {
    row("largest",
      format("%.6g of 1 (%.2f of 255) at %d, %d from the bottom left", test->GetLargestDifference(), 255.0 * test->GetLargestDifference(),
        pixel[0], pixel[1]));
  }
  const double error = test->GetRootMeanSquare();
  row("mean square",
    format("root %.6g", error) + (error > 0.0 ? format(", %.2f dB", -20.0 * std::log10(error)) : "") + ", over the " +
      count(test->GetNumberOfLitPixels()) + " pixels that are not 0 in both");
  if (o.least_ssim != -2.0) {
    row("SSIM", format("%.6f", test->GetSSIM()));
  }
}
} // namespace

bool compare(const options& o)
{
  vtkNew<vtkStratusImageTest> test;
  test->SetFileName(o.source.c_str());
  test->SetBaselineFileName(o.baseline.c_str());
  test->SetExact(o.exact);
  test->SetTolerance(o.largest_mean);
  test->SetMaximumDifference(o.largest_difference);
  test->SetLeastSSIM(o.least_ssim);
  const bool alike = test->Compare();
  if (!o.json.empty()) {
    write_json(o.json, json_of(o, test, alike));
  }
  if (!o.junit.empty()) {
    const std::string text = junit_of(o, test, alike);
    output_file(o.junit).write(std::vector<uint8_t>(text.begin(), text.end()));
  }
  if (test->GetFailed()) {
    throw failure(test->GetReason());
  }
  if (!o.difference.empty() && !test->WriteDifference(o.difference.c_str())) {
    throw failure("cannot write " + o.difference);
  }
  print(o, test);
  row("verdict", alike ? "alike" : "they differ: " + test->GetReason());
  return alike;
}
} // namespace cli

// SPDX-License-Identifier: BSD-3-Clause
// Shared parts of the command line: failures, a context with a progress bar, small text helpers.
#pragma once

#include "stratus.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace cli {

// A reason why the picture is not written, as one sentence for the user.
struct failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// An invalid command line.
struct usage : failure {
  using failure::failure;
};

// A context of the core that draws a progress bar if the standard error is a terminal.
class context
{
public:
  context(const std::string& device, int threads);
  ~context();
  context(const context&) = delete;
  context& operator=(const context&) = delete;

  operator stratus_context*() const { return this->Context; }
  // Throws failure with `what` and the core's message unless the status is STRATUS_OK.
  void check(stratus_status status, const std::string& what) const;
  // Prints a row for each build stage since the context was made, with its device.
  void print_build_report() const;
  // Draws no bar from now on, because a film has its own.
  void quiet() { this->Terminal = false; }

private:
  static int progress(void* user, const char* stage, double fraction);
  void clear_bar();

  stratus_context* Context = nullptr;
  bool Terminal = false;
  int Shown = -1;
};

std::vector<std::string> split(const std::string& text, char separator);
// Parses a finite number. Throws usage that names `what` for any other text.
double number(const std::string& text, const std::string& what);
int whole_number(const std::string& text, const std::string& what, int low, int high);
// Returns the bytes of a size such as "2G" or "512M", in powers of 1024. Throws usage for another text, or a number out of range.
double byte_size(const std::string& text, const std::string& what, double low, double high);
// 1234567 -> "1,234,567"
std::string grouped(unsigned long long value);
// A line of a command's output: a name, which is empty if the line continues the one before it, and its value. For readers of JSON also the
// numbers of the value, if it has some.
struct printed_row {
  std::string name, text;
  std::vector<double> numbers;
};
// Prints a line.
void row(const char* name, const std::string& value, const std::vector<double>& numbers = {});
// Prints the line above rows, which names their subject.
void heading(const std::string& text);
// All rows so far, also if they are silenced.
const std::vector<printed_row>& printed_rows();
// Prints no headings, rows and progress from now on, and if `everything` is true, nothing else to the standard output, either.
void silence(bool everything);
// Whether bars of progress are drawn: the standard error is a terminal.
bool shows_progress();
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
} // namespace cli

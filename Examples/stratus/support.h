// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the command line share: one way to fail, a context with a progress bar, small text helpers.
#pragma once

#include "stratus.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace cli {

// Anything that keeps the picture from being written: one sentence for people.
struct failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The command was not understood.
struct usage : failure {
  using failure::failure;
};

// A context of the core that draws a progress bar on a terminal, and on nothing else.
class context
{
public:
  context(const std::string& device, int threads);
  ~context();
  context(const context&) = delete;
  context& operator=(const context&) = delete;

  operator stratus_context*() const { return this->Context; }
  // Throws the core's own message, after `what`.
  void check(stratus_status status, const std::string& what) const;

private:
  static int progress(void* user, const char* stage, double fraction);
  void clear_bar();

  stratus_context* Context = nullptr;
  bool Terminal = false;
  int Shown = -1;
};

std::vector<std::string> split(const std::string& text, char separator);
// A finite number and nothing else; throws usage naming `what`.
double number(const std::string& text, const std::string& what);
int whole_number(const std::string& text, const std::string& what, int low, int high);
// 1234567 -> "1,234,567"
std::string grouped(unsigned long long value);
// A line of what a command prints: what it is, and its value.
void row(const char* name, const std::string& value);
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));
} // namespace cli

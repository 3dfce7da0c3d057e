// SPDX-License-Identifier: BSD-3-Clause
#include "support.h"

#include "vtkStratusVariableReader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <unistd.h>

namespace cli {

static bool silent = false;

void silence(bool everything)
{
  silent = !everything || std::freopen("/dev/null", "w", stdout) != nullptr;
}

bool shows_progress()
{
  return !silent && isatty(STDERR_FILENO) != 0;
}

context::context(const std::string& device, int threads) : Terminal(shows_progress())
{
  stratus_context_options options = stratus_context_options_default();
  options.device = device.c_str();
  options.threads = threads;
  options.progress = &context::progress;
  options.progress_user = this;
  char message[1024];
  const stratus_status status = stratus_context_create(&options, &this->Context, message, sizeof message);
  if (status != STRATUS_OK) {
    throw failure("device '" + device + "': " + (message[0] ? message : stratus_status_name(status)));
  }
}

context::~context()
{
  this->clear_bar();
  stratus_context_destroy(this->Context);
}

void context::print_build_report() const
{
  stratus_build_stage stages[STRATUS_BUILD_STAGES_MAX];
  const int count = stratus_context_get_build_report(this->Context, stages, STRATUS_BUILD_STAGES_MAX);
  for (int i = 0; i < count; ++i) {
    const stratus_build_stage& s = stages[i];
    row("built",
      format("%s on %s: %s kernel%s, %.2f ms, %s KiB", s.name, s.where, grouped(s.kernels).c_str(), s.kernels == 1 ? "" : "s", s.ms,
        grouped((s.bytes + 1023) / 1024).c_str()));
  }
  if (count == 0) {
    row("built", "nothing");
  }
  if (const vtkTypeInt64 read = vtkStratusVariableReader::GetBytesRead()) {
    constexpr vtkTypeInt64 mebibyte = 1 << 20;
    row("read",
      grouped(static_cast<unsigned long long>(read / mebibyte)) + " MiB of bricks, " +
        grouped(static_cast<unsigned long long>(vtkStratusVariableReader::GetMemoryUsed() / mebibyte)) + " MiB in memory, limit " +
        grouped(static_cast<unsigned long long>(vtkStratusVariableReader::GetMemoryLimit() / mebibyte)));
  }
}

void context::check(stratus_status status, const std::string& what) const
{
  if (status != STRATUS_OK) {
    const std::string message = stratus_context_message(this->Context);
    throw failure(what + ": " + (message.empty() ? stratus_status_name(status) : message));
  }
}

int context::progress(void* user, const char* stage, double fraction)
{
  context* self = static_cast<context*>(user);
  const int width = 40;
  const int filled = static_cast<int>(fraction * width + 0.5);
  if (self->Terminal && filled != self->Shown) {
    const std::string bar = std::string(static_cast<size_t>(filled), '#') + std::string(static_cast<size_t>(width - filled), '.');
    std::fprintf(stderr, "\r\033[K[%s] %s", bar.c_str(), stage);
    self->Shown = filled;
    if (filled == width) {
      self->clear_bar();
    }
  }
  return 0;
}

void context::clear_bar()
{
  if (this->Terminal && this->Shown >= 0) {
    std::fprintf(stderr, "\r\033[K");
    this->Shown = -1;
  }
}

std::vector<std::string> split(const std::string& text, char separator)
{
  std::vector<std::string> parts;
  std::string part;
  std::istringstream stream(text);
  while (std::getline(stream, part, separator)) {
    parts.push_back(part);
  }
  if (!text.empty() && text.back() == separator) {
    parts.emplace_back();
  }
  return parts;
}

double number(const std::string& text, const std::string& what)
{
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end || !std::isfinite(value)) {
    throw usage(what + ": '" + text + "' is not a finite number");
  }
  return value;
}

int whole_number(const std::string& text, const std::string& what, int low, int high)
{
  const double value = number(text, what);
  if (value != std::floor(value) || value < low || value > high) {
    throw usage(what + ": '" + text + "' is not a whole number within " + std::to_string(low) + ".." + std::to_string(high));
  }
  return static_cast<int>(value);
}

double byte_size(const std::string& text, const std::string& what, double low, double high)
{
  static const std::string units = "KMGT";
  const size_t digits = std::min(text.find_first_not_of("0123456789.eE+"), text.size());
  const std::string unit = text.substr(digits);
  const size_t power = unit.empty() ? 0 : units.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit[0]))));
  if (digits == 0 || power == std::string::npos || unit.size() > 1) {
    throw usage(what + ": '" + text + "' is not a size such as 512M or 2G (K, M, G, T)");
  }
  const double bytes = number(text.substr(0, digits), what) * (unit.empty() ? 1.0 : std::pow(1024.0, static_cast<double>(power + 1)));
  if (!(bytes >= low && bytes <= high)) {
    throw usage(what + ": '" + text + "' is " + format("%.0f bytes, must be %.0f to %.0f", bytes, low, high));
  }
  return bytes;
}

std::string grouped(unsigned long long value)
{
  std::string text = std::to_string(value);
  for (int at = static_cast<int>(text.size()) - 3; at > 0; at -= 3) {
    text.insert(static_cast<size_t>(at), ",");
  }
  return text;
}

static std::vector<printed_row>& rows()
{
  static std::vector<printed_row> all;
  return all;
}

const std::vector<printed_row>& printed_rows()
{
  return rows();
}

void row(const char* name, const std::string& value, const std::vector<double>& numbers)
{
  rows().push_back({ name, value, numbers });
  if (!silent) {
    std::printf("  %-11s %s\n", name, value.c_str());
  }
}

void heading(const std::string& text)
{
  if (!silent) {
    std::printf("%s\n", text.c_str());
  }
}

std::string format(const char* pattern, ...)
{
  char text[1024];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}
} // namespace cli

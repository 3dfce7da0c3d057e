// SPDX-License-Identifier: BSD-3-Clause
#include "bench.h"

#include <cstdlib>
#include <unistd.h>

namespace bench {

namespace {

// stratus-bench all captures its parts' output. It passes them the terminal's file number and its own progress by these variables.
const char* const terminal_variable = "STRATUS_BENCH_TERMINAL";
const char* const whole_variable = "STRATUS_BENCH_WHOLE";

std::FILE* open_terminal()
{
  const char* number = std::getenv(terminal_variable);
  const int file = number ? std::atoi(number) : STDERR_FILENO;
  return isatty(file) ? fdopen(dup(file), "w") : nullptr;
}
} // namespace

std::string duration(double ms)
{
  const auto seconds = static_cast<long>(ms / 1000.0 + 0.5);
  char text[64];
  if (seconds < 60) {
    std::snprintf(text, sizeof text, "%ld s", seconds);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld min", seconds / 60, seconds % 60);
  }
  return text;
}

progress::progress(size_t scenes, size_t methods)
    : Scenes(scenes), Methods(methods), Start(now_ms()), SceneStart(Start), Terminal(open_terminal())
{
}

progress::~progress()
{
  if (this->Terminal) {
    this->clear();
    std::fclose(this->Terminal);
  }
}

void progress::clear() const
{
  std::fprintf(this->Terminal, "\r\033[K");
  std::fflush(this->Terminal);
}

void progress::at(const std::string& scene, const std::string& method)
{
  ++this->Method;
  this->show(scene, method);
}

void progress::show(const std::string& scene, const std::string& what) const
{
  if (!this->Terminal) {
    return;
  }
  const char* whole = std::getenv(whole_variable);
  const size_t done = this->Scene * this->Methods + this->Method - 1, all = this->Scenes * this->Methods;
  const double spent = now_ms() - this->Start;
  std::fprintf(this->Terminal, "\r\033[K  %s, %s (%zu of %zu)", scene.c_str(), what.c_str(), this->Method, this->Methods);
  if (whole) {
    std::fprintf(this->Terminal, "; %s", whole);
  } else if (done > 0 && all > done) {
    const double left = spent * static_cast<double>(all - done) / static_cast<double>(done);
    std::fprintf(this->Terminal, "; scene %zu of %zu, about %s left", this->Scene + 1, this->Scenes, duration(left).c_str());
  }
  std::fflush(this->Terminal);
}

void progress::end_scene(const std::string& scene)
{
  const double now = now_ms();
  ++this->Scene;
  this->Method = 0;
  if (this->Terminal) {
    this->clear();
  }
  if (!std::getenv(whole_variable)) {
    std::fprintf(stderr, "%s: %s, scene %zu of %zu", scene.c_str(), duration(now - this->SceneStart).c_str(), this->Scene, this->Scenes);
    if (this->Scene < this->Scenes) {
      const double left = (now - this->Start) * static_cast<double>(this->Scenes - this->Scene) / static_cast<double>(this->Scene);
      std::fprintf(stderr, ", about %s left", duration(left).c_str());
    }
    std::fprintf(stderr, "\n");
  }
  this->SceneStart = now;
}
} // namespace bench

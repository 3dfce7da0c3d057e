// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusTetGenProcess.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {
[[noreturn]] void Fail(const std::string& text)
{
  throw vtkStratusTetGenFailure{ text };
}

// The meaning of a number that TetGen throws.
std::string Meaning(std::int64_t status)
{
  switch (status) {
    case 1:
      return "TetGen ran out of memory";
    case 2:
      return "TetGen came upon an error of its own; the surface may cross itself or not be closed";
    case 3:
      return "the surface crosses itself";
    case 4:
      return "the surface has a feature that is too small for its extent";
    case 5:
      return "two facets of the surface nearly coincide";
    case 10:
      return "TetGen refuses the surface";
    default:
      return "TetGen failed with status " + std::to_string(status);
  }
}

// A child process, killed with the object.
class Child
{
public:
  Child(const std::string& program, int request, int answer, int messages);
  ~Child();
  Child(const Child&) = delete;
  void operator=(const Child&) = delete;
  // Returns whether the process has ended.
  bool Poll();
  int GetStatus() const { return this->Status; }
  bool IsStatusKnown() const { return this->Known; }

private:
  pid_t Process = -1;
  int Status = 0;
  bool Ended = false, Known = true;
};

Child::Child(const std::string& program, int request, int answer, int messages)
{
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, request, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&actions, answer, tetgen_exchange::AnswerDescriptor);
  // The program gets the default signal handling, whatever the application has set.
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::string name = program;
  char* arguments[] = { &name[0], nullptr };
  const int error = posix_spawn(&this->Process, program.c_str(), &actions, &attributes, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    this->Ended = true;
    Fail("can't start " + program + ": " + std::strerror(error));
  }
}

Child::~Child()
{
  if (!this->Ended) {
    kill(this->Process, SIGKILL);
    while (waitpid(this->Process, nullptr, 0) < 0 && errno == EINTR) {}
  }
}

bool Child::Poll()
{
  if (!this->Ended) {
    const pid_t ended = waitpid(this->Process, &this->Status, WNOHANG);
    // An application that ignores SIGCHLD, or waits for all children, leaves no status. The answer then shows whether the run succeeded.
    this->Known = !(ended < 0 && errno == ECHILD);
    this->Ended = ended == this->Process || !this->Known;
  }
  return this->Ended;
}

bool IsProgram(const std::string& path)
{
  return access(path.c_str(), X_OK) == 0;
}

void CheckEnd(const Child& child, vtkStratusTetGenSpool& answer, vtkStratusTetGenSpool& messages)
{
  tetgen_exchange::Answer header = {};
  answer.Rewind();
  const bool complete = answer.Read(&header, sizeof header) && header.Magic == tetgen_exchange::AnswerMagic;
  messages.Rewind();
  std::string said = messages.ReadText(400);
  said = said.empty() ? "" : "; it said: " + said;
  if (child.IsStatusKnown() && WIFSIGNALED(child.GetStatus())) {
    const int signal = WTERMSIG(child.GetStatus());
    Fail("TetGen crashed (signal " + std::to_string(signal) + ", " + strsignal(signal) +
      "): the surface may cross itself or not be closed" + said);
  }
  if (complete && header.Status != 0) {
    Fail(Meaning(header.Status) + said);
  }
  if (!complete || (child.IsStatusKnown() && child.GetStatus() != 0)) {
    Fail("TetGen ended without a mesh" + said);
  }
}
} // namespace

vtkStratusTetGenSpool::vtkStratusTetGenSpool() : File(std::tmpfile())
{
  this->Descriptor = this->File ? fcntl(fileno(this->File), F_DUPFD_CLOEXEC, 16) : -1;
  if (this->Descriptor < 0) {
    const std::string reason = std::strerror(errno);
    if (this->File) {
      std::fclose(this->File);
    }
    Fail("can't make a temporary file: " + reason);
  }
  std::fclose(this->File); // the duplicate stays open and, unlike the original, is not inherited
  this->File = nullptr;
}

vtkStratusTetGenSpool::~vtkStratusTetGenSpool()
{
  close(this->Descriptor);
}

void vtkStratusTetGenSpool::Write(const void* values, size_t bytes)
{
  const char* begin = static_cast<const char*>(values);
  while (bytes > 0) {
    const ssize_t put = write(this->Descriptor, begin, std::min(bytes, size_t(1) << 30));
    if (put < 0 && errno == EINTR) {
      continue;
    }
    if (put <= 0) {
      Fail(std::string("can't write a temporary file: ") + std::strerror(errno));
    }
    begin += put;
    bytes -= static_cast<size_t>(put);
  }
}

void vtkStratusTetGenSpool::Rewind()
{
  if (lseek(this->Descriptor, 0, SEEK_SET) != 0) {
    Fail(std::string("can't read a temporary file: ") + std::strerror(errno));
  }
}

bool vtkStratusTetGenSpool::Read(void* values, size_t bytes)
{
  char* begin = static_cast<char*>(values);
  while (bytes > 0) {
    const ssize_t got = read(this->Descriptor, begin, std::min(bytes, size_t(1) << 30));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      return false;
    }
    begin += got;
    bytes -= static_cast<size_t>(got);
  }
  return true;
}

std::string vtkStratusTetGenSpool::ReadText(size_t most)
{
  std::vector<char> text(most);
  const ssize_t got = read(this->Descriptor, text.data(), most);
  std::string shown(text.data(), got > 0 ? static_cast<size_t>(got) : 0);
  std::replace_if(
    shown.begin(), shown.end(), [](char c) { return c < ' ' || c > '~'; }, ' ');
  shown.resize(shown.find_last_not_of(' ') + 1);
  return shown;
}

std::string vtkStratusTetGenFindProgram(const std::string& asked)
{
  if (!asked.empty()) {
    if (!IsProgram(asked)) {
      Fail("Program is '" + asked + "', which is not there or not executable");
    }
    return asked;
  }
  Dl_info info;
  std::string folder = ".";
  if (dladdr(reinterpret_cast<void*>(&vtkStratusTetGenFindProgram), &info) && info.dli_fname) {
    folder = info.dli_fname;
    folder = folder.substr(0, folder.find_last_of('/') + 1);
  }
  for (const char* path : { STRATUS_TETGEN_PATH, "../bin/stratus-tetgen", "stratus-tetgen" }) {
    if (IsProgram(folder + path)) {
      return folder + path;
    }
  }
  Fail("the program stratus-tetgen is not at " + folder + STRATUS_TETGEN_PATH + "; set its path by SetProgram()");
}

void vtkStratusTetGenRun(const std::string& program, double time_limit, vtkStratusTetGenSpool& request, vtkStratusTetGenSpool& answer,
  const std::function<bool(double)>& stop)
{
  using Clock = std::chrono::steady_clock;
  vtkStratusTetGenSpool messages;
  const Clock::time_point begin = Clock::now();
  Child child(program, request.GetDescriptor(), answer.GetDescriptor(), messages.GetDescriptor());
  for (int turn = 0; !child.Poll(); ++turn) {
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    if (seconds > time_limit) {
      Fail("TetGen did not end within TimeLimit, " + std::to_string(time_limit) +
        " s; a higher RadiusEdgeRatio or MaximumVolume or a limit of Steiner points let it end sooner");
    }
    if (stop(seconds)) {
      Fail("TetGen was aborted");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(std::min(1 + turn, 50)));
  }
  CheckEnd(child, answer, messages);
}

// SPDX-License-Identifier: BSD-3-Clause
#include "output.h"

#include "support.h"

#include "vtkStratusTemporaryFile.h"

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

// The file that a signal handler removes. There is one at a time. has_temporary is set only while the program's own file exists.
char temporary[PATH_MAX];
std::atomic<bool> has_temporary = { false };

constexpr int endings[] = { SIGHUP, SIGINT, SIGQUIT, SIGPIPE, SIGTERM, SIGXCPU };
constexpr size_t ending_count = sizeof endings / sizeof endings[0];
struct sigaction before[ending_count]; // an OpenCL compiler in this process may have handlers that remove files of its own

void remove_and_end(int number)
{
  if (has_temporary) {
    unlink(temporary);
  }
  for (size_t i = 0; i < ending_count; ++i) {
    if (endings[i] == number) {
      sigaction(number, &before[i], nullptr);
    }
  }
  raise(number); // delivered when this handler returns
}

// Catches the signals that end a program, except ignored ones (nohup). A file that grows beyond its size limit is an error like a full
// disk.
void catch_signals()
{
  for (size_t i = 0; i < ending_count; ++i) {
    struct sigaction action = {};
    action.sa_handler = &remove_and_end;
    sigemptyset(&action.sa_mask);
    if (sigaction(endings[i], nullptr, &before[i]) == 0 && before[i].sa_handler != SIG_IGN) {
      sigaction(endings[i], &action, nullptr);
    }
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

// Blocks signals while a file and the handler's record of it change together. Otherwise a signal could leave the program's file behind, or
// remove a file of that name that is not the program's.
class signals_wait
{
public:
  signals_wait()
  {
    sigset_t all;
    sigemptyset(&all);
    for (int number : endings) {
      sigaddset(&all, number);
    }
    pthread_sigmask(SIG_BLOCK, &all, &this->Before);
  }
  ~signals_wait() { pthread_sigmask(SIG_SETMASK, &this->Before, nullptr); }
  signals_wait(const signals_wait&) = delete;
  signals_wait& operator=(const signals_wait&) = delete;

private:
  sigset_t Before;
};

bool same_file(const struct stat& one, const struct stat& other)
{
  return one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

// Returns the standard stream that already writes to this file, as for /dev/stdout, or -1.
int standard_stream(const struct stat& status)
{
  for (int number : { STDOUT_FILENO, STDERR_FILENO, STDIN_FILENO }) {
    struct stat open;
    if (fstat(number, &open) == 0 && same_file(open, status) && (fcntl(number, F_GETFL) & O_ACCMODE) != O_RDONLY) {
      return number;
    }
  }
  return -1;
}
} // namespace

namespace cli {

output_file::output_file(const std::string& path) : Path(path), Target(path)
{
  struct stat status;
  const bool exists = stat(path.c_str(), &status) == 0;
  if (!exists && errno != ENOENT) {
    this->fail(errno);
  }
  if (exists && S_ISDIR(status.st_mode)) {
    throw failure("cannot write '" + path + "': it is a folder");
  }
  this->Stream = exists ? standard_stream(status) : -1;
  if (exists && this->Stream < 0 && access(path.c_str(), W_OK) != 0) { // a rename needs no such permission
    this->fail(errno);
  }
  this->InPlace = this->Stream >= 0 || !vtkStratusFindTarget(path, this->Target);
  const std::string folder = this->Target.substr(0, this->Target.find_last_of('/') + 1);
  if (!this->InPlace && access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) != 0) {
    this->fail(errno);
  }
}

output_file::~output_file()
{
  if (this->File) {
    std::fclose(this->File);
  }
  if (this->HasTemporary) {
    const signals_wait waiting;
    std::remove(temporary);
    has_temporary = false;
  }
}

void output_file::fail(int reason)
{
  throw failure("cannot write '" + this->Path + "': " + std::strerror(reason));
}

void output_file::open()
{
  catch_signals();
  if (this->Stream >= 0) {
    // Standard output's earlier lines must come before the picture, its later ones behind it.
    std::fflush(stdout);
    const int stream = dup(this->Stream);
    this->File = stream >= 0 ? fdopen(stream, "wb") : nullptr;
  } else if (this->InPlace) {
    this->File = std::fopen(this->Path.c_str(), "wb");
  }
  for (int number = 0; !this->InPlace && !this->File && (number == 0 || errno == EEXIST); ++number) {
    const std::string name = vtkStratusTemporaryName(this->Target, number);
    if (name.size() >= sizeof temporary) {
      this->fail(ENAMETOOLONG);
    }
    std::strcpy(temporary, name.c_str());
    const signals_wait waiting;
    this->File = vtkStratusCreateTemporary(name, this->Target);
    has_temporary = this->HasTemporary = this->File != nullptr;
  }
  if (!this->File) {
    this->fail(errno);
  }
}

void output_file::write(const std::vector<uint8_t>& bytes)
{
  this->open();
  // The bytes reach the disk before the rename, so that a crash leaves the old file or the new one. A pipe cannot be synchronized.
  if (std::fwrite(bytes.data(), 1, bytes.size(), this->File) != bytes.size() || std::fflush(this->File) != 0 ||
    (fsync(fileno(this->File)) != 0 && !this->InPlace)) {
    this->fail(errno);
  }
  std::FILE* file = this->File;
  this->File = nullptr;
  const signals_wait waiting;
  if (std::fclose(file) != 0 || (!this->InPlace && std::rename(temporary, this->Target.c_str()) != 0)) {
    this->fail(errno);
  }
  this->HasTemporary = has_temporary = false;
}
} // namespace cli

// SPDX-License-Identifier: BSD-3-Clause
#include "reading.h"

#include "support.h"

#include <vtkAlgorithm.h>
#include <vtkCommand.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <vector>
#ifdef __linux__
#include <sys/syscall.h>
#endif
#ifdef __has_feature // clang's form of __SANITIZE_ADDRESS__
#define FEATURE(name) __has_feature(name)
#else
#define FEATURE(name) 0
#endif
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !FEATURE(address_sanitizer) && !FEATURE(thread_sanitizer)
#define CATCH_CRASHES
#endif

namespace {

constexpr int looks = 20; // looks per timeout; counting them keeps a program that was stopped meanwhile from being taken for a hanging one
double timeout = cli::usual_read_timeout;

constexpr struct {
  int number;
  const char* name;
} crashes[] = { { SIGSEGV, "SIGSEGV" }, { SIGBUS, "SIGBUS" }, { SIGABRT, "SIGABRT" }, { SIGFPE, "SIGFPE" }, { SIGILL, "SIGILL" } };
constexpr size_t crash_count = sizeof crashes / sizeof crashes[0];
constexpr size_t stack_bytes = 65536;

// State that the handler needs, prepared before it runs. One file is read at a time.
char crash_text[8192];
struct sigaction before[crash_count];
stack_t stack_before;
std::vector<char> own_stack;
long reading_thread;

void put(const char* text)
{
  size_t left = std::strlen(text);
  for (ssize_t done; left > 0 && (done = write(STDERR_FILENO, text, left)) > 0; left -= static_cast<size_t>(done)) {
    text += done;
  }
}

long thread_number()
{
#ifdef __linux__
  return syscall(SYS_gettid);
#else
  return 0;
#endif
}

// A crash of another thread than the one that reads is not the reader's: it ends the program as it would without this handler. A signal
// that another process sends comes to any thread.
void report_crash(int number, siginfo_t* from, void*)
{
  if (from->si_code != SI_USER && thread_number() != reading_thread) {
    for (size_t i = 0; i < crash_count; ++i) {
      if (crashes[i].number == number) {
        sigaction(number, &before[i], nullptr);
      }
    }
    raise(number);
    return;
  }
  put(crash_text);
  for (const auto& crash : crashes) {
    put(crash.number == number ? crash.name : "");
  }
  put(")\n");
  _exit(1);
}

void prepare(const std::string& path, const std::string& by)
{
  std::snprintf(crash_text, sizeof crash_text, "stratus: cannot read '%s': %s crashed (", path.c_str(), by.c_str());
}
} // namespace

namespace cli {

void set_read_timeout(double seconds)
{
  timeout = seconds;
}

class reading::watchdog
{
public:
  watchdog(const std::string& path, const std::string& by, double seconds) : Path(path), By(by), Seconds(seconds)
  {
#ifdef __linux__
    this->Counters = "/proc/self/task/" + std::to_string(thread_number()) + "/io";
#endif
    if (this->bytes() == "") {
      return;
    }
    try {
      this->Thread = std::thread([this] { this->watch(); });
    } catch (const std::system_error&) { // without a thread, reading goes on unwatched
    }
  }

  ~watchdog()
  {
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      this->Done = true;
    }
    this->Changed.notify_all();
    if (this->Thread.joinable()) {
      this->Thread.join();
    }
  }

  void follow(const std::string& by)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->By = by;
  }

  std::atomic<unsigned long long> Events = { 0 };

private:
  // Returns the counters of bytes that the thread has read, by calls and from the disk; empty where the system has none.
  std::string bytes() const
  {
    std::string result, line;
    std::ifstream file(this->Counters);
    while (std::getline(file, line)) {
      if (line.compare(0, 6, "rchar:") == 0 || line.compare(0, 11, "read_bytes:") == 0) {
        result += line;
      }
    }
    return result;
  }

  void watch()
  {
    std::string last;
    unsigned long long events = 0;
    int idle = 0;
    std::unique_lock<std::mutex> lock(this->Mutex);
    while (!this->Changed.wait_for(lock, std::chrono::duration<double>(this->Seconds / looks), [this] { return this->Done; })) {
      const std::string now = this->bytes();
      idle = now == last && events == this->Events ? idle + 1 : 0;
      last = now;
      events = this->Events;
      if (idle == looks) {
        put((
          "stratus: cannot read '" + this->Path + "': " + this->By + format(" made no progress for %g s (--read-timeout)\n", this->Seconds))
              .c_str());
        _exit(1);
      }
    }
  }

  std::string Path, By, Counters;
  double Seconds;
  bool Done = false;
  std::mutex Mutex;
  std::condition_variable Changed;
  std::thread Thread;
};

reading::reading(const std::string& path, const std::string& by) : Path(path)
{
  if (timeout > 0.0) {
    this->Watchdog.reset(new watchdog(path, by, timeout));
  }
  prepare(path, by);
  this->catch_crashes();
}

// Handlers run on a separate stack, because the crash may be a stack overflow. They replace an OpenCL compiler's handlers in this process,
// but not a sanitizer's.
void reading::catch_crashes()
{
#ifdef CATCH_CRASHES
  reading_thread = thread_number();
  own_stack.resize(stack_bytes);
  stack_t stack = {};
  stack.ss_sp = own_stack.data();
  stack.ss_size = own_stack.size();
  sigaltstack(&stack, &stack_before);
  for (size_t i = 0; i < crash_count; ++i) {
    struct sigaction action = {};
    action.sa_sigaction = &report_crash;
    action.sa_flags = SA_ONSTACK | SA_SIGINFO;
    sigemptyset(&action.sa_mask);
    sigaction(crashes[i].number, &action, &before[i]);
  }
#endif
}

reading::~reading()
{
  if (this->Followed) {
    this->Followed->RemoveObserver(this->Observer);
  }
#ifdef CATCH_CRASHES
  reading_thread = 0; // what comes later is not the reader's
  for (size_t i = 0; i < crash_count; ++i) {
    struct sigaction now = {};
    sigaction(crashes[i].number, nullptr, &now);
    if (now.sa_sigaction == &report_crash) { // else a reader has mapped its file, and catches what the file lacks, for longer
      sigaction(crashes[i].number, &before[i], nullptr);
    }
  }
  sigaltstack(&stack_before, nullptr);
#endif
}

void reading::follow(vtkAlgorithm* reader)
{
  const char* by = reader->GetClassName();
  prepare(this->Path, by);
  if (this->Watchdog) {
    this->Watchdog->follow(by);
    std::atomic<unsigned long long>& events = this->Watchdog->Events;
    class counter : public vtkCommand
    {
    public:
      explicit counter(std::atomic<unsigned long long>& events) : Events(events) {}
      void Execute(vtkObject*, unsigned long, void*) override { ++this->Events; }
      std::atomic<unsigned long long>& Events;
    };
    vtkCommand* command = new counter(events);
    this->Followed = reader;
    this->Observer = reader->AddObserver(vtkCommand::ProgressEvent, command);
    command->Delete();
  }
}
} // namespace cli

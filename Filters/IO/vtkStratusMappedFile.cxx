// SPDX-License-Identifier: BSD-3-Clause
#include "vtkStratusMappedFile.h"

#include "vtkStratusBricks.h"
#include "vtkStratusIdentity.h"
#include "vtkStratusMapped.h"
#include "vtkStratusOpenFile.h"

#include "stratus/volume.h"

#include "vtkByteSwap.h"
#include "vtkDataArray.h"

#if defined(__unix__) || defined(__APPLE__)
#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <memory>
#include <mutex>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

constexpr size_t MappingsMost = 1024; // at once
constexpr int64_t Samples = 64;       // parts of a file that its identity reads
constexpr int64_t SampleBytes = 4096;

// A mapping that is in use. The handler reads it, so that it has no locks: `End` is written last, and 0 while the slot is free.
struct Slot {
  std::atomic<uintptr_t> Begin = { 0 }, End = { 0 };
  std::atomic<uint64_t> Missing = { 0 }; // bytes that could not be read
  const void* Values = nullptr;
};

static_assert(
  sizeof(std::atomic<uint64_t>) == sizeof(uint64_t) && std::atomic<uint64_t>::is_always_lock_free, "the core reads it as a number");

std::array<Slot, MappingsMost> Slots;
std::mutex Lock; // of those that take and free slots
struct sigaction Before;
uintptr_t PageBytes;

// A page of a mapping that the file doesn't have any more is replaced by zeros. Every other SIGBUS goes where it went before.
void HandleBus(int number, siginfo_t* from, void* context)
{
  const uintptr_t at = reinterpret_cast<uintptr_t>(from->si_addr);
  for (Slot& slot : Slots) {
    const uintptr_t end = slot.End.load();
    if (at < end && at >= slot.Begin.load()) {
      void* const page = reinterpret_cast<void*>(at / PageBytes * PageBytes);
      if (mmap(page, PageBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) == page) {
        slot.Missing += PageBytes;
        return;
      }
    }
  }
  if (Before.sa_flags & SA_SIGINFO) {
    Before.sa_sigaction(number, from, context);
  } else if (Before.sa_handler != SIG_DFL && Before.sa_handler != SIG_IGN) {
    Before.sa_handler(number);
  } else {
    sigaction(number, &Before, nullptr); // the instruction runs again, and the signal ends the program
  }
}

void CatchBus()
{
  struct sigaction action = {}, now = {};
  action.sa_sigaction = &HandleBus;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&action.sa_mask);
  if (sigaction(SIGBUS, nullptr, &now) == 0 && now.sa_sigaction != &HandleBus) {
    Before = now;
    sigaction(SIGBUS, &action, nullptr);
  }
}

Slot* TakeSlot(void* mapped, size_t bytes, const void* values)
{
  const std::lock_guard<std::mutex> lock(Lock);
  for (Slot& slot : Slots) {
    if (slot.End == 0) {
      slot.Missing = 0;
      slot.Values = values;
      slot.Begin = reinterpret_cast<uintptr_t>(mapped);
      slot.End = slot.Begin + bytes;
      CatchBus();
      return &slot;
    }
  }
  return nullptr;
}

// Frees the mapping of an array that is deleted.
void Unmap(void* values)
{
  const std::lock_guard<std::mutex> lock(Lock);
  for (Slot& slot : Slots) {
    if (slot.End != 0 && slot.Values == values) {
      const uintptr_t begin = slot.Begin, end = slot.End;
      slot.End = 0;
      munmap(reinterpret_cast<void*>(begin), end - begin);
      return;
    }
  }
}

// FNV-1a of 64 bits.
uint64_t Hash(const void* bytes, size_t count, uint64_t hash)
{
  for (size_t i = 0; i < count; ++i) {
    hash = (hash ^ static_cast<const unsigned char*>(bytes)[i]) * UINT64_C(0x100000001b3);
  }
  return hash;
}

// Of files of the same length and time it differs with the bytes in some places, which catches a file that is written in place with its
// old time. Never 0.
uint64_t IdentityOf(int file, const struct stat& status, int64_t begin, int64_t bytes)
{
#ifdef __APPLE__
  const timespec& time = status.st_mtimespec;
#else
  const timespec& time = status.st_mtim;
#endif
  const std::array<int64_t, 5> numbers = { static_cast<int64_t>(status.st_size), static_cast<int64_t>(time.tv_sec),
    static_cast<int64_t>(time.tv_nsec), begin, bytes };
  uint64_t hash = Hash(numbers.data(), sizeof numbers, UINT64_C(0xcbf29ce484222325));
  std::array<char, SampleBytes> sample;
  const int64_t last = std::max<int64_t>(bytes - SampleBytes, 0);
  for (int64_t i = 0; i < Samples; ++i) {
    const int64_t at = begin + last / (Samples - 1) * i;
    const ssize_t got = pread(file, sample.data(), sample.size(), static_cast<off_t>(at));
    hash = Hash(sample.data(), got > 0 ? static_cast<size_t>(got) : 0, hash);
  }
  return hash ? hash : 1;
}

// Takes the whole pages of a part of a mapping out of the process. They stay in the system's memory as long as it has room.
void Forget(const char* begin, size_t bytes)
{
  const uintptr_t first = (reinterpret_cast<uintptr_t>(begin) + PageBytes - 1) / PageBytes * PageBytes;
  const uintptr_t end = (reinterpret_cast<uintptr_t>(begin) + bytes) / PageBytes * PageBytes;
  if (first < end) {
    (void)madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
  }
}

vtkSmartPointer<vtkDataArray> MapOpen(int file, int64_t begin, const char* name, int type, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(type));
  const int64_t size = array->GetDataTypeSize(), values = static_cast<int64_t>(tuples) * components, bytes = values * size;
  struct stat status;
  PageBytes = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  const int64_t page = static_cast<int64_t>(PageBytes), first = begin / page * page;
  if (bytes == 0 || begin % size != 0 || fstat(file, &status) != 0 || status.st_size < begin + bytes) {
    return nullptr;
  }
  const size_t length = static_cast<size_t>(begin - first + bytes);
  void* const mapped = mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE, file, static_cast<off_t>(first));
  if (mapped == MAP_FAILED) {
    return nullptr;
  }
  void* const at = static_cast<char*>(mapped) + (begin - first);
  Slot* const slot = TakeSlot(mapped, length, at);
  if (!slot) {
    munmap(mapped, length);
    return nullptr;
  }
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetVoidArray(at, values, 0, vtkAbstractArray::VTK_DATA_ARRAY_USER_DEFINED);
  array->SetArrayFreeFunction(&Unmap);
  vtkStratusSetMapped(array, IdentityOf(file, status, begin, bytes), reinterpret_cast<const uint64_t*>(&slot->Missing));
  return array;
}
// Returns the points of a box as bricks; null where they can't be made.
vtkSmartPointer<vtkDataArray> MakeRawBricks(const std::string& path, int64_t begin, const char* name, int type, int components,
  const int64_t sizes[3], const vtkStratusBox& box, bool swaps)
{
  const auto file = std::make_shared<vtkStratusOpenFile>(path);
  const int64_t word = vtkDataArray::GetDataTypeSize(type), value = components * word, row = sizes[0] * value, rows = sizes[1],
                across = sizes[0];
  vtkStratusBrickSource source;
  source.Name = name;
  source.Type = type;
  source.Components = components;
  std::copy_n(sizes, 3, source.Dimensions.begin());
  source.Brick = { { 1, 1, 1 } }; // any box
  source.Identity = vtkStratusIdentityOfFile(path, begin, row * rows * sizes[2]);
  source.Identity = swaps ? vtkStratusIdentityOfPart(source.Identity, "swapped", {}) : source.Identity;
  const auto mapped = vtkStratusMapFile(path, begin, name, VTK_UNSIGNED_CHAR, 1, row * rows * sizes[2]); // bytes, wherever they begin
  stratus_volume volume = stratus_volume_default();
  vtkStratusSetSource(mapped, 0, volume);
  const char* const first = mapped ? static_cast<const char*>(mapped->GetVoidPointer(0)) : nullptr;
  const volatile uint64_t* const missing = volume.missing;
  source.Read = [file, mapped, first, missing, begin, word, value, row, rows, across, swaps](
                  const int64_t lo[3], const int64_t size[3], void* values) {
    const bool wide = size[0] == across; // whole rows follow one another
    const int64_t runs = wide ? 1 : size[1];
    const size_t bytes = static_cast<size_t>(size[0] * value * (wide ? size[1] : 1));
    const auto at = [&](int64_t z) { return ((lo[2] + z) * rows + lo[1]) * row + lo[0] * value; };
    for (int64_t z = 0; !wide && z < size[2]; ++z) {
      file->Expect(begin + at(z), size[1] * row); // all layers at once: of parts of rows, the disk reads whole ones
    }
    char* to = static_cast<char*>(values);
    const uint64_t before = missing ? *missing : 0;
    bool whole = true;
    for (int64_t z = 0; z < size[2]; ++z) {
      for (int64_t run = 0; run < runs; ++run, to += bytes) {
        if (first) { // short rows are copied faster than the system reads them
          std::memcpy(to, first + at(z) + run * row, bytes);
        } else {
          whole = file->Read(begin + at(z) + run * row, to, bytes) && whole;
        }
      }
    }
    if (first) {
      Forget(first + at(0), static_cast<size_t>(at(size[2] - 1) + size[1] * row - at(0)));
    }
    if (swaps) {
      vtkByteSwap::SwapVoidRange(values, static_cast<size_t>((to - static_cast<char*>(values)) / word), static_cast<size_t>(word));
    }
    return whole && (!missing || *missing == before);
  };
  vtkStratusCutSource(source, box.Low, box.Size);
  return !file->IsOpen() ? nullptr : vtkStratusMakeBricks(source);
}
} // namespace

vtkSmartPointer<vtkDataArray> vtkStratusMapFile(
  const std::string& path, int64_t begin, const char* name, int type, int components, vtkIdType tuples)
{
  const vtkStratusOpenFile file(path);
  return !file.IsOpen() ? nullptr : MapOpen(file.GetHandle(), begin, name, type, components, tuples);
}

vtkSmartPointer<vtkDataArray> vtkStratusLeaveRaw(const std::string& path, int64_t begin, const char* name, int type, int components,
  const int64_t sizes[3], const vtkStratusBox& box, bool bricks, bool swaps)
{
  const int64_t points = box.Size[0] * box.Size[1] * box.Size[2], value = components * vtkDataArray::GetDataTypeSize(type);
  const bool rows = box.Size[0] == sizes[0], layers = rows && box.Size[1] == sizes[1];
  const bool one_run = layers || (rows && box.Size[2] == 1) || (box.Size[1] == 1 && box.Size[2] == 1);
  const bool beyond = vtkStratusHasBrickMemory() && points * value > vtkStratusGetBrickMemory(); // else the system forgets pages
  vtkSmartPointer<vtkDataArray> array;
  if (beyond || !one_run || swaps) {
    array = MakeRawBricks(path, begin, name, type, components, sizes, box, swaps);
  }
  if (!array && one_run && !swaps) {
    const int64_t first = (box.Low[2] * sizes[1] + box.Low[1]) * sizes[0] + box.Low[0];
    array = vtkStratusMapFile(path, begin + first * value, name, type, components, points);
  }
  return array || !bricks ? array : MakeRawBricks(path, begin, name, type, components, sizes, box, swaps);
}

uint64_t vtkStratusIdentityOfFile(const std::string& path, int64_t begin, int64_t bytes)
{
  const vtkStratusOpenFile file(path);
  struct stat status;
  if (!file.IsOpen() || fstat(file.GetHandle(), &status) != 0) {
    return 0;
  }
  return IdentityOf(file.GetHandle(), status, begin, bytes < 0 ? static_cast<int64_t>(status.st_size) - begin : bytes);
}
#else
vtkSmartPointer<vtkDataArray> vtkStratusMapFile(const std::string&, int64_t, const char*, int, int, vtkIdType)
{
  return nullptr;
}

vtkSmartPointer<vtkDataArray> vtkStratusLeaveRaw(
  const std::string&, int64_t, const char*, int, int, const int64_t[3], const vtkStratusBox&, bool, bool)
{
  return nullptr;
}

uint64_t vtkStratusIdentityOfFile(const std::string&, int64_t, int64_t)
{
  return 0;
}
#endif

// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/disk_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <stop_token>
#include <thread>

#include "acquisition/importers/spool.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::size_t smallest = std::size_t{1} << 17;  ///< from which malloc maps arrays too
const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
constexpr std::size_t most_resident = std::size_t{1} << 26;

/// Addresses that the arrays may have, each its place in the file: so much as the file may grow on
/// any usual file system. Only what is in use takes memory or disk.
constexpr std::size_t room = std::size_t{1} << 42;

/// What operator new and delete have to know. Nothing here allocates.
struct Place {
  std::atomic<char*> begin = nullptr;  ///< of the addresses, once there was a DiskMemory
  std::atomic<std::size_t> used = 0;   ///< of them, from the first on: none is used twice
  std::atomic<int> file = -1;          ///< where new arrays go; -1: to memory
};

Place place;

/// An array's first page says how long it is, with that page.
std::size_t& length_at(char* first) {
  return *reinterpret_cast<std::size_t*>(first);
}

/// Memory that pages of files take, of which the arrays' are some. [bytes]
std::size_t resident() {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  char text[128] = {};
  const bool read = ::read(file, text, sizeof text - 1) > 0;
  ::close(file);
  unsigned long all = 0;
  unsigned long held = 0;
  unsigned long of_files = 0;
  if (!read || std::sscanf(text, "%lu %lu %lu", &all, &held, &of_files) != 3) return 0;
  return of_files * page;
}

}  // namespace

DiskMemory::DiskMemory(const std::string& of) {
  if (place.begin == nullptr) {
    void* const begin =
        ::mmap(nullptr, room, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (begin == MAP_FAILED) refuse_to_keep(of, errno);
    place.begin = static_cast<char*>(begin);
  }
  place.file = open_unnamed_file(of);
  keeper_ = std::jthread([](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      keep_small();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
}

DiskMemory::~DiskMemory() {
  ::close(place.file.exchange(-1));
}

void* DiskMemory::take(std::size_t size) {
  const int file = place.file;
  if (file < 0 || size < smallest || size > room) return nullptr;
  const std::size_t length = (size + page - 1) / page * page + page;
  const std::size_t offset = place.used.fetch_add(length);
  if (offset + length > room) throw NoRoomOnDisk(EFBIG);
  if (const int error =
          ::posix_fallocate(file, static_cast<off_t>(offset), static_cast<off_t>(length));
      error != 0)
    throw NoRoomOnDisk(error);
  char* const first = place.begin + offset;
  if (::mmap(first, length, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file,
             static_cast<off_t>(offset)) == MAP_FAILED)
    throw NoRoomOnDisk(errno);
  length_at(first) = length;
  return first + page;
}

bool DiskMemory::give_back(void* array) noexcept {
  char* const begin = place.begin;
  auto* const at = static_cast<char*>(array);
  if (begin == nullptr || at < begin || at >= begin + room) return false;
  char* const first = at - page;
  const std::size_t length = length_at(first);
  if (const int file = place.file; file >= 0)
    ::fallocate(file, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, first - begin,
                static_cast<off_t>(length));
  ::mmap(first, length, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1, 0);
  return true;
}

/// A page that is given back loses nothing, whoever looks at it meanwhile: it is read again.
void DiskMemory::keep_small() noexcept {
  if (place.file >= 0 && resident() > most_resident)
    ::madvise(place.begin, place.used, MADV_DONTNEED);
}

}  // namespace impactrig::acquisition

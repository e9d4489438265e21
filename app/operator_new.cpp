// SPDX-License-Identifier: BSD-3-Clause
//
// The program's operator new and delete: those of the library, but for large arrays while there is
// an acquisition::DiskMemory.
#include <cstdlib>
#include <new>

#include "acquisition/disk_memory.hpp"

using impactrig::acquisition::DiskMemory;

void* operator new(std::size_t size) {
  if (void* const array = DiskMemory::take(size)) return array;
  while (true) {
    if (void* const array = std::malloc(size == 0 ? 1 : size)) return array;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* array) noexcept {
  if (!DiskMemory::give_back(array)) std::free(array);
}

void operator delete(void* array, std::size_t) noexcept {
  operator delete(array);
}

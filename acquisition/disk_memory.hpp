// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <string>
#include <thread>

namespace impactrig::acquisition {

/// While one lives, arrays of 128 kB and more may lie in a file without a name, in the folder that
/// open_unnamed_file() chooses. In the program impactrig all do that operator new makes
/// (app/operator_new.cpp): what needs a whole recording at hand, as conditioning does, computes in
/// little memory as it computes in much, and need not know. Pages come and go as a file's pages do;
/// those of all arrays together are given back once they are more than about 64 MB.
///
/// Arrays may outlive it. One at a time.
class DiskMemory {
 public:
  /// `of` is the file that errors name. Throws datasets::FileError when no such file can be made.
  explicit DiskMemory(const std::string& of);
  ~DiskMemory();
  DiskMemory(const DiskMemory&) = delete;
  DiskMemory& operator=(const DiskMemory&) = delete;

  /// An array in the file; null where there is no DiskMemory, or the array is small. Throws
  /// NoRoomOnDisk.
  static void* take(std::size_t size);

  /// False for what is not an array of take().
  static bool give_back(void* array) noexcept;

  /// Gives pages back if they are too many. A thread of its own does this each millisecond, in
  /// which arrays that are gone through take 5 MB; who looks at a few numbers all over a long
  /// array, each of which takes 64 kB, has to do it from time to time.
  static void keep_small() noexcept;

 private:
  std::jthread keeper_;
};

/// Thrown when the disk has no room for an array.
class NoRoomOnDisk : public std::bad_alloc {
 public:
  explicit NoRoomOnDisk(int error) : error_(error) {}

  int error() const { return error_; }  ///< as errno

 private:
  int error_;
};

}  // namespace impactrig::acquisition

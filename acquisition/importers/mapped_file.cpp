// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mapped_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace impactrig::acquisition {

using datasets::FileError;

// O_NONBLOCK: a pipe that nobody writes to would have the opening wait for ever
MappedFile::MappedFile(std::string path)
    : path_(std::move(path)),
      file_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  const char* const hint =
      path_ == "-" ? " (standard input is not read: save the recording to a file)" : "";
  if (file_ < 0)
    throw FileError(path_, fmt::format("cannot be opened: {}{}", std::strerror(errno), hint));
  map_or_close();
}

MappedFile::MappedFile(std::string path, int file) : path_(std::move(path)), file_(file) {
  map_or_close();
}

void MappedFile::map_or_close() {
  try {
    map();
  } catch (...) {
    ::close(file_);
    throw;
  }
}

void MappedFile::map() {
  struct stat status {};

  if (::fstat(file_, &status) != 0)
    throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
  if (S_ISDIR(status.st_mode)) throw FileError(path_, "is a directory, a recording is expected");
  if (!S_ISREG(status.st_mode))
    throw FileError(path_, "is not a file on a disk; save the recording to one");
  if (status.st_size == 0) return;
  const auto size = static_cast<std::size_t>(status.st_size);
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file_, 0);
  if (memory == MAP_FAILED)
    throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
  ::madvise(memory, size, MADV_SEQUENTIAL);
  bytes_ = static_cast<const char*>(memory);
  size_ = size;
}

MappedFile::MappedFile(std::string path, std::string unpacked)
    : path_(std::move(path)),
      unpacked_(std::move(unpacked)),
      bytes_(unpacked_.data()),
      size_(unpacked_.size()) {}

MappedFile::MappedFile(std::string path, std::string_view shown, std::unique_ptr<ByteSource> source)
    : path_(std::move(path)),
      source_(std::move(source)),
      bytes_(shown.data()),
      size_(shown.size()) {}

MappedFile::~MappedFile() {
  if (size_ > 0 && unpacked_.empty() && !source_) ::munmap(const_cast<char*>(bytes_), size_);
  if (file_ >= 0) ::close(file_);
}

void MappedFile::copy(std::size_t offset, std::size_t count, void* to) const {
  if (source_) return source_->copy(offset, count, to);
  if (file_ < 0) {
    std::memcpy(to, bytes_ + offset, count);
    return;
  }
  auto* at = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = ::pread(file_, at, count, static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
    if (got == 0) throw FileError(path_, "has become shorter while it was read");
    at += got;
    offset += static_cast<std::size_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

/// Beyond it the file has no blocks on the disk, as far as the file system tells.
std::size_t MappedFile::end_of_data() const {
  off_t end = 0;
  while (file_ >= 0 && end < static_cast<off_t>(size_)) {
    const off_t data = ::lseek(file_, end, SEEK_DATA);
    if (data < 0) return errno == ENXIO ? static_cast<std::size_t>(end) : size_;
    end = ::lseek(file_, data, SEEK_HOLE);
    if (end < 0) return size_;
  }
  return size_;
}

std::size_t MappedFile::zeros_at_end() const {
  std::string block(std::min(size_, std::size_t{1} << 20), '\0');
  const std::string zeros(block.size(), '\0');
  for (std::size_t end = end_of_data(); end > 0;) {
    const std::size_t count = std::min(end, block.size());
    copy(end - count, count, block.data());
    end -= count;
    if (std::memcmp(block.data(), zeros.data(), count) == 0) continue;
    return size_ - end - block.find_last_not_of('\0', count - 1) - 1;
  }
  return size_;
}

void MappedFile::release(std::size_t first, std::size_t last) const {
  if (!unpacked_.empty() || source_) return;  // it could not be read again
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  first = (first + page - 1) / page * page;
  last = last >= size_ ? size_ : last / page * page;
  if (first >= last) return;
  ::madvise(const_cast<char*>(bytes_) + first, last - first, MADV_DONTNEED);
}

datasets::SourcePosition MappedFile::byte_position(std::size_t offset) const {
  datasets::SourcePosition place;
  place.file = path_;
  place.byte = offset;
  return place;
}

}  // namespace impactrig::acquisition

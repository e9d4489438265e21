// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/spool.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

namespace {

std::vector<std::string> folders() {
  const char* const stated = std::getenv("TMPDIR");
  if (stated != nullptr && *stated != '\0') return {stated};
  return {"/var/tmp", "/tmp"};
}

}  // namespace

void refuse_to_keep(const std::string& of, int error) {
  throw datasets::FileError(
      of, fmt::format("is too large for memory and cannot be kept in a temporary file in {} "
                      "(TMPDIR states another folder): {}",
                      fmt::join(folders(), " or "), std::strerror(error)));
}

int open_unnamed_file(const std::string& of) {
  for (const std::string& folder : folders()) {
    std::string name = folder + "/impactrig-XXXXXX";
    const int file = ::mkostemp(name.data(), O_CLOEXEC);
    if (file < 0) continue;
    ::unlink(name.c_str());
    return file;
  }
  refuse_to_keep(of, errno);
}

Spool::Spool(std::string of) : of_(std::move(of)), file_(open_unnamed_file(of_)) {}

Spool::~Spool() {
  ::close(file_);
}

void Spool::fail_to_read() const {
  throw datasets::FileError(of_,
                            fmt::format("is too large for memory and cannot be read back from its "
                                        "temporary file: {}",
                                        std::strerror(errno)));
}

std::uint64_t Spool::append(std::string_view bytes) {
  const std::uint64_t place = size_;
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(size_));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) refuse_to_keep(of_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
    size_ += static_cast<std::uint64_t>(written);
  }
  return place;
}

void Spool::read(std::uint64_t place, std::size_t count, void* to) const {
  auto* at = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = ::pread(file_, at, count, static_cast<off_t>(place));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail_to_read();
    at += got;
    place += static_cast<std::uint64_t>(got);
    count -= static_cast<std::size_t>(got);
  }
}

std::unique_ptr<MappedFile> Spool::map() const {
  const int file = ::fcntl(file_, F_DUPFD_CLOEXEC, 0);
  if (file < 0) fail_to_read();
  return std::make_unique<MappedFile>(of_, file);
}

}  // namespace impactrig::acquisition

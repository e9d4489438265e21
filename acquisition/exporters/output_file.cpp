// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/exporters/output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

OutputFile::OutputFile(std::string path)
    : path_(std::move(path)),
      part_(path_ + ".part"),
      file_(std::fopen(part_.c_str(), "wb")) {
  if (file_ == nullptr) fail();
}

OutputFile::~OutputFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(part_.c_str());
}

void OutputFile::fail() {
  throw datasets::FileError(path_, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void OutputFile::write(std::string_view bytes) {
  flush();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
}

void OutputFile::flush() {
  const std::size_t size = buffer_.size();
  if (size > 0 && std::fwrite(buffer_.data(), 1, size, file_) != size) fail();
  buffer_.clear();
}

void OutputFile::finish() {
  flush();
  if (std::fflush(file_) != 0 || ::fsync(::fileno(file_)) != 0) fail();
  std::FILE* const file = file_;
  file_ = nullptr;
  if (std::fclose(file) != 0 || std::rename(part_.c_str(), path_.c_str()) != 0) {
    const int error = errno;
    std::remove(part_.c_str());
    errno = error;
    fail();
  }
}

}  // namespace impactrig::acquisition

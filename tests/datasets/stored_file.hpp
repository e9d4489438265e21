// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "datasets/input_error.hpp"
#include "datasets/store.hpp"

// Files of recordings, as the tests of the store write them and ask for errors.
namespace tests {

using impactrig::datasets::FileError;
using impactrig::datasets::InputError;
using impactrig::datasets::RawSamples;
using impactrig::datasets::Record;

/// A path of this process's own (tests run side by side), gone after the test.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(testing::TempDir() + "store_" + std::to_string(getpid()) + "_" + name) {
    remove();
  }

  ~TemporaryFile() { remove(); }

  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  void remove() const {
    std::filesystem::remove_all(path_);
    std::filesystem::remove(path_ + ".part");
  }

  std::string path_;
};

inline std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write_bytes(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

inline Record written_and_read(const Record& record, const std::string& name) {
  const TemporaryFile file(name);
  impactrig::datasets::write_record(record, file.path());
  EXPECT_FALSE(std::filesystem::exists(file.path() + ".part"));
  return impactrig::datasets::read_record(file.path());
}

inline Record record_of(RawSamples raw) {
  Record record;
  record.channels.resize(1);
  record.channels[0].name = "a";
  record.channels[0].raw = std::move(raw);
  return record;
}

/// The message without the file's name; every error must name it.
inline std::string read_error(const std::string& path) {
  try {
    impactrig::datasets::read_record(path);
  } catch (const InputError& error) {
    EXPECT_EQ(error.where().file, path);
    EXPECT_EQ(std::string(error.what()), path + ": " + error.problem());
    return error.problem();
  } catch (const FileError& error) {
    return std::string("FileError: ") + error.what();
  }
  return "read";
}

}  // namespace tests

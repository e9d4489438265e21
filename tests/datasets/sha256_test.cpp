// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "datasets/input_error.hpp"
#include "datasets/record.hpp"

namespace {

using namespace impactrig::datasets;

// FIPS 180-4 example values,
// https://csrc.nist.gov/projects/cryptographic-standards-and-guidelines/example-values
constexpr const char* of_abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
constexpr const char* of_two_blocks =
    "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1";
constexpr const char* of_nothing =
    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
constexpr const char* of_million_a =
    "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0";

TEST(Sha256, GivesThePublishedDigests) {
  EXPECT_EQ(sha256_of("abc"), of_abc);
  EXPECT_EQ(sha256_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"), of_two_blocks);
  EXPECT_EQ(sha256_of(""), of_nothing);
}

TEST(Sha256, ReadsAFileInPieces) {
  const std::string path = testing::TempDir() + "sha256_million_a" + std::to_string(getpid());
  std::ofstream(path) << std::string(1000000, 'a');
  EXPECT_EQ(sha256_of_file(path), of_million_a);
  for (const std::size_t size : {1U << 17, 9U << 17, 123U}) {  // the last piece is full, or not
    std::ofstream(path, std::ios::trunc) << std::string(size, 'a');
    EXPECT_EQ(sha256_of_file(path), sha256_of(std::string(size, 'a'))) << size;
  }
  std::filesystem::remove(path);
}

std::string message_of(const std::string& path) {
  try {
    sha256_of_file(path);
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Sha256, SaysWhyAFileCannotBeRead) {
  const std::string absent = testing::TempDir() + "absent.csv";
  EXPECT_EQ(message_of(absent), absent + ": cannot be opened: No such file or directory");
  EXPECT_EQ(message_of(testing::TempDir()),
            testing::TempDir() + ": cannot be read: Is a directory");
}

}  // namespace

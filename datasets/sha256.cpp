// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "datasets/input_error.hpp"
#include "datasets/record.hpp"

namespace impactrig::datasets {

namespace {

/// SHA-256 of bytes that come in pieces.
class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new()) {
    check(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }

  void add(std::string_view bytes) {
    check(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
  }

  std::string hex() {
    std::array<unsigned char, 32> digest{};
    check(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) == 1);
    std::string result;
    for (const unsigned char byte : digest) result += fmt::format("{:02x}", byte);
    return result;
  }

 private:
  /// Fails only where OpenSSL has no memory, or was built or configured without SHA-256.
  static void check(bool done) {
    if (!done) throw std::runtime_error("OpenSSL cannot compute a SHA-256");
  }

  struct Free {
    void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
  };

  std::unique_ptr<EVP_MD_CTX, Free> context_;
};

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

std::string last_error() {
  return std::generic_category().message(errno);
}

}  // namespace

std::string sha256_of_file(const std::string& path) {
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw FileError(path, "cannot be opened: " + last_error());

  Sha256 hash;
  std::vector<char> block(std::size_t{1} << 16);
  while (true) {
    const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
    hash.add({block.data(), count});
    if (count == block.size()) continue;
    if (std::ferror(file.get()) != 0) throw FileError(path, "cannot be read: " + last_error());
    return hash.hex();
  }
}

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hex();
}

}  // namespace impactrig::datasets

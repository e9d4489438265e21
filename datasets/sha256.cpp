// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <semaphore>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
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

std::string last_error() {
  return std::generic_category().message(errno);
}

/// A file's bytes from its beginning to its end, which a thread of its own reads ahead: hashing
/// takes 0.6 ns a byte, reading from the page cache 0.15.
class ReadAhead {
 public:
  /// Throws FileError.
  explicit ReadAhead(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rb")) {
    if (!file_) throw FileError(path, "cannot be opened: " + last_error());
    std::setvbuf(file_.get(), nullptr, _IONBF, 0);
    thread_ = std::jthread([this](const std::stop_token& stop) { read(stop); });
  }

  ~ReadAhead() {
    thread_.request_stop();
    empty_.release();
  }

  ReadAhead(const ReadAhead&) = delete;
  ReadAhead& operator=(const ReadAhead&) = delete;

  /// Hands all to `use`, piece by piece. Throws FileError.
  template <typename Use>
  void each(const Use& use) {
    for (std::size_t i = 0;; i = (i + 1) % pieces_.size()) {
      full_.acquire();
      const Piece& piece = pieces_[i];
      if (!piece.error.empty()) throw FileError(path_, "cannot be read: " + piece.error);
      use(std::string_view(piece.bytes.data(), piece.count));
      if (piece.count < piece.bytes.size()) return;
      empty_.release();
    }
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  /// A short one is the last.
  struct Piece {
    std::vector<char> bytes = std::vector<char>(std::size_t{1} << 17);
    std::size_t count = 0;
    std::string error;
  };

  void read(const std::stop_token& stop) {
    for (std::size_t i = 0;; i = (i + 1) % pieces_.size()) {
      empty_.acquire();
      if (stop.stop_requested()) return;
      Piece& piece = pieces_[i];
      piece.count = std::fread(piece.bytes.data(), 1, piece.bytes.size(), file_.get());
      if (std::ferror(file_.get()) != 0) piece.error = last_error();
      const bool last = piece.count < piece.bytes.size();
      full_.release();
      if (last) return;
    }
  }

  const std::string& path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::array<Piece, 4> pieces_;
  std::counting_semaphore<> empty_{4};
  std::counting_semaphore<> full_{0};
  std::jthread thread_;
};

}  // namespace

std::string sha256_of_file(const std::string& path) {
  return sha256_of_files(std::span(&path, 1));
}

std::string sha256_of_files(std::span<const std::string> paths) {
  Sha256 hash;
  for (const std::string& path : paths) {
    ReadAhead file(path);
    file.each([&](std::string_view bytes) { hash.add(bytes); });
  }
  return hash.hex();
}

std::string sha256_of(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes);
  return hash.hex();
}

}  // namespace impactrig::datasets

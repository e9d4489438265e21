// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

/// Reads a binary header field by field; a field that lies beyond the end of the file is an
/// InputError that names it.
class ByteCursor {
 public:
  explicit ByteCursor(const MappedFile& file, bool big_endian = false, std::uint64_t at = 0)
      : file_(&file),
        at_(at),
        big_endian_(big_endian) {}

  std::uint64_t at() const { return at_; }

  std::uint64_t left() const {
    const std::uint64_t size = file_->bytes().size();
    return at_ < size ? size - at_ : 0;
  }

  bool big_endian() const { return big_endian_; }

  void set_big_endian(bool big_endian) { big_endian_ = big_endian; }

  /// To a byte counted from the start of the file; reading beyond the end is an error, being there
  /// is not.
  void seek(std::uint64_t at) { at_ = at; }

  void skip(std::uint64_t count) {
    at_ = count > ~std::uint64_t{0} - at_ ? ~std::uint64_t{0} : at_ + count;
  }

  /// The next bytes; `what` names them in an error: "the length of a channel's name".
  std::string_view bytes(std::uint64_t count, std::string_view what) {
    if (left() < count || at_ > file_->bytes().size())
      throw datasets::InputError(position(), fmt::format("the file ends within {}", what));
    const std::string_view found = file_->bytes().substr(at_, count);
    at_ += count;
    return found;
  }

  template <typename Number>
  Number read(std::string_view what) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), bytes(sizeof(Number), what).data(), sizeof(Number));
    if (big_endian_ != (std::endian::native == std::endian::big))
      std::reverse(raw.begin(), raw.end());
    return std::bit_cast<Number>(raw);
  }

  datasets::SourcePosition position() const {
    return file_->byte_position(std::min<std::uint64_t>(at_, file_->bytes().size()));
  }

 private:
  const MappedFile* file_;
  std::uint64_t at_;
  bool big_endian_;
};

}  // namespace impactrig::acquisition

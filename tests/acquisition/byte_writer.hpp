// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace impactrig::acquisition::tests {

/// What a number is written as.
enum class NumberForm { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

/// Bytes of a made-up file, written number by number in one byte order; gaps are zero.
class ByteWriter {
 public:
  explicit ByteWriter(bool big_endian = false) : big_endian_(big_endian) {}

  /// A number at the end.
  template <typename Number>
  ByteWriter& add(Number value) {
    return put(bytes_.size(), value);
  }

  /// A number at the end, in this form.
  ByteWriter& add(NumberForm form, double value) {
    switch (form) {
      case NumberForm::i8:
        return add(static_cast<std::int8_t>(value));
      case NumberForm::u8:
        return add(static_cast<std::uint8_t>(static_cast<std::int64_t>(value)));
      case NumberForm::i16:
        return add(static_cast<std::int16_t>(value));
      case NumberForm::u16:
        return add(static_cast<std::uint16_t>(value));
      case NumberForm::i32:
        return add(static_cast<std::int32_t>(value));
      case NumberForm::u32:
        return add(static_cast<std::uint32_t>(value));
      case NumberForm::i64:
        return add(static_cast<std::int64_t>(value));
      case NumberForm::u64:
        return add(static_cast<std::uint64_t>(value));
      case NumberForm::f32:
        return add(static_cast<float>(value));
      case NumberForm::f64:
        return add(value);
    }
    return *this;
  }

  /// A number at a place.
  template <typename Number>
  ByteWriter& put(std::size_t offset, Number value) {
    std::string raw(sizeof value, '\0');
    std::memcpy(raw.data(), &value, sizeof value);
    if (big_endian_ != (std::endian::native == std::endian::big))
      std::reverse(raw.begin(), raw.end());
    return text(offset, raw);
  }

  ByteWriter& text(std::size_t offset, std::string_view text) {
    if (bytes_.size() < offset + text.size()) bytes_.resize(offset + text.size(), '\0');
    bytes_.replace(offset, text.size(), text);
    return *this;
  }

  /// A text at the end, filled with zeros to `width`.
  ByteWriter& add_text(std::string_view text, std::size_t width = 0) {
    bytes_ += text;
    if (text.size() < width) bytes_.append(width - text.size(), '\0');
    return *this;
  }

  void resize(std::size_t size) { bytes_.resize(size, '\0'); }

  std::size_t size() const { return bytes_.size(); }

  const std::string& bytes() const { return bytes_; }

 private:
  bool big_endian_;
  std::string bytes_;
};

}  // namespace impactrig::acquisition::tests

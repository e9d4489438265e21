// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "acquisition/importers/stored_numbers.hpp"

namespace impactrig::acquisition {

namespace {

template <typename Number>
Number byte_swapped(Number value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<Number>(bytes);
}

/// Copies `count` numbers at a distance of `stride` bytes to doubles, floats or integers.
template <typename Stored, bool Swapped, typename Value>
void gather(const char* from, std::uint64_t count, std::uint64_t stride, Value* to) {
  if (stride == sizeof(Stored)) stride = sizeof(Stored);  // lets the compiler see the common case
  for (std::uint64_t i = 0; i < count; ++i, from += stride) {
    Stored number;
    std::memcpy(&number, from, sizeof(Stored));
    if constexpr (Swapped) number = byte_swapped(number);
    to[i] = static_cast<Value>(number);
  }
}

template <typename Stored, typename Value>
void gather(const char* from, std::uint64_t count, std::uint64_t stride, bool swapped, Value* to) {
  if (sizeof(Stored) > 1 && swapped)
    gather<Stored, true>(from, count, stride, to);
  else if (stride == sizeof(Stored))
    gather<Stored, false>(from, count, sizeof(Stored), to);
  else
    gather<Stored, false>(from, count, stride, to);
}

template <typename Value>
void gather_24(const char* from, std::uint64_t count, std::uint64_t stride, bool big_endian,
               Value* to) {
  for (std::uint64_t i = 0; i < count; ++i, from += stride) {
    const auto byte = [&](int k) {
      return static_cast<std::uint32_t>(static_cast<unsigned char>(from[big_endian ? 2 - k : k]));
    };
    const std::uint32_t bits = byte(0) << 8 | byte(1) << 16 | byte(2) << 24;
    to[i] = static_cast<Value>(static_cast<std::int32_t>(bits) >> 8);
  }
}

}  // namespace

template <typename Value>
void convert_numbers(NumberKind kind, bool big_endian, const char* from, std::uint64_t count,
                     std::uint64_t stride, Value* to) {
  const bool swapped = big_endian != (std::endian::native == std::endian::big);
  switch (kind) {
    case NumberKind::i8:
      return gather<std::int8_t>(from, count, stride, swapped, to);
    case NumberKind::u8:
      return gather<std::uint8_t>(from, count, stride, swapped, to);
    case NumberKind::i16:
      return gather<std::int16_t>(from, count, stride, swapped, to);
    case NumberKind::u16:
      return gather<std::uint16_t>(from, count, stride, swapped, to);
    case NumberKind::i24:
      return gather_24(from, count, stride, big_endian, to);
    case NumberKind::i32:
      return gather<std::int32_t>(from, count, stride, swapped, to);
    case NumberKind::u32:
      return gather<std::uint32_t>(from, count, stride, swapped, to);
    case NumberKind::i64:
      return gather<std::int64_t>(from, count, stride, swapped, to);
    case NumberKind::u64:
      return gather<std::uint64_t>(from, count, stride, swapped, to);
    case NumberKind::f32:
      return gather<float>(from, count, stride, swapped, to);
    case NumberKind::f64:
      return gather<double>(from, count, stride, swapped, to);
  }
}

template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t, double*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t, float*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t,
                              std::int16_t*);
template void convert_numbers(NumberKind, bool, const char*, std::uint64_t, std::uint64_t,
                              std::int32_t*);

}  // namespace impactrig::acquisition

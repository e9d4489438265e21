// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_types.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "acquisition/importers/hdf5_sender.hpp"

namespace impactrig::acquisition {

using datasets::Hdf5Handle;

std::optional<ArrayNumbers> hdf5_numbers_of(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_ENUM) {
    const Hdf5Handle integers(H5Tget_super(type), H5Tclose);
    return hdf5_numbers_of(integers.id());
  }
  if (kind == H5T_INTEGER) {
    const std::size_t bits = H5Tget_precision(type) + (H5Tget_sign(type) == H5T_SGN_NONE ? 1 : 0);
    return bits <= 16 ? ArrayNumbers::i16 : bits <= 32 ? ArrayNumbers::i32 : ArrayNumbers::f64;
  }
  if (kind == H5T_BITFIELD) {
    const std::size_t bits = H5Tget_precision(type);
    if (bits > 31) return std::nullopt;
    return bits <= 15 ? ArrayNumbers::i16 : ArrayNumbers::i32;
  }
  if (kind != H5T_FLOAT) return std::nullopt;
  std::size_t sign = 0, exponent_at = 0, exponent = 0, mantissa_at = 0, mantissa = 0;
  if (H5Tget_fields(type, &sign, &exponent_at, &exponent, &mantissa_at, &mantissa) < 0)
    return std::nullopt;
  return exponent <= 8 && mantissa <= 23 ? ArrayNumbers::f32 : ArrayNumbers::f64;
}

bool hdf5_is_wide(hid_t type) {
  return H5Tget_class(type) == H5T_INTEGER && H5Tget_precision(type) > 53;
}

hid_t hdf5_memory_type(ArrayNumbers numbers) {
  switch (numbers) {
    case ArrayNumbers::i16:
      return H5T_NATIVE_INT16;
    case ArrayNumbers::i32:
      return H5T_NATIVE_INT32;
    case ArrayNumbers::f32:
      return H5T_NATIVE_FLOAT;
    default:
      return H5T_NATIVE_DOUBLE;
  }
}

hid_t hdf5_bits_of(ArrayNumbers numbers) {
  return numbers == ArrayNumbers::i16 ? H5T_NATIVE_B16 : H5T_NATIVE_B32;
}

std::size_t width_of(ArrayNumbers numbers) {
  return numbers == ArrayNumbers::i16 ? 2 : numbers == ArrayNumbers::f64 ? 8 : 4;
}

bool hdf5_is_complex(hid_t type) {
  if (H5Tget_nmembers(type) != 2) return false;
  constexpr std::array<std::array<std::string_view, 2>, 2> names = {{{"real", "imag"}, {"r", "i"}}};
  for (const auto& pair : names) {
    bool matches = true;
    for (unsigned i = 0; i < 2; ++i) {
      char* const name = H5Tget_member_name(type, i);
      const Hdf5Handle member(H5Tget_member_type(type, i), H5Tclose);
      matches = matches && name != nullptr && name == pair[i] && hdf5_numbers_of(member.id()) &&
                H5Tget_class(member.id()) != H5T_BITFIELD;
      H5free_memory(name);
    }
    if (matches) return true;
  }
  return false;
}

std::uint64_t hdf5_list_length(hid_t type) {
  hsize_t length = 0;
  if (H5Tget_class(type) != H5T_ARRAY || H5Tget_array_ndims(type) != 1) return 0;
  return H5Tget_array_dims2(type, &length) == 1 ? length : 0;
}

std::size_t hdf5_count_fields(hid_t type, int depth) {
  const int members = H5Tget_nmembers(type);
  std::size_t count = static_cast<std::size_t>(std::max(members, 0));
  if (depth > hdf5_deepest) return hdf5_longest_list + 1;
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(members, 0)); ++i) {
    if (count > hdf5_longest_list) break;
    const Hdf5Handle member(H5Tget_member_type(type, i), H5Tclose);
    if (H5Tget_class(member.id()) == H5T_COMPOUND)
      count += hdf5_count_fields(member.id(), depth + 1);
    else
      count += static_cast<std::size_t>(
          std::min<std::uint64_t>(hdf5_list_length(member.id()), hdf5_longest_list + 1));
  }
  return count;
}

Hdf5Handle hdf5_field_type(const std::vector<std::string>& names, hid_t number) {
  Hdf5Handle type(H5Tcopy(number), H5Tclose);
  for (std::size_t i = names.size(); i-- > 0;) {
    Hdf5Handle around(H5Tcreate(H5T_COMPOUND, H5Tget_size(number)), H5Tclose);
    H5Tinsert(around.id(), names[i].c_str(), 0, type.id());
    type = std::move(around);
  }
  return type;
}

std::string_view hdf5_kind_name(H5T_class_t kind) {
  switch (kind) {
    case H5T_STRING:
      return "text";
    case H5T_ARRAY:
      return "a list";
    case H5T_REFERENCE:
      return "references";
    case H5T_VLEN:
      return "lists of different length";
    default:
      return "of no standard type of numbers";
  }
}

}  // namespace impactrig::acquisition

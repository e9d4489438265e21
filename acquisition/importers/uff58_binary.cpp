// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_binary.hpp"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

#include "acquisition/importers/uff58_bytes.hpp"

namespace impactrig::acquisition {

namespace {

template <typename Number>
std::vector<Number> read_numbers(const TextFile& file, const char* bytes, std::size_t n,
                                 bool little_endian) {
  std::vector<Number> values(n);
  file.copy(bytes, n * sizeof(Number), values.data());
  if (little_endian == (std::endian::native == std::endian::little)) return values;
  for (Number& value : values)
    value = read_uff58_number<Number>(reinterpret_cast<const char*>(&value), little_endian);
  return values;
}

}  // namespace

std::uint64_t Uff58Binary::skip(std::uint64_t points) {
  at_ += points * point_bytes();
  return points;
}

Uff58Block Uff58Binary::read(std::size_t most, std::uint64_t& left) {
  const auto points = static_cast<std::size_t>(std::min<std::uint64_t>(most, left));
  left -= points;
  Uff58Block block;
  if (!form_.even || form_.complex())
    divide(points, block);
  else if (extent_.number_bytes == 8)
    block.ordinate = read_numbers<double>(file_, at_, points, form_.little_endian);
  else
    block.ordinate = read_numbers<float>(file_, at_, points, form_.little_endian);
  at_ += points * point_bytes();
  return block;
}

std::size_t Uff58Binary::point_bytes() const {
  return extent_.abscissa_bytes + extent_.number_bytes * (form_.complex() ? 2U : 1U);
}

double Uff58Binary::number(const char* p, std::size_t size) const {
  return size == 8 ? read_uff58_number<double>(p, form_.little_endian)
                   : static_cast<double>(read_uff58_number<float>(p, form_.little_endian));
}

void Uff58Binary::divide(std::size_t points, Uff58Block& block) const {
  std::vector<double> ordinate(points);
  if (!form_.even) block.abscissa.resize(points);
  if (form_.complex()) block.imaginary.resize(points);
  for (std::size_t i = 0; i < points; ++i) {
    const char* p = at_ + i * point_bytes();
    if (!form_.even) block.abscissa[i] = number(p, extent_.abscissa_bytes);
    p += extent_.abscissa_bytes;
    ordinate[i] = number(p, extent_.number_bytes);
    if (form_.complex())
      block.imaginary[i] = number(p + extent_.number_bytes, extent_.number_bytes);
  }
  block.ordinate = std::move(ordinate);
}

}  // namespace impactrig::acquisition

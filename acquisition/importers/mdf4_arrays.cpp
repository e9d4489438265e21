// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_arrays.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/importers/byte_cursor.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::uint64_t most_elements = 1000;  ///< each of them is a channel

// Flags of an array.
constexpr std::uint32_t size_changes = 0x01;
constexpr std::uint32_t first_index_fastest = 0x40;

/// Adds the dimensions of one block; `array` has a problem where they cannot be told.
void add_dimensions(const MdfBlocks& blocks, const MdfBlock& block, MdfArray& array) {
  ByteCursor in(blocks.file(), false, block.data);
  in.skip(1);
  const auto storage = in.read<std::uint8_t>("an array");
  const auto count = in.read<std::uint16_t>("an array");
  const auto flags = in.read<std::uint32_t>("an array");
  std::int64_t bytes = in.read<std::int32_t>("an array");
  std::int64_t bits = in.read<std::uint32_t>("an array");
  if (storage != 0) array.problem = "the elements of its array lie in other groups";
  if ((flags & size_changes) != 0)
    array.problem = "its array has another size from record to record";
  std::vector<MdfArray::Dimension> found;
  for (std::uint16_t i = 0; i < count; ++i) {
    const auto size = in.read<std::uint64_t>("an array");
    if (size == 0 || size > most_elements || array.elements * size > most_elements)
      array.problem = fmt::format("its array has no elements, or more than {}", most_elements);
    if (!array.problem.empty()) return;
    array.elements *= size;
    found.push_back({size, 0, 0});
  }
  if ((flags & first_index_fastest) == 0) std::ranges::reverse(found);
  for (MdfArray::Dimension& dimension : found) {  // products below 2^31 times most_elements
    dimension.bytes = bytes;
    dimension.bits = bits;
    bytes *= static_cast<std::int64_t>(dimension.size);
    bits *= static_cast<std::int64_t>(dimension.size);
  }
  if ((flags & first_index_fastest) == 0) std::ranges::reverse(found);
  array.dimensions.insert(array.dimensions.end(), found.begin(), found.end());
}

}  // namespace

MdfArray::Element MdfArray::element(std::uint64_t i) const {
  Element found;
  for (std::size_t d = dimensions.size(); d-- > 0;) {
    const std::uint64_t index = i % dimensions[d].size;
    i /= dimensions[d].size;
    found.indices = fmt::format("[{}]{}", index, found.indices);
    found.bytes += static_cast<std::int64_t>(index) * dimensions[d].bytes;
    found.bits += static_cast<std::int64_t>(index) * dimensions[d].bits;
  }
  return found;
}

MdfArray mdf_array(MdfBlocks& blocks, std::uint64_t at) {
  constexpr std::string_view what = "the composition of a channel";
  MdfArray array;
  while (at != 0 && array.problem.empty()) {
    const std::string id = blocks.block_at(at, what, 0).id;
    if (id == "CN") {
      array.members = at;
      break;
    }
    if (id != "CA")
      blocks.fail(at, fmt::format("expected an array (CA) or channels (CN), found a block {}", id));
    const MdfBlock block = blocks.new_block_at(at, "CA", what);
    add_dimensions(blocks, block, array);
    at = block.link(0);
  }
  return array;
}

}  // namespace impactrig::acquisition

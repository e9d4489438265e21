// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

constexpr std::uint64_t mdf_block_head = 24;  ///< id, length, number of links [bytes]

/// A block: its links, and a cursor at its data.
struct MdfBlock {
  std::uint64_t at;
  std::string id;  ///< "HD"
  std::vector<std::uint64_t> links;
  std::uint64_t data;  ///< [byte in the file]
  std::uint64_t end;

  std::uint64_t link(std::size_t i) const { return i < links.size() ? links[i] : 0; }
};

/// The blocks of an MDF 4 file, which refer to each other by their place. All of it throws
/// datasets::InputError for what is no such block.
class MdfBlocks {
 public:
  explicit MdfBlocks(const MappedFile& file) : file_(&file), size_(file.bytes().size()) {}

  const MappedFile& file() const { return *file_; }

  std::uint64_t size() const { return size_; }  ///< of the file [bytes]

  [[noreturn]] void fail(std::uint64_t at, std::string_view problem) const;

  /// A block with its first links, `most` of them.
  MdfBlock block_at(std::uint64_t at, std::string_view what,
                    std::uint64_t most = ~std::uint64_t{0}) const;

  /// A block that is part of a chain, which must not come back to it. `id` may be empty: any.
  MdfBlock new_block_at(std::uint64_t at, std::string_view id, std::string_view what);

  /// The text of a block TX, or what stands between <TX> and </TX> in the XML of a block MD; "" for
  /// the place 0.
  std::string text_at(std::uint64_t at);

 private:
  std::string read_text(std::uint64_t at) const;

  const MappedFile* file_;
  std::uint64_t size_;
  std::unordered_set<std::uint64_t> seen_;
  std::uint64_t text_bytes_ = 0;
};

/// Without the blanks around it.
std::string trimmed_mdf_text(std::string_view text);

}  // namespace impactrig::acquisition

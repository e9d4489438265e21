// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/mdf4_blocks.hpp"

namespace impactrig::acquisition {

/// A part of a group's data: bytes of the file, or what they expand to.
struct MdfFragment {
  std::uint64_t begin = 0;   ///< within the group's data
  std::uint64_t length = 0;  ///< there
  std::uint64_t at = 0;      ///< in the file
  std::uint64_t stored = 0;  ///< bytes in the file
  bool deflated = false;
  std::uint32_t columns = 0;  ///< > 0: transposed, rows of this length
};

/// The data of a group, and a sentence for the user where the file ends within them; else "".
struct MdfData {
  std::vector<MdfFragment> fragments{};
  std::string warning{};
};

/// The parts of a group's data that the block at a place (DT, DZ, DL or HL; 0: none) stands for.
/// `last_length_unknown`: a block of no bytes goes on to the end of the file.
MdfData mdf_data(MdfBlocks& blocks, std::uint64_t at, bool last_length_unknown);

/// The bytes of a group's records, wherever they lie. Expands one compressed block at a time.
class MdfRecordBytes {
 public:
  MdfRecordBytes(const MappedFile& file, const std::vector<MdfFragment>& fragments)
      : file_(&file),
        fragments_(&fragments) {}

  /// `length` bytes from `begin` on; they live until the next call. Throws datasets::InputError for
  /// damaged ones.
  const char* view(std::uint64_t begin, std::uint64_t length);

  /// Bytes from `begin` on that lie together, one at least and 1 MB at most; as view().
  std::string_view piece(std::uint64_t begin);

  /// Gives back the pages of such bytes where they lie in the file.
  void release(const char* bytes, std::uint64_t length) const;

 private:
  std::size_t fragment_at(std::uint64_t begin) const;
  std::string_view bytes_of(std::size_t i);
  void untranspose(std::uint64_t columns);

  static constexpr std::size_t none = ~std::size_t{0};

  const MappedFile* file_;
  const std::vector<MdfFragment>* fragments_;
  std::size_t expanded_ = none;
  std::vector<char> expanded_bytes_;
  std::vector<char> rows_;
  std::vector<char> joined_;
};

}  // namespace impactrig::acquisition

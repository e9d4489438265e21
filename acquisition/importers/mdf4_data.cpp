// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_data.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/text_file.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

// So that memory stays bounded whatever a file says.
constexpr std::uint64_t most_expanded = std::uint64_t{1} << 26;  ///< bytes of a compressed block
constexpr std::uint64_t deflate_at_most = 1032;  ///< bytes out for one in, by the method's design

/// Gives back the memory that zlib holds.
class Inflater {
 public:
  Inflater() { ready_ = inflateInit(&stream_) == Z_OK; }

  ~Inflater() {
    if (ready_) inflateEnd(&stream_);
  }

  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// True when `from` is a whole stream that fills `to` exactly.
  bool expand(std::string_view from, std::span<char> to) {
    if (!ready_ || from.size() > std::numeric_limits<uInt>::max()) return false;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(from.data()));
    stream_.avail_in = static_cast<uInt>(from.size());
    stream_.next_out = reinterpret_cast<Bytef*>(to.data());
    stream_.avail_out = static_cast<uInt>(to.size());
    return inflate(&stream_, Z_FINISH) == Z_STREAM_END && stream_.avail_out == 0;
  }

 private:
  z_stream stream_{};
  bool ready_ = false;
};

/// Lists the parts of one group's data.
class DataList {
 public:
  DataList(MdfBlocks& blocks, bool last_length_unknown)
      : blocks_(blocks),
        last_length_unknown_(last_length_unknown) {}

  MdfData take() { return std::move(data_); }

  /// Appends the parts of a group's data that a block stands for.
  void collect(std::uint64_t at) {
    while (at != 0) {
      if (beyond_the_end(at)) return;
      const MdfBlock block = blocks_.new_block_at(at, "", "a block of data");
      if (block.id == "HL") {  // a head of the list, which follows
        at = block.link(0);
      } else if (block.id == "DL") {
        for (std::size_t i = 1; i < block.links.size(); ++i) {
          if (block.links[i] == 0) continue;
          if (beyond_the_end(block.links[i])) return;
          const MdfBlock part = blocks_.new_block_at(block.links[i], "", "a block of data");
          if (!append(part)) return;
        }
        at = block.link(0);
      } else {
        append(block);
        return;
      }
    }
  }

 private:
  bool beyond_the_end(std::uint64_t at) {
    if (blocks_.size() >= mdf_block_head && at <= blocks_.size() - mdf_block_head) return false;
    data_.warning = "the file ends before its data do";
    return true;
  }

  bool append(const MdfBlock& block) {
    std::vector<MdfFragment>& fragments = data_.fragments;
    MdfFragment fragment;
    if (!fragments.empty()) fragment.begin = fragments.back().begin + fragments.back().length;
    if (block.id == "DT") {
      const bool to_the_end = last_length_unknown_ && block.end == block.data;
      fragment.at = block.data;
      fragment.stored = fragment.length = (to_the_end ? blocks_.size() : block.end) - block.data;
    } else if (block.id == "DZ") {
      if (!describe_compressed(block, fragment)) return false;
    } else if (block.id == "DV" || block.id == "LD") {
      blocks_.fail(block.at,
                   "the data are stored by columns (MDF 4.2), which is not read: save the file as "
                   "MDF 4.1 with the program that wrote it");
    } else {
      blocks_.fail(
          block.at,
          fmt::format("expected a block of data (DT, DZ, DL, HL), found a block {}", block.id));
    }
    if (fragment.length > 0) fragments.push_back(fragment);
    return true;
  }

  /// False when the file ends within the block.
  bool describe_compressed(const MdfBlock& block, MdfFragment& fragment) {
    ByteCursor in(blocks_.file(), false, block.data);
    const std::string original = to_utf8(in.bytes(2, "a compressed block"));
    const auto method = in.read<std::uint8_t>("a compressed block");
    in.skip(1);
    const auto columns = in.read<std::uint32_t>("a compressed block");
    const auto length = in.read<std::uint64_t>("a compressed block");
    const auto stored = in.read<std::uint64_t>("a compressed block");
    if (original != "DT")
      blocks_.fail(
          block.at,
          fmt::format("expected compressed records (DT), found a compressed block {}", original));
    if (method > 1)
      blocks_.fail(block.at,
                   fmt::format("the data are compressed by method {}, which is not read: save the "
                               "file with deflate or uncompressed",
                               method));
    if (stored > in.left()) {
      data_.warning = "the file ends within a compressed block of data: it is left out";
      return false;
    }
    if (length > most_expanded || length > deflate_at_most * stored)
      blocks_.fail(block.at,
                   fmt::format("a compressed block of {} bytes announces {} bytes: it is refused",
                               stored, length));
    fragment.at = in.at();
    fragment.stored = stored;
    fragment.length = length;
    fragment.deflated = true;
    if (method == 1 && columns > 1 && columns <= length) fragment.columns = columns;
    return true;
  }

  MdfBlocks& blocks_;
  bool last_length_unknown_;
  MdfData data_;
};

}  // namespace

MdfData mdf_data(MdfBlocks& blocks, std::uint64_t at, bool last_length_unknown) {
  DataList list(blocks, last_length_unknown);
  list.collect(at);
  return list.take();
}

const char* MdfRecordBytes::view(std::uint64_t begin, std::uint64_t length) {
  std::size_t i = fragment_at(begin);
  const MdfFragment& first = (*fragments_)[i];
  if (begin + length <= first.begin + first.length)
    return bytes_of(i).data() + (begin - first.begin);
  joined_.resize(length);
  for (std::uint64_t done = 0; done < length; ++i) {
    const MdfFragment& fragment = (*fragments_)[i];
    const std::uint64_t skip = begin + done - fragment.begin;
    const std::uint64_t count = std::min(length - done, fragment.length - skip);
    std::memcpy(joined_.data() + done, bytes_of(i).data() + skip, count);
    done += count;
  }
  return joined_.data();
}

std::string_view MdfRecordBytes::piece(std::uint64_t begin) {
  const std::size_t i = fragment_at(begin);
  return bytes_of(i).substr(begin - (*fragments_)[i].begin, std::size_t{1} << 20);
}

void MdfRecordBytes::release(const char* bytes, std::uint64_t length) const {
  const std::string_view all = file_->bytes();
  if (std::less<>()(bytes, all.data()) || !std::less<>()(bytes, all.data() + all.size())) return;
  const auto first = static_cast<std::size_t>(bytes - all.data());
  file_->release(first, first + length);
}

std::size_t MdfRecordBytes::fragment_at(std::uint64_t begin) const {
  const auto after = std::ranges::upper_bound(*fragments_, begin, {}, &MdfFragment::begin);
  return static_cast<std::size_t>(after - fragments_->begin()) - 1;
}

std::string_view MdfRecordBytes::bytes_of(std::size_t i) {
  const MdfFragment& fragment = (*fragments_)[i];
  const std::string_view stored = file_->bytes().substr(fragment.at, fragment.stored);
  if (!fragment.deflated) return stored;
  if (expanded_ == i) return {expanded_bytes_.data(), expanded_bytes_.size()};
  expanded_ = none;
  expanded_bytes_.resize(fragment.length);
  if (!Inflater().expand(stored, expanded_bytes_))
    throw InputError(file_->byte_position(fragment.at),
                     fmt::format("the compressed data are damaged, or are not the {} bytes "
                                 "announced",
                                 fragment.length));
  if (fragment.columns > 0) untranspose(fragment.columns);
  file_->release(fragment.at, fragment.at + fragment.stored);
  expanded_ = i;
  return {expanded_bytes_.data(), expanded_bytes_.size()};
}

/// All first bytes of the rows, then all second ones, ...: back into rows. What is left after the
/// last whole row was not transposed.
void MdfRecordBytes::untranspose(std::uint64_t columns) {
  const std::uint64_t rows = expanded_bytes_.size() / columns;
  rows_.resize(rows * columns);
  for (std::uint64_t row = 0; row < rows; ++row)
    for (std::uint64_t column = 0; column < columns; ++column)
      rows_[row * columns + column] = expanded_bytes_[column * rows + row];
  std::ranges::copy(rows_, expanded_bytes_.begin());
}

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/mdf4_mixed.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace impactrig::acquisition {

std::optional<MdfMixedRecords::Seen> MdfMixedRecords::next(std::uint64_t end) {
  const std::uint64_t id_bytes = mixed_->id_bytes;
  while (at_ < std::min(end, total_)) {
    const std::uint64_t left = total_ - at_;
    if (left < id_bytes) break;
    const std::uint64_t id = number(0, id_bytes);
    const auto found = mixed_->kinds.find(id);
    if (found == mixed_->kinds.end()) {
      problem_ = fmt::format(
          "byte {} of the data of {} begins a record of the id {}, which no channel group has: "
          "what follows is left out",
          at_, mixed_->name, id);
      break;
    }
    const MdfMixed::Kind& kind = found->second;
    if (left < kind.bytes) break;
    if (kind.variable) {
      const std::uint64_t length = number(id_bytes, kind.bytes - id_bytes);
      if (length > left - kind.bytes) break;
      pass(kind.bytes + length);
      continue;
    }
    const Seen seen{kind.place, look(kind.bytes)};
    pass(kind.bytes);
    return seen;
  }
  if (at_ < end) at_ = total_;  // what is left is no whole record
  return std::nullopt;
}

/// The next bytes, which lie together.
const char* MdfMixedRecords::look(std::uint64_t count) {
  if (count <= piece_.size()) return piece_.data();
  bytes_.release(fetched_.data(), fetched_.size());
  fetched_ = piece_ = bytes_.piece(at_);
  if (count <= piece_.size()) return piece_.data();
  piece_ = {};
  fetched_ = {bytes_.view(at_, count), static_cast<std::size_t>(count)};
  return fetched_.data();
}

void MdfMixedRecords::pass(std::uint64_t count) {
  at_ += count;
  piece_.remove_prefix(static_cast<std::size_t>(std::min<std::uint64_t>(count, piece_.size())));
}

/// The bytes from `from` on behind the place where the cursor is, little-endian.
std::uint64_t MdfMixedRecords::number(std::uint64_t from, std::uint64_t count) {
  const char* const bytes = look(from + count) + from;
  std::uint64_t value = 0;
  for (std::uint64_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/uff58_data.hpp"

#include <algorithm>

#include "acquisition/importers/uff58_binary.hpp"
#include "acquisition/importers/uff58_text.hpp"

namespace impactrig::acquisition {

std::size_t Uff58Block::size() const {
  return std::visit([](const auto& samples) { return samples.size(); }, ordinate);
}

Uff58Reader::Uff58Reader(const TextFile& file, const Uff58Form& form, const Uff58Extent& extent,
                         bool lines_count)
    : left_(extent.points),
      even_lines_(!extent.counted) {
  if (form.binary)
    binary_ = std::make_unique<Uff58Binary>(file, form, extent);
  else
    text_ = std::make_unique<Uff58Text>(file, extent.start, form, lines_count);
}

Uff58Reader::~Uff58Reader() = default;

std::uint64_t Uff58Reader::skip(std::uint64_t points) {
  points = std::min(points, left_);
  if (text_ && !even_lines_) return 0;
  const std::uint64_t skipped = text_ ? text_->skip(points) : binary_->skip(points);
  left_ -= skipped;
  return skipped;
}

Uff58Block Uff58Reader::read(std::size_t most) {
  return text_ ? text_->read(most, left_) : binary_->read(most, left_);
}

const char* Uff58Reader::at() const {
  return text_ ? text_->at() : binary_->at();
}

std::vector<std::string> Uff58Reader::warnings() const {
  return text_ ? text_->warnings() : std::vector<std::string>{};
}

}  // namespace impactrig::acquisition

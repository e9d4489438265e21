// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <unordered_map>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/tdm_document.hpp"
#include "acquisition/importers/tdms_objects.hpp"

namespace impactrig::acquisition {

/// What the numbers of a channel are, before or instead of their samples.
struct TdmColumn {
  TdmsPart part{};
  std::optional<std::size_t> file{};  ///< that holds its samples; none: they are a ramp
  std::string problem{};              ///< why it cannot be read: "its type eX is not known"
  std::vector<std::string> warnings{};
};

/// Finds where and how the numbers of local columns lie.
class TdmColumns {
 public:
  /// Opens the files of samples beside the description at `path`. Throws datasets::InputError where
  /// one is not there.
  TdmColumns(const TdmDocument& document, const std::string& path);

  /// The numbers of the channel of that name, whose local column is `column`.
  TdmColumn column(pugi::xml_node column, const std::string& channel) const;

  std::vector<std::unique_ptr<MappedFile>>& files() { return files_; }

  /// Files that are not the ones the description names.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  /// Values in a file of samples.
  struct Block {
    std::size_t file = 0;
    bool big_endian = false;
    pugi::xml_node says{};
  };

  /// Where the values of a block are.
  struct Place {
    std::uint64_t offset = 0;
    std::uint64_t stride = 0;
    std::uint64_t count = 0;
  };

  void open(const TdmDocument& document, const std::string& path);
  const Block* block_of(pugi::xml_node element) const;
  Place place_of(const Block& block, std::uint64_t width) const;
  StoredNumbers numbers_of(const Block& block, NumberKind kind, std::uint64_t width) const;
  void set_stored(pugi::xml_node values, const std::string& channel, TdmColumn& made) const;
  void set_ramp(pugi::xml_node column, bool constant, const std::string& channel,
                TdmColumn& made) const;
  void set_marks(pugi::xml_node column, TdmColumn& made) const;
  std::vector<double> ramp_numbers(pugi::xml_node column) const;
  pugi::xml_node values_of(pugi::xml_node column) const;

  const TdmDocument& document_;
  std::vector<std::unique_ptr<MappedFile>> files_;
  std::unordered_map<std::string_view, Block> blocks_;  // ids lie in document_
  std::vector<std::string> warnings_;
};

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/importers/mapped_file.hpp"
#include "acquisition/importers/stored_numbers.hpp"
#include "acquisition/importers/tdms_objects.hpp"

namespace impactrig::acquisition {

/// Where the values of each channel lie in the raw data, segment by segment: a chunk after the
/// other, each with the values of the channels that the list of the segment has. All of it throws
/// datasets::InputError for what cannot be.
class TdmsChunks {
 public:
  /// `objects` may grow meanwhile.
  TdmsChunks(const MappedFile& file, std::vector<TdmsObject>& objects)
      : file_(file),
        objects_(objects) {}

  /// The list of a segment that does not go on with the one before; `at` is for errors.
  void start_list(std::uint64_t at);

  /// Puts an object on the list where it is not yet.
  void list(std::size_t which);

  /// What the objects say of their data has changed.
  void set_changed() { changed_ = true; }

  /// Notes where the raw data of a segment lie: `total` bytes from `data` on; `cut`: the file ends
  /// within them. Returns a sentence for the user where that needs one, else "".
  std::string place(bool big_endian, bool interleaved, std::uint64_t data, std::uint64_t total,
                    bool cut);

 private:
  /// The rows of a raw buffer in a chunk.
  struct Buffer {
    std::uint64_t rows = 0;
    std::uint64_t width = 0;
  };

  void spend(std::uint64_t steps, std::uint64_t at);
  /// Makes active_, chunk_bytes_ and buffers_ fit the list of objects.
  void arrange(std::uint64_t at);
  void add_to_buffers(const TdmsObject& object, std::uint64_t at);
  static std::string widths_text(const std::vector<std::uint32_t>& widths);
  static std::string widths_text(const std::vector<Buffer>& buffers);
  /// Texts of one channel alone lie together, whatever the segment says of the order.
  bool only_texts() const;
  /// Each channel's values of a chunk lie together.
  void place_blocks(std::uint64_t data, std::uint64_t chunks);
  /// A chunk that is not whole. In a file that was cut off the channels are there one after the
  /// other; else each has the same share of its values, as npTDMS found in files of its users.
  void place_part(std::uint64_t data, std::uint64_t rest, bool cut);
  /// One value of each channel, then the next of each.
  void place_rows(std::uint64_t data, std::uint64_t total);
  std::vector<Buffer> buffers_within(std::uint64_t rest) const;
  void place_buffers(std::uint64_t data, std::uint64_t chunks, const std::vector<Buffer>& buffers);
  TdmsSource& source_of(TdmsObject& object, std::uint32_t id, NumberKind kind, int bit,
                        std::uint64_t at);
  /// `count` values from `at` on, each `stride` bytes behind the other (0: side by side), `chunks`
  /// times.
  void add(TdmsObject& object, std::uint64_t at, std::uint64_t count, std::uint64_t chunks,
           std::uint64_t stride = 0);

  const MappedFile& file_;
  std::vector<TdmsObject>& objects_;
  std::uint64_t steps_ = 0;
  std::vector<std::size_t> list_;    // objects of the segment at hand, in the order of their data
  bool changed_ = true;              // since arrange():
  std::vector<std::size_t> active_;  // those of list_ that have data
  std::vector<Buffer> buffers_;
  std::uint64_t chunk_bytes_ = 0;
  bool daqmx_ = false;
  bool big_endian_ = false;
};

}  // namespace impactrig::acquisition

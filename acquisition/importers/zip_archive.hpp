// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zip.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "acquisition/importers/mapped_file.hpp"

namespace impactrig::acquisition {

/// A ZIP archive, read by libzip. Every function throws datasets::InputError where the archive is
/// damaged; `name` is what errors call an entry.
class ZipArchive {
 public:
  /// `file` must live as long.
  explicit ZipArchive(const MappedFile& file);

  std::uint64_t entries() const;

  /// As the archive has it.
  std::string_view name(std::uint64_t entry) const;

  std::optional<std::uint64_t> find(const char* name) const;

  /// Bytes of an entry unpacked, once they are possible: an entry that is encrypted, packed by
  /// anything but deflate, or that declares more than its packed bytes can make, is refused, and so
  /// are entries that have more packed bytes together than the archive.
  std::uint64_t size(std::uint64_t entry, std::string_view name);

  /// Reads one entry from its start.
  class Entry {
   public:
    /// The next bytes, all of them.
    void read(void* to, std::size_t count);

    /// Compares the check sum; all bytes have been read.
    void check_sum();

   private:
    friend ZipArchive;

    struct Close {
      void operator()(zip_file_t* entry) const { zip_fclose(entry); }
    };

    Entry(const ZipArchive& archive, std::uint64_t entry, std::string_view name);
    [[noreturn]] void cannot_read(std::string_view why) const;

    const ZipArchive& archive_;
    std::string name_;
    std::unique_ptr<zip_file_t, Close> entry_;
  };

  Entry open(std::uint64_t entry, std::string_view name) const { return {*this, entry, name}; }

  [[noreturn]] void refuse(std::string_view problem) const;

 private:
  struct Discard {
    void operator()(zip_t* archive) const { zip_discard(archive); }
  };

  const MappedFile& file_;
  std::unique_ptr<zip_t, Discard> archive_;
  std::uint64_t packed_ = 0;  ///< bytes of the entries looked at
};

}  // namespace impactrig::acquisition

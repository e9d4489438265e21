// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/zip_archive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "acquisition/importers/text_encoding.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

namespace {

/// Deflate makes at most 258 bytes of 2 bits.
constexpr std::uint64_t largest_expansion = 1032;

}  // namespace

ZipArchive::ZipArchive(const MappedFile& file) : file_(file) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source =
      zip_source_buffer_create(file_.bytes().data(), file_.bytes().size(), 0, &error);
  if (source != nullptr) {
    archive_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (!archive_) zip_source_free(source);
  }
  const std::string problem = archive_ ? "" : to_utf8(zip_error_strerror(&error));
  const bool ends_early = zip_error_code_zip(&error) == ZIP_ER_NOZIP;
  zip_error_fini(&error);
  if (archive_) return;
  if (ends_early && file_.bytes().starts_with("PK\x03\x04"))
    refuse("the ZIP archive ends before its list of entries: it is cut off; copy it again");
  refuse(fmt::format("the ZIP archive cannot be read: {}", problem));
}

std::uint64_t ZipArchive::entries() const {
  return static_cast<std::uint64_t>(
      std::max<zip_int64_t>(zip_get_num_entries(archive_.get(), 0), 0));
}

std::string_view ZipArchive::name(std::uint64_t entry) const {
  const char* const raw = zip_get_name(archive_.get(), entry, ZIP_FL_ENC_RAW);
  return raw == nullptr ? std::string_view{} : raw;
}

std::optional<std::uint64_t> ZipArchive::find(const char* name) const {
  const zip_int64_t index = zip_name_locate(archive_.get(), name, 0);
  return index < 0 ? std::nullopt : std::optional(static_cast<std::uint64_t>(index));
}

std::uint64_t ZipArchive::size(std::uint64_t entry, std::string_view name) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  constexpr zip_uint64_t needed =
      ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
  if (zip_stat_index(archive_.get(), entry, 0, &stat) != 0 || (stat.valid & needed) != needed)
    refuse(fmt::format("{}: the archive does not say how long it is", name));
  if (stat.encryption_method != ZIP_EM_NONE)
    refuse(fmt::format("{} is encrypted: unpack the archive and pack it without", name));
  if (stat.comp_method != ZIP_CM_STORE && stat.comp_method != ZIP_CM_DEFLATE)
    refuse(fmt::format("{} is packed by method {}, expected 0 (stored) or 8 (deflated)", name,
                       stat.comp_method));
  // entries may share their bytes, and declare what they like: neither makes content
  packed_ += std::min<std::uint64_t>(stat.comp_size, file_.bytes().size() + 1);
  const std::uint64_t most = stat.comp_method == ZIP_CM_STORE ? std::uint64_t{stat.comp_size}
                                                              : stat.comp_size * largest_expansion;
  if (packed_ > file_.bytes().size() || stat.size > most)
    refuse(
        fmt::format("{} declares {} bytes unpacked, {} packed, in an archive of {}: it is "
                    "damaged",
                    name, stat.size, stat.comp_size, file_.bytes().size()));
  return stat.size;
}

void ZipArchive::refuse(std::string_view problem) const {
  datasets::SourcePosition place;
  place.file = file_.path();
  throw datasets::InputError(place, problem);
}

ZipArchive::Entry::Entry(const ZipArchive& archive, std::uint64_t entry, std::string_view name)
    : archive_(archive),
      name_(name),
      entry_(zip_fopen_index(archive.archive_.get(), entry, 0)) {
  if (!entry_) cannot_read(zip_error_strerror(zip_get_error(archive.archive_.get())));
}

void ZipArchive::Entry::read(void* to, std::size_t count) {
  auto* bytes = static_cast<char*>(to);
  while (count > 0) {
    const zip_int64_t got = zip_fread(entry_.get(), bytes, count);
    if (got < 0) cannot_read(zip_error_strerror(zip_file_get_error(entry_.get())));
    if (got == 0) cannot_read("it ends before the length that the archive declares");
    bytes += got;
    count -= static_cast<std::size_t>(got);
  }
}

// libzip compares when it is asked for what is behind the end
void ZipArchive::Entry::check_sum() {
  std::array<char, 16> rest{};
  for (int i = 0; i < 2; ++i)
    if (zip_fread(entry_.get(), rest.data(), rest.size()) < 0)
      cannot_read(zip_error_strerror(zip_file_get_error(entry_.get())));
}

void ZipArchive::Entry::cannot_read(std::string_view why) const {
  archive_.refuse(fmt::format("{} cannot be read: {}", name_, to_utf8(why)));
}

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
// Layout: National Instruments, "TDM Header File" and "TDM Data Model" (help of the TDM Header
// Writer and of DIAdem).
#include "acquisition/importers/tdm_document.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

// Limits, so that memory does not grow beyond what 10000 channels need.
constexpr std::size_t largest_description = std::size_t{32} << 20;  ///< [bytes]
constexpr std::ptrdiff_t most_marks = 2000000;  ///< elements' and attributes': '<' and '='
constexpr std::ptrdiff_t most_files = 1000;
constexpr std::size_t longest_text = 4000;  ///< [bytes] of a name or a property

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }

  void operator()(zip_file_t* entry) const { zip_fclose(entry); }
};

[[noreturn]] void refuse(const MappedFile& file, const std::string& problem) {
  datasets::SourcePosition place;
  place.file = file.path();
  throw InputError(place, problem);
}

[[noreturn]] void too_large(const MappedFile& file) {
  refuse(file, fmt::format("the description is larger than {} MB, more than 10000 channels need",
                           largest_description >> 20));
}

std::string zip_problem(zip_error_t& error) {
  const std::string why = to_utf8(zip_error_strerror(&error));
  zip_error_fini(&error);
  return fmt::format("the ZIP archive cannot be read: {} (is it cut off?)", why);
}

/// The entry header.xml, unpacked as far as is allowed whatever size is declared.
std::string unpacked(const MappedFile& file) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source =
      zip_source_buffer_create(file.bytes().data(), file.bytes().size(), 0, &error);
  if (source == nullptr) refuse(file, zip_problem(error));
  const std::unique_ptr<zip_t, Discard> archive(zip_open_from_source(source, ZIP_RDONLY, &error));
  if (!archive) {
    zip_source_free(source);
    refuse(file, zip_problem(error));
  }
  zip_error_fini(&error);
  const std::unique_ptr<zip_file_t, Discard> entry(zip_fopen(archive.get(), "header.xml", 0));
  if (!entry) refuse(file, "the ZIP archive has no 'header.xml' that can be read");
  std::string text;
  std::array<char, 65536> piece{};
  for (;;) {
    const zip_int64_t got = zip_fread(entry.get(), piece.data(), piece.size());
    if (got < 0) refuse(file, "'header.xml' in the ZIP archive is damaged");
    if (got == 0) return text;
    text.append(piece.data(), static_cast<std::size_t>(got));
    if (text.size() > largest_description) too_large(file);
  }
}

/// "tdm" of "usi:tdm".
std::string_view local_name(pugi::xml_node of) {
  const std::string_view name = of.name();
  return name.substr(name.find(':') + 1);  // npos + 1 is 0
}

pugi::xml_node child_named(pugi::xml_node of, std::string_view name) {
  return of.find_child([&](pugi::xml_node child) { return local_name(child) == name; });
}

std::string text_within(std::string_view raw, std::size_t most = longest_text) {
  raw = trimmed(raw);
  if (raw.size() > most) {
    std::size_t end = most;  // not within a character
    while (end > most - 4 && (static_cast<unsigned char>(raw[end]) & 0xC0) == 0x80) --end;
    raw = raw.substr(0, end);
  }
  return to_utf8(raw);
}

}  // namespace

TdmDocument::TdmDocument(const MappedFile& file) {
  if (file.bytes().starts_with(std::string_view("PK\x03\x04", 4)))
    load(file, unpacked(file));
  else
    load(file, file.bytes());
  const pugi::xml_node root = document_.document_element();
  if (local_name(root) != "tdm")
    refuse(file,
           fmt::format("expected the element 'usi:tdm', found '{}'", text_within(root.name())));
  include_ = child_named(root, "include");
  data_ = child_named(root, "data");
  if (!data_) refuse(file, "the description has no element 'usi:data', which lists the channels");
  learn_ids(data_);
  const auto files = include_.children("file");
  if (std::distance(files.begin(), files.end()) > most_files)
    refuse(file, fmt::format("the description names more than {} files of samples", most_files));
  for (const pugi::xml_node samples : include_.children("file")) learn_ids(samples);
}

void TdmDocument::load(const MappedFile& file, std::string_view text) {
  if (text.size() > largest_description) too_large(file);
  const std::ptrdiff_t marks =
      std::ranges::count_if(text, [](char c) { return c == '<' || c == '='; });
  if (marks > most_marks)
    refuse(file, "the description has more elements than 10000 channels need");
  const pugi::xml_parse_result result = document_.load_buffer(
      text.data(), text.size(),
      pugi::parse_default | pugi::parse_embed_pcdata | pugi::parse_trim_pcdata);
  if (!result)
    refuse(file, fmt::format("the description is no whole XML document (is it cut off?): {} at "
                             "byte {}",
                             result.description(), result.offset));
}

void TdmDocument::learn_ids(pugi::xml_node of) {
  for (const pugi::xml_node child : of.children())
    if (const pugi::xml_attribute id = child.attribute("id")) by_id_.emplace(id.value(), child);
}

pugi::xml_node TdmDocument::find(std::string_view id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? pugi::xml_node() : found->second;
}

std::vector<pugi::xml_node> TdmDocument::referred(pugi::xml_node by) const {
  std::vector<pugi::xml_node> list;
  std::string_view text = by.child_value();
  constexpr std::string_view begin = "id(\"";
  for (std::size_t at = text.find(begin); at != std::string_view::npos; at = text.find(begin)) {
    text.remove_prefix(at + begin.size());
    const std::size_t end = std::min(text.find('"'), text.size());
    if (const pugi::xml_node found = find(text.substr(0, end))) list.push_back(found);
    text.remove_prefix(end);
  }
  return list;
}

pugi::xml_node TdmDocument::first_referred(pugi::xml_node by) const {
  const std::vector<pugi::xml_node> all = referred(by);
  return all.empty() ? pugi::xml_node() : all.front();
}

std::string tdm_text(pugi::xml_node of, std::size_t most) {
  return text_within(of.child_value(), most);
}

std::string tdm_text(pugi::xml_attribute of) {
  return text_within(of.value());
}

std::string tdm_name(pugi::xml_node of) {
  return text_within(of.name());
}

std::vector<std::string> urls_of_tdm(const TdmDocument& document) {
  std::vector<std::string> urls;
  for (const pugi::xml_node samples : document.include().children("file")) {
    std::string url(samples.attribute("url").value());
    if (std::ranges::find(urls, url) == urls.end()) urls.push_back(std::move(url));
  }
  return urls;
}

namespace {

std::optional<int> hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

/// "a b" of "a%20b".
std::string without_percents(std::string_view url) {
  std::string text;
  for (std::size_t i = 0; i < url.size(); ++i) {
    const bool two = url[i] == '%' && i + 2 < url.size();
    const auto high = two ? hex_digit(url[i + 1]) : std::nullopt;
    const auto low = two ? hex_digit(url[i + 2]) : std::nullopt;
    text += high && low ? static_cast<char>(*high * 16 + *low) : url[i];
    if (high && low) i += 2;
  }
  return text;
}

/// The last part of a path or URL of whatever system.
std::string last_part(std::string_view url) {
  return std::string(url.substr(url.find_last_of("/\\:") + 1));
}

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

}  // namespace

TdmSamples samples_beside_tdm(const std::string& path, const std::string& url, bool alone) {
  const std::filesystem::path description(path);
  for (const std::string& name : {last_part(url), last_part(without_percents(url))}) {
    if (name.empty() || name.find('\0') != std::string::npos) continue;
    const std::filesystem::path beside = description.parent_path() / name;
    if (is_file(beside)) return {beside.string()};
  }
  if (!alone) return {};
  for (const char* const ending : {".tdx", ".TDX"}) {
    std::filesystem::path beside(path);
    beside.replace_extension(ending);
    if (is_file(beside)) return {beside.string(), false};
  }
  return {};
}

}  // namespace impactrig::acquisition

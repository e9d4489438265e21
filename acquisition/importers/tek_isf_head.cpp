// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tek_isf_head.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

/// The keys that matter, with their short spelling.
constexpr std::array<std::pair<std::string_view, std::string_view>, 18> spellings = {{
    {"BYT_NR", "BYT_N"},  //
    {"BIT_NR", "BIT_N"},  //
    {"ENCDG", "ENC"},     //
    {"BN_FMT", "BN_F"},   //
    {"BYT_OR", "BYT_O"},  //
    {"NR_PT", "NR_P"},    //
    {"NR_FR", "NR_FR"},   //
    {"WFID", "WFI"},      //
    {"PT_FMT", "PT_F"},   //
    {"PT_OFF", "PT_O"},   //
    {"XINCR", "XIN"},     //
    {"XZERO", "XZE"},     //
    {"XUNIT", "XUN"},     //
    {"YMULT", "YMU"},     //
    {"YZERO", "YZE"},     //
    {"YOFF", "YOF"},      //
    {"YUNIT", "YUN"},     //
    {"CURVE", "CURV"},    //
}};

constexpr std::size_t longest_head = 65536;

/// The long spelling of "BYT_N" and the like; the key itself when it is none.
std::string long_spelling(std::string_view key) {
  const std::string name = upper_case(trimmed(key));
  for (const auto& [full, abbreviated] : spellings)
    if (name == full || name == abbreviated) return std::string(full);
  return name;
}

bool is_known(std::string_view key) {
  return std::ranges::any_of(spellings, [&](const auto& one) { return one.first == key; });
}

class IsfHeadReader {
 public:
  IsfHeadReader(const MappedFile& file, std::size_t at)
      : file_(file),
        bytes_(file.bytes().substr(0, std::min(file.bytes().size(), at + longest_head))),
        at_(at) {}

  IsfHead read() {
    while (at_ < bytes_.size()) {
      // a key ends at a blank; a value at a semicolon that is not quoted
      while (at_ < bytes_.size() && (bytes_[at_] == ';' || is_space(bytes_[at_]))) ++at_;
      const std::size_t first = at_;
      at_ = std::min(bytes_.find_first_of(" ;#\t", at_), bytes_.size());
      const std::string_view header = bytes_.substr(first, at_ - first);
      const std::size_t colon = header.rfind(':');
      const std::string_view name = header.substr(colon + 1);
      if (const std::size_t word = curve_word(name); word > 0) {
        head_.curve = first + (colon + 1) + word;
        return std::move(head_);
      }
      const std::string key = long_spelling(name);
      if (colon != std::string_view::npos && is_known(key)) begin_source(header.substr(0, colon));
      set(key, value());
    }
    return std::move(head_);
  }

 private:
  /// Length of the word CURVE, in which a list of numbers may follow without a blank; 0 for others.
  static std::size_t curve_word(std::string_view name) {
    const std::string start = upper_case(name.substr(0, 6));
    const std::size_t length = start.starts_with("CURVE") ? 5 : start.starts_with("CURV") ? 4 : 0;
    const bool goes_on =
        start.size() > length && std::isalpha(static_cast<unsigned char>(start[length])) != 0;
    return goes_on ? 0 : length;
  }

  /// Of the path ":WFMPRE:CH1" or "CH1"; others than a source's change nothing.
  void begin_source(std::string_view path) {
    const std::string source = to_utf8(upper_case(path.substr(path.rfind(':') + 1)));
    if (source.empty() || source.starts_with("WFM")) return;
    if (head_.preambles.back().source == source) return;
    if (head_.preambles.back().source.empty())
      common_ = head_.preambles.back().keys;
    else
      head_.preambles.push_back({"", common_});
    head_.preambles.back().source = source;
  }

  std::string value() {
    const std::size_t start = at_;
    bool quoted = false;
    while (at_ < bytes_.size() && (quoted || bytes_[at_] != ';')) {
      if (bytes_[at_] == '"') quoted = !quoted;
      ++at_;
    }
    std::string_view value = trimmed(bytes_.substr(start, at_ - start));
    if (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = value.substr(1, value.size() - 2);
    return to_utf8(trimmed(value));
  }

  void set(const std::string& key, const std::string& value) {
    if (key.empty()) return;
    IsfPreamble& preamble = head_.preambles.back();
    const auto [place, is_new] = preamble.keys.try_emplace(to_utf8(key), value);
    if (is_new || place->second == value) return;
    // a source's own replaces what all have in common
    const auto common = common_.find(place->first);
    const bool replaces =
        !preamble.source.empty() && common != common_.end() && common->second == place->second;
    if (!replaces && is_known(key))
      throw InputError(file_.byte_position(at_),
                       fmt::format("the preamble states {} twice, '{}' and '{}', without naming "
                                   "the source of each: {}",
                                   place->first, place->second, value, one_source_a_file));
    place->second = value;
  }

  const MappedFile& file_;
  std::string_view bytes_;
  std::size_t at_;
  IsfHead head_;
  std::map<std::string, std::string> common_;  ///< of all sources of the answer
};

}  // namespace

std::string upper_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

bool begins_isf(std::string_view bytes) {
  const std::string start = upper_case(trimmed(bytes.substr(0, 64)));
  return start.starts_with(":WFMP") || start.starts_with(":WFMO") || start.starts_with("WFMP") ||
         start.starts_with("WFMO") || start.starts_with("BYT_N") || start.starts_with(":CURV");
}

IsfHead read_isf_head(const MappedFile& file, std::size_t at) {
  return IsfHeadReader(file, at).read();
}

}  // namespace impactrig::acquisition

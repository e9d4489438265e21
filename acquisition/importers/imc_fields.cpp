// SPDX-License-Identifier: BSD-3-Clause
// The keys of imc FAMOS files; the source of their layout stands in imc_raw.cpp.
#include "acquisition/importers/imc_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "acquisition/importers/byte_cursor.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::InputError;
using datasets::Record;

namespace {

constexpr std::size_t event_bytes = 72;
constexpr std::size_t digital_bits = 16;  ///< of a word

/// One key, with its contents and where they lie.
struct Key {
  std::string_view name;
  int version = 0;
  std::string_view contents;
  std::uint64_t place = 0;  ///< of '|' [bytes]
  std::uint64_t contents_at = 0;
};

/// Walks along the parameters of a key, which commas separate.
class Parameters {
 public:
  explicit Parameters(std::string_view text) : text_(text) {}

  std::string_view next() {
    const std::size_t comma = std::min(text_.find(',', at_), text_.size());
    const std::string_view found =
        at_ <= text_.size() ? text_.substr(at_, comma - at_) : std::string_view();
    at_ = std::min(comma + 1, text_.size() + 1);
    return trimmed(found);
  }

  /// A length, then a text of that length, which may hold commas. A writer that quotes its texts
  /// counts them without the quotes.
  std::string text() {
    const auto length = integer_in(next());
    if (at_ > text_.size()) return {};
    std::string_view found = text_.substr(at_);
    const bool fits = length && *length >= 0 && static_cast<std::size_t>(*length) <= found.size() &&
                      (static_cast<std::size_t>(*length) == found.size() ||
                       found[static_cast<std::size_t>(*length)] == ',');
    found = found.substr(0, fits ? static_cast<std::size_t>(*length) : found.find(','));
    at_ += found.size() + 1;
    found = trimmed(found);
    if (!fits && found.size() >= 2 && found.front() == '"' && found.back() == '"')
      found = found.substr(1, found.size() - 2);
    return to_utf8(found);
  }

  bool at_end() const { return at_ >= text_.size(); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

class KeyReader {
 public:
  KeyReader(const MappedFile& file, Record& record) : file_(file), record_(record) {}

  ImcContents read() {
    while (const auto key = next_key()) read_key(*key);
    finish_field();
    if (!seen_format_)
      throw InputError(file_.byte_position(0), "expected the key '|CF' of an imc FAMOS file");
    return std::move(contents_);
  }

 private:
  [[noreturn]] void fail(std::uint64_t place, const std::string& problem) const {
    throw InputError(file_.byte_position(place), problem);
  }

  std::optional<Key> next_key() {
    const std::string_view bytes = file_.bytes();
    while (at_ < bytes.size() && (bytes[at_] == ' ' || bytes[at_] == '\r' || bytes[at_] == '\n' ||
                                  bytes[at_] == '\t' || bytes[at_] == '\0'))
      ++at_;
    if (at_ >= bytes.size()) return std::nullopt;
    Key key;
    key.place = at_;
    if (bytes[at_] != '|')
      fail(at_, fmt::format("expected a key that begins with '|', found '{}'",
                            to_utf8(bytes.substr(at_, 1))));
    // "|CF,2,1,": name, version and length
    const std::string_view start = bytes.substr(at_, 64);
    std::array<std::size_t, 3> commas{};
    std::size_t from = 0;
    for (std::size_t& comma : commas) {
      comma = start.find(',', from);
      if (comma == std::string_view::npos) {
        if (start.size() < 64 && fields_ready()) return cut_key(key);
        fail(at_, "expected '|XX,version,length,' of a key");
      }
      from = comma + 1;
    }
    key.name = start.substr(1, commas[0] - 1);
    const auto version = integer_in(start.substr(commas[0] + 1, commas[1] - commas[0] - 1));
    const auto length = integer_in(start.substr(commas[1] + 1, commas[2] - commas[1] - 1));
    if (key.name.size() != 2 || !version || !length || *length < 0 || *version < 0 ||
        *version > 1000)
      fail(at_, fmt::format("expected a key, its version and its length, found '{}'",
                            to_utf8(start.substr(0, commas[2]))));
    key.version = static_cast<int>(*version);
    key.contents_at = at_ + commas[2] + 1;
    const auto size = static_cast<std::uint64_t>(*length);
    const std::uint64_t there =
        bytes.size() - std::min<std::uint64_t>(bytes.size(), key.contents_at);
    if (size > there && key.name != "CS") {
      if (fields_ready()) return cut_key(key);
      fail(at_, fmt::format("the file ends within the key '{}'", to_utf8(key.name)));
    }
    key.contents = bytes.substr(key.contents_at, std::min(size, there));
    at_ = key.contents_at + key.contents.size();
    if (at_ < bytes.size() && bytes[at_] != ';')
      fail(at_, fmt::format("expected ';' behind the key '{}', found '{}'", to_utf8(key.name),
                            to_utf8(bytes.substr(at_, 1))));
    ++at_;
    return key;
  }

  /// True when there is something to read in front of a key that is cut off.
  bool fields_ready() const { return samples_seen_; }

  std::optional<Key> cut_key(const Key& key) {
    contents_.left_out.push_back(fmt::format(
        "the file ends within the key at byte {}: what follows is left out", key.place));
    return std::nullopt;
  }

  double number(Parameters& parameters, const Key& key, std::string_view what) const {
    const std::string_view text = parameters.next();
    const auto value = number_in(text);
    if (!value || !std::isfinite(*value))
      fail(key.place, fmt::format("{}: expected {}, found '{}'", to_utf8(key.name), what,
                                  to_utf8(text.substr(0, 40))));
    return *value;
  }

  std::uint64_t count(Parameters& parameters, const Key& key, std::string_view what) const {
    const std::string_view text = parameters.next();
    const auto value = integer_in(text);
    if (!value || *value < 0)
      fail(key.place, fmt::format("{}: expected {}, found '{}'", to_utf8(key.name), what,
                                  to_utf8(text.substr(0, 40))));
    return static_cast<std::uint64_t>(*value);
  }

  void read_key(const Key& key) {
    Parameters in(key.contents);
    if (key.name == "CF") {
      read_format(key, in);
    } else if (!seen_format_) {
      fail(key.place, "expected the key '|CF' of an imc FAMOS file");
    } else if (key.name == "CK") {
      in.next();
      contents_.closed = integer_in(in.next()) == 1;
      if (!contents_.closed)
        record_.warnings.push_back("the file was not closed by the program that wrote it");
    } else if (key.name == "NO") {
      in.next();
      set_attribute(record_, "origin", in.text());
      set_attribute(record_, "origin comment", in.text());
    } else if (key.name == "CB") {
      in.next();
      group_ = in.text();
    } else if (key.name == "CG") {
      finish_field();
      in.next();
      field_ = ImcField{};
      field_.type = static_cast<int>(std::min<std::uint64_t>(count(in, key, "a type"), 100));
      abscissa_ = {};
      segment_ = 0;
      event_reference_.reset();
    } else if (key.name == "CD") {
      read_abscissa(key, in);
    } else if (key.name == "CZ") {
      read_segments(key, in);
    } else if (key.name == "CV") {
      read_events(key);
    } else if (key.name == "Cv") {
      read_event_reference(key, in);
    } else if (key.name == "NT") {
      read_trigger(key, in);
    } else if (key.name == "CC") {
      start_component(key, in);
    } else if (key.name == "CP") {
      read_packing(key, in);
    } else if (key.name == "Cb") {
      read_buffers(key, in);
    } else if (key.name == "CR") {
      read_range(key, in);
    } else if (key.name == "CN") {
      read_name(key, in);
    } else if (key.name == "CS") {
      read_samples(key, in);
    }
    // other keys (texts, colours, properties, single values) are no part of a recording
  }

  void read_format(const Key& key, Parameters& in) {
    if (key.version != 2)
      fail(key.place, fmt::format("this is an imc FAMOS file of version {}, expected 2: save it "
                                  "anew with FAMOS, or as ASCII",
                                  key.version));
    const std::uint64_t processor = count(in, key, "a processor");
    if (processor != 1 && processor != 2)
      fail(key.place, fmt::format("CF: expected the processor 1 (Intel) or 2 (Motorola), found {}",
                                  processor));
    contents_.big_endian = processor == 2;
    seen_format_ = true;
    record_.attributes["byte order"] = contents_.big_endian ? "big-endian" : "little-endian";
  }

  void read_abscissa(const Key& key, Parameters& in) {
    abscissa_ = {};
    abscissa_.interval = number(in, key, "a distance");
    const auto calibrated = integer_in(in.next());
    abscissa_.unit = in.text();
    if (calibrated == 0) abscissa_.unit.clear();
    if (key.version == 2) {
      for (int i = 0; i < 3; ++i) in.next();  // reduction, events, sorting
      abscissa_.start = number(in, key, "an x of the first sample");
      abscissa_.start_usage = static_cast<int>(integer_in(in.next()).value_or(1));
    }
    if (component_) component_->abscissa = abscissa_;
  }

  /// "|CZ,1,length,dz,1,z0,1,length of unit,unit,samples of a segment;"
  void read_segments(const Key& key, Parameters& in) {
    for (int i = 0; i < 4; ++i) in.next();
    in.text();
    segment_ = count(in, key, "the samples of a segment");
    if (component_) component_->segment = segment_;
  }

  /// "|CV,1,length,number of the list,count,number,72 bytes,number,72 bytes;"
  void read_events(const Key& key) {
    std::size_t at = 0;
    const auto whole_number = [&](std::string_view what) {
      const std::size_t comma = std::min(key.contents.find(',', at), key.contents.size());
      const auto value = integer_in(trimmed(key.contents.substr(at, comma - at)));
      if (!value || *value < 0) fail(key.place, fmt::format("CV: expected {}", what));
      at = std::min(comma + 1, key.contents.size());
      return *value;
    };
    std::vector<ImcEvent>& events =
        contents_.events[whole_number("the number of a list of events")];
    const auto announced = static_cast<std::uint64_t>(whole_number("a number of events"));
    for (std::uint64_t i = 0; i < announced; ++i) {
      if (at < key.contents.size()) whole_number("the number of an event");
      if (key.contents.size() - at < event_bytes)
        fail(key.place, fmt::format("CV: {} events are announced, {} found", announced, i));
      events.push_back(event_at(key.contents_at + at));
      at = std::min(at + event_bytes + 1, key.contents.size());
    }
  }

  /// Places and lengths are split: their upper halves stand at the end.
  ImcEvent event_at(std::uint64_t place) const {
    ByteCursor in(file_, contents_.big_endian, place);
    constexpr std::string_view what = "an event";
    ImcEvent event;
    event.first = in.read<std::uint32_t>(what);
    event.count = in.read<std::uint32_t>(what);
    event.time = in.read<double>(what);
    event.shift = in.read<double>(what);
    in.skip(8);  // the offset of a second component
    event.start = in.read<double>(what);
    event.factor = in.read<double>(what);
    in.skip(8);  // the factor of a second component
    event.interval = in.read<double>(what);
    event.first += std::uint64_t{in.read<std::uint32_t>(what)} << 32;
    event.count += std::uint64_t{in.read<std::uint32_t>(what)} << 32;
    return event;
  }

  void read_event_reference(const Key& key, Parameters& in) {
    ImcEventReference reference;
    reference.list = static_cast<long>(count(in, key, "the number of a list of events"));
    reference.first = count(in, key, "the number of an event");
    in.next();  // events side by side: 1
    reference.step = 1 + std::min<std::uint64_t>(count(in, key, "a gap of events"), 1000);
    reference.count = count(in, key, "a number of events");
    in.next();  // where the trigger time stands
    reference.own_axis = integer_in(in.next()).value_or(0) != 0;
    reference.own_scale = integer_in(in.next()).value_or(0) != 0;
    event_reference_ = reference;
    if (component_) component_->events = reference;
  }

  void read_trigger(const Key& key, Parameters& in) {
    for (int* const part :
         {&trigger_.day, &trigger_.month, &trigger_.year, &trigger_.hour, &trigger_.minute})
      *part = static_cast<int>(std::min<std::uint64_t>(count(in, key, "a date"), 9999));
    trigger_.second = number(in, key, "a second");
    if (component_) component_->trigger = trigger_;
  }

  void start_component(const Key& key, Parameters& in) {
    finish_component();
    component_ = ImcComponent{};
    component_->place = key.place;
    component_->index = integer_in(in.next()).value_or(1);
    component_->digital = integer_in(in.next()) == 2;
    component_->group = group_;
    component_->abscissa = abscissa_;
    component_->segment = segment_;
    component_->trigger = trigger_;
    component_->events = event_reference_;
  }

  ImcComponent& component(const Key& key) {
    if (!component_)
      fail(key.place,
           fmt::format("the key '{}' stands outside of a component ('CC')", to_utf8(key.name)));
    return *component_;
  }

  void read_packing(const Key& key, Parameters& in) {
    ImcComponent& one = component(key);
    in.next();  // reference of the buffer
    one.bytes =
        static_cast<int>(std::min<std::uint64_t>(count(in, key, "the bytes of a number"), 1000));
    one.number_format =
        static_cast<int>(std::min<std::uint64_t>(count(in, key, "a format of numbers"), 1000));
    in.next();  // significant bits
    one.mask = count(in, key, "a mask");
    one.offset = count(in, key, "the place of the first number");
    one.count = count(in, key, "a number of numbers");
    one.distance = count(in, key, "a distance of numbers");
  }

  void read_buffers(const Key& key, Parameters& in) {
    ImcComponent& one = component(key);
    const std::uint64_t buffers = count(in, key, "a number of buffers");
    const std::uint64_t user_bytes = count(in, key, "the bytes of user information");
    for (std::uint64_t i = 0; i < buffers; ++i) {
      if (in.at_end())
        fail(key.place, fmt::format("Cb: {} buffers are announced, {} found", buffers, i));
      ImcBuffer buffer;
      in.next();  // its reference
      buffer.samples_key = static_cast<long>(count(in, key, "the number of a key CS"));
      buffer.offset = count(in, key, "the place of a buffer");
      buffer.bytes = count(in, key, "the bytes of a buffer");
      buffer.first = count(in, key, "the place of the first sample");
      buffer.filled = count(in, key, "the filled bytes of a buffer");
      buffer.new_event = integer_in(in.next()) != 0;
      buffer.start = number(in, key, "the x of the first sample");
      buffer.add_time = number(in, key, "a time");
      if (user_bytes > 0 || !in.at_end()) in.next();
      one.buffers.push_back(buffer);
    }
  }

  void read_range(const Key& key, Parameters& in) {
    ImcComponent& one = component(key);
    const bool scaled = integer_in(in.next()) == 1;
    const double factor = number(in, key, "a factor");
    const double shift = number(in, key, "an offset");
    if (scaled) {
      one.factor = factor;
      one.shift = shift;
    }
    const auto calibrated = integer_in(in.next());
    const std::string unit = in.text();
    if (calibrated != 0) one.unit = unit;
  }

  void read_name(const Key& key, Parameters& in) {
    if (!component_) return;  // of a text or a single value
    in.next();                // group
    in.next();
    ImcName read;
    read.bit = static_cast<int>(std::clamp(integer_in(in.next()).value_or(0), 0L, 1000L));
    read.name = in.text();
    read.comment = in.text();
    if (component_->digital && component_->named) {
      if (component_->other_bits.size() >= digital_bits)
        fail(key.place, fmt::format("CN: more than {} names of bits", digital_bits));
      component_->other_bits.push_back(std::move(read));
    } else {
      take_name(read, *component_);
    }
  }

  static void take_name(const ImcName& from, ImcComponent& to) {
    to.named = true;
    to.bit = from.bit;
    to.name = from.name;
    to.comment = from.comment;
  }

  /// "|CS,1,length,number,samples;": buffers that waited for this number now know their place.
  void read_samples(const Key& key, Parameters& in) {
    finish_field();
    const std::size_t comma = key.contents.find(',');
    const auto index = integer_in(in.next());
    if (comma == std::string_view::npos || !index)
      fail(key.place, "CS: expected the number of the key, then samples");
    for (const auto& [field, component, number] : waiting_[*index]) {
      ImcBuffer& buffer = contents_.fields[field].components[component].buffers[number];
      buffer.samples_at = key.contents_at + comma + 1;
      buffer.samples_bytes = key.contents.size() - comma - 1;
    }
    waiting_.erase(*index);
    samples_seen_ = true;
  }

  void finish_component() {
    if (!component_) return;
    const std::vector<ImcName> others = std::exchange(component_->other_bits, {});
    field_.components.push_back(*component_);
    for (const ImcName& other : others) {
      take_name(other, *component_);
      field_.components.push_back(*component_);
    }
    component_.reset();
  }

  void finish_field() {
    finish_component();
    if (!field_.components.empty()) {
      for (std::size_t c = 0; c < field_.components.size(); ++c)
        for (std::size_t b = 0; b < field_.components[c].buffers.size(); ++b)
          waiting_[field_.components[c].buffers[b].samples_key].push_back(
              {contents_.fields.size(), c, b});
      contents_.fields.push_back(std::move(field_));
    }
    field_ = ImcField{};
  }

  const MappedFile& file_;
  Record& record_;
  std::uint64_t at_ = 0;
  bool seen_format_ = false;
  bool samples_seen_ = false;
  /// Buffers by the number of the key CS that has not come yet: field, component, buffer.
  std::map<long, std::vector<std::array<std::size_t, 3>>> waiting_;
  std::string group_;
  ImcTrigger trigger_;
  ImcAbscissa abscissa_;
  std::uint64_t segment_ = 0;
  std::optional<ImcEventReference> event_reference_;
  ImcField field_;
  std::optional<ImcComponent> component_;
  ImcContents contents_;
};

}  // namespace

ImcContents read_imc_fields(const MappedFile& file, Record& record) {
  return KeyReader(file, record).read();
}

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/hdf5_arrays.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

#include "acquisition/importers/child_process.hpp"
#include "acquisition/importers/clock_words.hpp"
#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/hdf5_sender.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/hdf5_handle.hpp"
#include "datasets/input_error.hpp"
#include "datasets/units.hpp"

namespace impactrig::acquisition {

using datasets::InputError;

namespace {

constexpr unsigned seconds_to_list =
    8;  ///< of processor time: damage makes HDF5 go round in circles
constexpr double slowest_reading = 1e6;  ///< [numbers/s of processor time]
constexpr std::size_t longest_answer = 65536;

[[noreturn]] void refuse(const std::string& path, std::string_view problem) {
  datasets::SourcePosition place;
  place.file = path;
  throw InputError(place, problem);
}

[[noreturn]] void child_failed(const std::string& path, ChildProcess& child) {
  const std::string how = child.wait();
  refuse(path,
         fmt::format("is damaged: the process that ran HDF5 on it did not end as it should{}{}",
                     how.empty() ? "" : ": ", how));
}

bool take_number_lists(ChildProcess& child, Hdf5Attributes& attributes) {
  std::uint64_t count = 0;
  if (!child.number(count)) return false;
  std::string key;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t numbers = 0;
    if (!child.text(key, longest_answer) || !child.number(numbers) || numbers > hdf5_longest_list)
      return false;
    std::vector<double>& list = attributes.number_lists[to_utf8(key)];
    list.resize(numbers);
    for (double& value : list)
      if (!child.real(value)) return false;
  }
  return true;
}

bool take_others(ChildProcess& child, Hdf5Attributes& attributes) {
  std::uint64_t count = 0;
  if (!child.number(count)) return false;
  std::string key;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!child.text(key, longest_answer)) return false;
    attributes.others.push_back(to_utf8(key));
  }
  return true;
}

bool take(ChildProcess& child, Hdf5Attributes& attributes) {
  std::uint64_t count = 0;
  if (!child.number(count)) return false;
  std::string key;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::string text;
    if (!child.text(key, longest_answer) || !child.text(text, longest_answer)) return false;
    attributes.texts[to_utf8(key)] = to_utf8(text);
  }
  if (!child.number(count)) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t texts = 0;
    if (!child.text(key, longest_answer) || !child.number(texts) || texts > hdf5_longest_list)
      return false;
    std::vector<std::string>& list = attributes.lists[to_utf8(key)];
    list.resize(texts);
    for (std::string& text : list) {
      if (!child.text(text, longest_answer)) return false;
      text = to_utf8(text);
    }
  }
  if (!child.number(count)) return false;
  for (std::uint64_t i = 0; i < count; ++i) {
    double value = 0.0;
    if (!child.text(key, longest_answer) || !child.real(value)) return false;
    attributes.numbers[to_utf8(key)] = value;
  }
  return take_number_lists(child, attributes) && take_others(child, attributes);
}

bool take_scales(ChildProcess& child, Hdf5Array& array) {
  std::uint64_t dimensions = 0;
  if (!child.number(array.reference) || !child.number(dimensions) || dimensions > H5S_MAX_RANK)
    return false;
  array.scales.resize(dimensions);
  for (std::vector<std::uint64_t>& scales : array.scales) {
    std::uint64_t count = 0;
    if (!child.number(count) || count > hdf5_most_scales) return false;
    scales.resize(count);
    for (std::uint64_t& reference : scales)
      if (!child.number(reference)) return false;
  }
  return true;
}

bool take_field_path(ChildProcess& child, Hdf5Array& array) {
  std::uint64_t names = 0;
  if (!child.number(names) || names > hdf5_longest_list) return false;
  array.field_path.resize(names);
  return std::ranges::all_of(
      array.field_path, [&child](std::string& name) { return child.text(name, longest_answer); });
}

bool take(ChildProcess& child, Hdf5Array& array) {
  std::uint64_t rank = 0;
  if (!child.text(array.path, longest_answer) || !take_field_path(child, array) ||
      !child.number(array.field_index) || !child.number(array.fields) ||
      !child.number(array.element) || !child.number(array.elements) || !child.number(rank) ||
      rank > H5S_MAX_RANK)
    return false;
  array.shape.resize(rank);
  for (std::uint64_t& side : array.shape)
    if (!child.number(side)) return false;
  std::uint64_t numbers = 0;
  std::uint64_t wide = 0;
  std::uint64_t bits = 0;
  std::uint64_t complex = 0;
  if (!child.number(numbers) || numbers > 3 || !child.number(wide) || !child.number(bits) ||
      !child.number(complex) || !child.text(array.text, longest_answer))
    return false;
  array.numbers = static_cast<ArrayNumbers>(numbers);
  array.wide = wide != 0;
  array.bits = bits != 0;
  array.complex = complex != 0;
  return take_scales(child, array) && take(child, array.attributes);
}

bool take(ChildProcess& child, Hdf5References& references) {
  std::uint64_t count = 0;
  if (!child.text(references.path, longest_answer) ||
      !child.text(references.kept_as, longest_answer) || !child.number(references.reference) ||
      !child.number(count) || count > hdf5_most_references)
    return false;
  references.to.resize(count);
  for (std::uint64_t& reference : references.to)
    if (!child.number(reference)) return false;
  return true;
}

/// A data set of several texts.
bool take_texts(ChildProcess& child, Hdf5Listing& listing) {
  std::string name;
  std::uint64_t count = 0;
  if (!child.text(name, longest_answer) || !child.number(count) || count > hdf5_longest_list)
    return false;
  std::vector<std::string>& list = listing.text_lists[to_utf8(name)];
  list.resize(count);
  for (std::string& text : list) {
    if (!child.text(text, longest_answer)) return false;
    text = to_utf8(text);
  }
  return true;
}

/// Forks while no other thread is within HDF5.
ChildProcess start(const std::function<void(const PipeWriter&)>& work, unsigned cpu_seconds) {
  const datasets::Hdf5Session session;
  return {work, cpu_seconds};
}

/// One block from the child; its samples live here until the next.
class Blocks {
 public:
  bool take(ChildProcess& child, const Hdf5Slice& slice, std::size_t count) {
    bool whole = false;
    switch (slice.array->numbers) {
      case ArrayNumbers::i16:
        whole = read(child, shorts_, count);
        break;
      case ArrayNumbers::i32:
        whole = read(child, integers_, count);
        break;
      case ArrayNumbers::f32:
        whole = read(child, floats_, count);
        break;
      case ArrayNumbers::f64:
        whole = read(child, doubles_, count);
        break;
    }
    block_.valid = {};
    if (slice.none.any() && whole) {
      valid_.resize(count);
      std::visit(
          [&](auto samples) {
            std::ranges::transform(samples, valid_.begin(), [&](auto sample) {
              return static_cast<std::uint8_t>(!slice.none.holds(static_cast<double>(sample)));
            });
          },
          block_.raw);
      block_.valid = valid_;
    }
    block_.imaginary = {};
    if (slice.array->complex) {
      imaginary_.resize(count);
      whole = whole && child.bytes(imaginary_.data(), count * sizeof(double));
      block_.imaginary = imaginary_;
    }
    if (slice.times != nullptr) {
      times_.resize(count);
      whole = whole && child.bytes(times_.data(), count * sizeof(double));
      for (double& time : times_) time = slice.time_factor * time + slice.time_offset;
    }
    return whole;
  }

  const SampleBlock& block() const { return block_; }

  std::span<const double> times() const { return times_; }

 private:
  template <typename Sample>
  bool read(ChildProcess& child, std::vector<Sample>& samples, std::size_t count) {
    samples.resize(count);
    block_.raw = std::span<const Sample>(samples);
    return child.bytes(samples.data(), count * sizeof(Sample));
  }

  SampleBlock block_;
  std::vector<std::int16_t> shorts_;
  std::vector<std::int32_t> integers_;
  std::vector<float> floats_;
  std::vector<double> doubles_;
  std::vector<double> imaginary_;
  std::vector<double> times_;
  std::vector<std::uint8_t> valid_;
};

bool has_key(std::string_view wanted, const auto& entry) {
  return lowered(entry.first) == wanted;
}

/// A number that an attribute states for all columns, or one a column.
struct ColumnNumber {
  std::optional<double> value;
  std::string problem;  ///< why an attribute that is there gives none
};

ColumnNumber column_number(const Hdf5Attributes& attributes, std::string_view name,
                           std::uint64_t which, std::uint64_t columns) {
  const auto is_it = [name](const auto& entry) { return has_key(name, entry); };
  const auto finite = [name](double value) -> ColumnNumber {
    if (std::isfinite(value)) return {value, {}};
    return {{}, fmt::format("its attribute '{}' is {}", name, value)};
  };
  const auto number = std::ranges::find_if(attributes.numbers, is_it);
  if (number != attributes.numbers.end()) return finite(number->second);
  const auto list = std::ranges::find_if(attributes.number_lists, is_it);
  if (list != attributes.number_lists.end() && list->second.size() == columns)
    return finite(list->second[which]);
  if (list != attributes.number_lists.end())
    return {{},
            fmt::format("its attribute '{}' lists {} numbers, not one{}", name, list->second.size(),
                        columns > 1 ? fmt::format(" or {}", columns) : "")};
  if (std::ranges::any_of(attributes.texts, is_it) || std::ranges::any_of(attributes.lists, is_it))
    return {{}, fmt::format("its attribute '{}' is a text, not a number", name)};
  for (const std::string& other : attributes.others)
    if (lowered(other) == name)
      return {{}, fmt::format("its attribute '{}' is of a type that is not read", name)};
  return {};
}

}  // namespace

std::string Hdf5Array::field() const {
  std::string name;
  for (const std::string& part : field_path) name += (name.empty() ? "" : ".") + part;
  if (elements > 1) name += fmt::format(":{}", element + 1);
  return name;
}

Hdf5Listing list_hdf5(const std::string& path) {
  std::error_code error;
  const std::uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) throw datasets::FileError(path, "cannot be read: " + error.message());
  ChildProcess child =
      start([&](const PipeWriter& out) { send_hdf5_listing(path, bytes, out); }, seconds_to_list);
  Hdf5Listing listing;
  std::string word;
  if (!child.text(word, longest_answer)) child_failed(path, child);
  if (!word.empty()) refuse(path, word);
  for (;;) {
    if (!child.text(word, longest_answer)) child_failed(path, child);
    if (word == "end") return listing;
    bool whole = false;
    if (word == "array") {
      Hdf5Array array;
      whole = take(child, array);
      listing.arrays.push_back(std::move(array));
    } else if (word == "group") {
      std::string name;
      std::uint64_t reference = 0;
      whole = child.text(name, longest_answer) && child.number(reference) &&
              take(child, listing.groups[name]);
      if (reference != 0) listing.referred_groups.emplace(reference, name);
    } else if (word == "references") {
      whole = take(child, listing.references.emplace_back());
    } else if (word == "text") {
      std::string name;
      whole = child.text(name, longest_answer) && child.text(word, longest_answer);
      if (whole) listing.texts[to_utf8(name)] = to_utf8(word);
    } else if (word == "texts") {
      whole = take_texts(child, listing);
    } else if (word == "link") {
      std::string from;
      whole = child.text(from, longest_answer) && child.text(word, longest_answer);
      if (whole) listing.links.emplace(word, from);
    } else if (word == "skipped") {
      whole = child.text(word, longest_answer);
      listing.skipped.push_back(to_utf8(word));
    }
    if (!whole) child_failed(path, child);
  }
}

std::vector<std::string> links_to(const Hdf5Listing& listing, const std::string& path) {
  constexpr std::size_t most = 100;
  std::vector<std::string> found;
  for (std::size_t end = path.size(); end != std::string::npos && end > 0;
       end = path.rfind('/', end - 1)) {
    const auto [first, last] = listing.links.equal_range(path.substr(0, end));
    for (auto link = first; link != last && found.size() < most; ++link)
      found.push_back(link->second + path.substr(end));
  }
  return found;
}

std::vector<Hdf5SliceSeen> read_hdf5_slices(const std::string& path,
                                            const std::vector<Hdf5Slice>& slices,
                                            SampleSink& sink) {
  double numbers = 0.0;
  for (const Hdf5Slice& slice : slices) numbers += static_cast<double>(slice.count);
  const double seconds = std::min(seconds_to_list + numbers / slowest_reading, 1e6);
  ChildProcess child = start([&](const PipeWriter& out) { send_hdf5_slices(path, slices, out); },
                             static_cast<unsigned>(seconds));
  std::vector<std::uint64_t> left;
  for (const Hdf5Slice& slice : slices) left.push_back(slice.count);
  std::vector<Hdf5SliceSeen> seen(slices.size());
  Blocks blocks;
  for (;;) {
    std::uint64_t index = 0;
    std::uint64_t count = 0;
    if (!child.number(index) || !child.number(count)) child_failed(path, child);
    if (index == hdf5_end_of_blocks) {
      if (count < slices.size())
        refuse(path,
               fmt::format("is damaged: {} cannot be read", to_utf8(slices[count].array->path)));
      break;
    }
    if (index >= slices.size() || count == 0 || count > hdf5_block_size || count > left[index])
      child_failed(path, child);
    left[index] -= count;
    if (!blocks.take(child, slices[index], count)) child_failed(path, child);
    if (slices[index].array->wide)
      seen[index].wide.look(std::get<std::span<const double>>(blocks.block().raw));
    seen[index].missing +=
        static_cast<std::uint64_t>(std::ranges::count(blocks.block().valid, std::uint8_t{0}));
    sink.take(index, blocks.block());
    if (slices[index].times != nullptr) sink.take_times(index, blocks.times());
  }
  if (std::ranges::any_of(left, [](std::uint64_t samples) { return samples > 0; }))
    child_failed(path, child);
  return seen;
}

std::optional<double> number_of(const Hdf5Attributes& attributes,
                                std::span<const std::string_view> names) {
  for (const auto& [key, value] : attributes.numbers)
    if (std::ranges::find(names, lowered(key)) != names.end() && std::isfinite(value)) return value;
  return std::nullopt;
}

std::optional<double> quantity_of(const Hdf5Attributes& attributes,
                                  std::span<const std::string_view> names, const std::string& unit,
                                  const std::string& otherwise) {
  for (const auto& [key, value] : attributes.numbers) {
    if (std::ranges::find(names, lowered(key)) == names.end() || !std::isfinite(value)) continue;
    for (const std::string_view ending : {"_units", "_unit"}) {
      const auto stated = attributes.texts.find(key + std::string(ending));
      if (stated == attributes.texts.end()) continue;
      if (const auto conversion = datasets::conversion(stated->second, unit))
        return conversion->factor * value;
    }
    const auto conversion = datasets::conversion(otherwise, unit);
    return conversion ? conversion->factor * value : value;
  }
  for (const auto& [key, text] : attributes.texts) {
    if (std::ranges::find(names, lowered(key)) == names.end()) continue;
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const char* const behind = scan_number(text.data(), end, {}, value);
    if (behind == text.data()) continue;
    const std::string_view stated =
        trimmed(std::string_view(behind, static_cast<std::size_t>(end - behind)));
    if (stated.empty()) return value;
    if (const auto conversion = datasets::conversion(std::string(stated), unit))
      return conversion->factor * value;
  }
  return std::nullopt;
}

Hdf5Packing packing_of(const Hdf5Array& array, std::uint64_t which, std::uint64_t columns) {
  const ColumnNumber factor = column_number(array.attributes, "scale_factor", which, columns);
  const ColumnNumber offset = column_number(array.attributes, "add_offset", which, columns);
  if (!factor.problem.empty()) return {1.0, 0.0, factor.problem};
  if (!offset.problem.empty()) return {1.0, 0.0, offset.problem};
  if (factor.value == 0.0) return {1.0, 0.0, "its attribute 'scale_factor' is 0"};
  if (array.complex && (factor.value || offset.value))
    return {1.0, 0.0, "its numbers are complex and packed"};
  return {factor.value.value_or(1.0), offset.value.value_or(0.0), {}};
}

std::string unapplied_scales(const Hdf5Array& array) {
  constexpr std::array<std::string_view, 3> factors = {"scale", "gain", "scaling_factor"};
  constexpr std::array<std::string_view, 10> factors_of_integers = {
      "slope",      "calibration", "cal_factor",      "conversion", "conversion_factor",
      "multiplier", "lsb",         "volts_per_count", "resolution", "sensitivity"};
  const Hdf5Attributes& attributes = array.attributes;
  const bool integers =
      array.wide || array.numbers == ArrayNumbers::i16 || array.numbers == ArrayNumbers::i32;
  std::set<std::string> names;
  const auto look = [&](const std::string& key, double value) {
    const std::string word = lowered(key);
    const bool factor =
        std::ranges::find(factors, word) != factors.end() ||
        (integers && std::ranges::find(factors_of_integers, word) != factors_of_integers.end());
    const bool offset = word == "offset" || (integers && word == "intercept");
    if ((factor && value != 1.0) || (offset && value != 0.0)) names.insert(key);
  };
  for (const auto& [key, value] : attributes.numbers) look(key, value);
  for (const auto& [key, values] : attributes.number_lists)
    for (const double value : values) look(key, value);
  for (const auto& [key, text] : attributes.texts)
    if (const auto value = number_in(text)) look(key, *value);
  std::string list;
  for (const std::string& name : names)
    list += fmt::format("{}'{}'", list.empty() ? "" : ", ", name);
  return list;
}

std::vector<std::uint64_t> places_of(const Hdf5Slice& slice) {
  const auto& shape = slice.array->shape;
  std::vector<std::uint64_t> places(shape.size(), 0);
  std::uint64_t rest = slice.other;
  for (std::size_t d = shape.size(); d-- > 0;) {
    if (d == slice.along || shape[d] == 0) continue;
    places[d] = rest % shape[d];
    rest /= shape[d];
  }
  return places;
}

bool is_unit_key(std::string_view key) {
  const std::string word = lowered(key);
  return word == "units" || word == "unit" || word == "unit_string";
}

std::string unit_of(const Hdf5Array& array, const std::string& name, std::uint64_t which,
                    std::uint64_t columns) {
  std::string unit;
  for (const auto& [key, list] : array.attributes.lists)
    if (is_unit_key(key) && list.size() == columns) unit = list[which];
  for (const auto& [key, text] : array.attributes.texts)
    if (is_unit_key(key)) unit = text;
  if (unit.empty()) unit = unit_by_name(name);
  // "milliseconds since 2024-03-01 12:00", as NetCDF has it
  unit.resize(std::min(unit.find(" since "), unit.size()));
  return unit;
}

}  // namespace impactrig::acquisition

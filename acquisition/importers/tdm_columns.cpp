// SPDX-License-Identifier: BSD-3-Clause
// Layout: as tdm_document.cpp; representations of sequences: ASAM ODS, "AoLocalColumn".
#include "acquisition/importers/tdm_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <utility>

#include "acquisition/importers/column_heads.hpp"
#include "acquisition/importers/header_fields.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/text_file.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

namespace {

constexpr std::uint64_t largest_place = std::uint64_t{1} << 60;  // sums of two do not overflow

/// Types by their code in TDMS.
constexpr std::array<std::pair<std::string_view, std::uint32_t>, 12> types = {
    {{"eInt8Usi", 0x01},
     {"eInt16Usi", 0x02},
     {"eInt32Usi", 0x03},
     {"eInt64Usi", 0x04},
     {"eUInt8Usi", 0x05},
     {"eUInt16Usi", 0x06},
     {"eUInt32Usi", 0x07},
     {"eUInt64Usi", 0x08},
     {"eFloat32Usi", 0x09},
     {"eFloat64Usi", 0x0A},
     {"eStringUsi", 0x20},
     {"eTimeUsi", 0x44}}};

const TdmsType* type_of(std::string_view name) {
  for (const auto& [known, code] : types)
    if (known == name) return tdms_type(code);
  return nullptr;
}

/// A count or a place, as an attribute states it; none where it is missing or no such number.
std::optional<std::uint64_t> whole_number(pugi::xml_attribute says) {
  const std::string_view text = trimmed(says.value());
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number > largest_place)
    return std::nullopt;
  return number;
}

constexpr std::size_t most_numbers = 10;  ///< of a course or a scale

/// Numbers with blanks between.
void add_numbers(std::string_view text, std::vector<double>& to) {
  constexpr std::string_view blanks = " \t\r\n";
  while (to.size() < most_numbers) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    if (text.empty()) return;
    const std::size_t end = std::min(text.find_first_of(blanks), text.size());
    to.push_back(number_in(text.substr(0, end), {'.', false}).value_or(std::nan("")));
    text.remove_prefix(end);
  }
}

std::vector<double> numbers_in(pugi::xml_node of) {
  std::vector<double> numbers;
  add_numbers(of.child_value(), numbers);
  for (const pugi::xml_node child : of.children()) {
    add_numbers(child.child_value(), numbers);
    if (numbers.size() == most_numbers) break;
  }
  return numbers;
}

/// "raw_linear" of "Raw Linear" and "raw_linear_external": the values are in a file anyway.
std::string representation_of(pugi::xml_node column) {
  std::string text = lowered(tdm_text(column.child("sequence_representation")));
  std::ranges::replace(text, ' ', '_');
  if (text == "rawlinear") text = "raw_linear";
  constexpr std::string_view external = "_external";
  if (text.starts_with("raw_") && text.ends_with(external))
    text.resize(text.size() - external.size());
  if (text.empty() || text == "external_component") text = "explicit";
  return text;
}

/// The scale of numbers in a file, in the words of TDMS.
void set_scale(const std::string& representation, pugi::xml_node column,
               TdmsProperties& properties) {
  const std::vector<double> numbers = numbers_in(column.child("generation_parameters"));
  const std::string scale = "NI_Scale[0]_";
  properties[scale + "Scale_Type"] = representation;
  if (representation == "raw_polynomial" && !numbers.empty() && numbers[0] >= 0.0) {
    properties[scale + "Scale_Type"] = "Polynomial";
    properties[scale + "Polynomial_Coefficients_Size"] = numbers[0] + 1.0;  // the order comes first
    for (std::size_t i = 1; i < numbers.size(); ++i)
      properties[scale + fmt::format("Polynomial_Coefficients[{}]", i - 1)] = numbers[i];
    return;
  }
  const bool calibrated = representation == "raw_linear_calibrated";
  if (representation != "raw_linear" && !calibrated) return;
  properties[scale + "Scale_Type"] = "Linear";
  if (numbers.size() < (calibrated ? 3 : 2)) return;
  const double factor = calibrated ? numbers[2] : 1.0;
  properties[scale + "Linear_Y_Intercept"] = numbers[0] * factor;
  properties[scale + "Linear_Slope"] = numbers[1] * factor;
}

}  // namespace

TdmColumns::TdmColumns(const TdmDocument& document, const std::string& path) : document_(document) {
  open(document, path);
}

void TdmColumns::open(const TdmDocument& document, const std::string& path) {
  std::unordered_map<std::string, std::size_t> opened;  // by url
  const bool alone = urls_of_tdm(document).size() == 1;
  for (const pugi::xml_node samples : document.include().children("file")) {
    const std::string url = samples.attribute("url").value();
    const auto [known, added] = opened.emplace(url, files_.size());
    if (added) {
      const TdmSamples beside = samples_beside_tdm(path, url, alone);
      datasets::SourcePosition place;
      place.file = path;
      const std::string named = tdm_text(samples.attribute("url"));
      if (beside.path.empty())
        throw datasets::InputError(
            place, fmt::format("the samples are in '{}', which is not beside this description: "
                               "copy both files into one folder",
                               named));
      if (!beside.as_named)
        warnings_.push_back(fmt::format(
            "the description names its samples '{}', which is not beside it: read is '{}', which "
            "has its own name",
            named, to_utf8(std::filesystem::path(beside.path).filename().string())));
      files_.push_back(std::make_unique<MappedFile>(beside.path));
    }
    const bool big_endian = lowered(samples.attribute("byteOrder").value()) == "bigendian";
    for (const pugi::xml_node block : samples.children())
      blocks_.emplace(block.attribute("id").value(), Block{known->second, big_endian, block});
  }
}

/// The block that <values external="inc0"/> or <flags external="inc0"/> names.
const TdmColumns::Block* TdmColumns::block_of(pugi::xml_node element) const {
  const auto found = blocks_.find(element.attribute("external").value());
  return found == blocks_.end() ? nullptr : &found->second;
}

/// The element <values> of the sequence that a column refers to.
pugi::xml_node TdmColumns::values_of(pugi::xml_node column) const {
  return document_.first_referred(column.child("values")).child("values");
}

/// Values side by side (block), or one a record of `blockSize` bytes (block_bm).
TdmColumns::Place TdmColumns::place_of(const Block& block, std::uint64_t width) const {
  const auto first = whole_number(block.says.attribute("byteOffset"));
  const auto count = whole_number(block.says.attribute("length"));
  if (!first || !count) return {};
  Place place{*first, width, *count};
  if (std::string_view(block.says.name()) == "block_bm") {
    const auto record = whole_number(block.says.attribute("blockSize"));
    if (!record || *record < width) return {};
    place.stride = *record;
    place.offset += whole_number(block.says.attribute("blockOffset")).value_or(0);
  }
  return place;
}

StoredNumbers TdmColumns::numbers_of(const Block& block, NumberKind kind,
                                     std::uint64_t width) const {
  const Place place = place_of(block, width);
  StoredNumbers numbers(kind, block.big_endian);
  const MappedFile& file = *files_[block.file];
  // of a time stamp all its 16 bytes have to be there
  const std::uint64_t behind = width - size_of(kind);
  const std::uint64_t there = place.stride == 0 ? 0
                                                : numbers_there(file, place.offset + behind,
                                                                place.stride, kind, place.count);
  numbers.add({place.offset, there, place.stride});
  return numbers;
}

void TdmColumns::set_stored(pugi::xml_node values, const std::string& channel,
                            TdmColumn& made) const {
  const Block* const block = block_of(values);
  if (block == nullptr) {
    made.problem = values.first_child() || *values.child_value() != '\0'
                       ? "its numbers stand in the description, not in a file of samples"
                       : "it refers to no numbers";
    return;
  }
  const std::string type = tdm_text(block->says.attribute("valueType"));
  const TdmsType* const known = type_of(type);
  if (known == nullptr) {
    made.problem = fmt::format("its numbers are of the type '{}', which is not known", type);
    return;
  }
  made.file = block->file;
  made.part.type = known;
  const std::uint64_t width = std::max<std::uint64_t>(made.part.type->size, 1);
  const Place place = place_of(*block, width);
  if (place.stride == 0) {
    made.problem = "the description does not say where its numbers are";
    return;
  }
  if (made.part.type->role == TdmsRole::text) {
    made.part.texts = std::max<std::uint64_t>(place.count, 1);
    return;
  }
  StoredNumbers numbers = numbers_of(*block, made.part.type->kind, width);
  if (numbers.size() < place.count) {
    made.part.announced = place.count;
    made.warnings.push_back(cut_off(channel, numbers.size(), place.count));
  }
  if (made.part.type->role == TdmsRole::time && numbers.size() > 0) {
    made.part.first_value = place.offset;
    made.part.last_value = place.offset + (numbers.size() - 1) * place.stride;
    StoredNumbers middle(made.part.type->kind, block->big_endian);
    middle.add({place.offset + 4, numbers.size(), place.stride});  // see tdms_recording.cpp
    numbers = middle;
  }
  made.part.sources.push_back({TdmsScaling::raw_data, -1, std::move(numbers), {}});
}

/// First number and step of an implicit sequence: its parameters, or else its values.
std::vector<double> TdmColumns::ramp_numbers(pugi::xml_node column) const {
  std::vector<double> numbers = numbers_in(column.child("generation_parameters"));
  if (!numbers.empty()) return numbers;
  const pugi::xml_node values = values_of(column);
  const Block* const block = block_of(values);
  if (block == nullptr) return numbers_in(values);
  const std::string type = tdm_text(block->says.attribute("valueType"));
  const TdmsType* const known = type_of(type);
  if (known == nullptr || known->role != TdmsRole::number) return {};
  const NumberKind kind = known->kind;
  const StoredNumbers stored = numbers_of(*block, kind, size_of(kind));
  numbers.resize(std::min<std::uint64_t>(stored.size(), 2));
  read_numbers(*files_[block->file], stored, 0, numbers);
  return numbers;
}

void TdmColumns::set_ramp(pugi::xml_node column, bool constant, const std::string& channel,
                          TdmColumn& made) const {
  const std::vector<double> numbers = ramp_numbers(column);
  const std::size_t needed = constant ? 1 : 2;
  if (numbers.size() < needed ||
      !std::all_of(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(needed),
                   [](double number) { return std::isfinite(number); })) {
    made.problem = "it states no course of its numbers";
    return;
  }
  const pugi::xml_node rows =
      document_.first_referred(column.child("submatrix")).child("number_of_rows");
  std::uint64_t count = 0;
  const std::string_view text = trimmed(rows.child_value());
  std::from_chars(text.data(), text.data() + text.size(), count);
  if (const Block* const block = block_of(values_of(column)))
    if (const auto beside = whole_number(block->says.attribute("length")); beside.value_or(0) > 2)
      made.warnings.push_back(fmt::format(
          "'{}' is a course of numbers by its description: {} values that it has beside are not "
          "read",
          channel, *beside));
  made.part.type = tdms_type(0x0A);
  const NumberRamp ramp{numbers[0], constant ? 0.0 : numbers[1]};
  made.part.sources.push_back({TdmsScaling::raw_data, -1, StoredNumbers(ramp, count), {}});
}

/// One mark a sample, of which the lowest bit says that it is sound (15, as a rule; else 0).
void TdmColumns::set_marks(pugi::xml_node column, TdmColumn& made) const {
  const pugi::xml_node flags = column.child("flags");
  if (!flags) return;
  const Block* block = block_of(flags);
  if (block == nullptr) block = block_of(document_.first_referred(flags).child("values"));
  if (block == nullptr || block->file != made.file) return;
  const std::string type = tdm_text(block->says.attribute("valueType"));
  const TdmsType* const known = type_of(type);
  if (known == nullptr || known->role != TdmsRole::number) return;
  const NumberKind kind = known->kind;
  made.part.marks = numbers_of(*block, kind, size_of(kind));
}

TdmColumn TdmColumns::column(pugi::xml_node column, const std::string& channel) const {
  TdmColumn made;
  const std::string representation = representation_of(column);
  if (representation == "implicit_linear" || representation == "implicit_constant") {
    set_ramp(column, representation == "implicit_constant", channel, made);
  } else if (representation.starts_with("implicit_") || representation == "formula") {
    made.problem = fmt::format("its numbers are a '{}', which is not read", representation);
  } else {
    set_stored(values_of(column), channel, made);
    if (representation != "explicit") set_scale(representation, column, made.part.properties);
    set_marks(column, made);
  }
  made.part.is_axis = trimmed(column.child("independent").child_value()) == "1";
  return made;
}

}  // namespace impactrig::acquisition

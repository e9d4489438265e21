// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/acquisition/bytes.hpp"

namespace impactrig::acquisition::tests {

/// A scaler of DAQmx raw data; `offset` in bytes, of a digital line in bits.
struct TdmsScaler {
  /// 0 u8, 1 i8, 2 u16, 3 i16, 4 u32, 5 i32, 6 u64, 7 i64, 8 f32, 9 f64, 0xFFFFFFFF time stamp
  std::uint32_t type = 3;
  std::uint32_t buffer = 0;
  std::uint32_t offset = 0;
  std::uint32_t id = 0;
};

/// The parts of a TDMS file in one byte order.
class TdmsParts {
 public:
  explicit TdmsParts(bool big_endian = false) : big_(big_endian) {}

  template <typename Number>
  std::string number(Number value) const {
    return bytes_of_number(value, big_);
  }

  template <typename Number>
  std::string numbers(const std::vector<Number>& values) const {
    return bytes_of_numbers(values, big_);
  }

  std::string text(std::string_view value) const {
    return number(static_cast<std::uint32_t>(value.size())) + std::string(value);
  }

  /// A time stamp: seconds since 1904 and 2^-64 parts.
  std::string time(std::int64_t seconds, std::uint64_t fraction = 0) const {
    return big_ ? number(seconds) + number(fraction) : number(fraction) + number(seconds);
  }

  std::string none() const { return number(std::uint32_t{0xFFFFFFFF}); }

  std::string same() const { return number(std::uint32_t{0}); }

  std::string index(std::uint32_t type, std::uint64_t count, std::uint32_t dimensions = 1) const {
    return number(std::uint32_t{20}) + number(type) + number(dimensions) + number(count);
  }

  std::string text_index(std::uint64_t count, std::uint64_t bytes) const {
    return number(std::uint32_t{28}) + number(std::uint32_t{0x20}) + number(std::uint32_t{1}) +
           number(count) + number(bytes);
  }

  std::string daqmx_index(std::uint64_t count, const std::vector<TdmsScaler>& scalers,
                          const std::vector<std::uint32_t>& widths, std::uint32_t header = 0x1269,
                          std::uint32_t type = 0xFFFFFFFF) const {
    std::string bytes = number(header) + number(type) + number(std::uint32_t{1}) + number(count) +
                        number(static_cast<std::uint32_t>(scalers.size()));
    for (const TdmsScaler& scaler : scalers) {
      bytes += number(scaler.type) + number(scaler.buffer) + number(scaler.offset);
      bytes += header == 0x1269 ? number(std::uint32_t{0}) : number(std::uint8_t{0});
      bytes += number(scaler.id);
    }
    return bytes + number(static_cast<std::uint32_t>(widths.size())) + numbers(widths);
  }

  std::string property(std::string_view name, std::string_view value) const {
    return text(name) + number(std::uint32_t{0x20}) + text(value);
  }

  std::string property(std::string_view name, double value) const {
    return text(name) + number(std::uint32_t{0x0A}) + number(value);
  }

  std::string property(std::string_view name, std::uint32_t value) const {
    return text(name) + number(std::uint32_t{0x07}) + number(value);
  }

  /// Of any type: `value` as it lies in the file.
  std::string raw_property(std::string_view name, std::uint32_t type,
                           const std::string& value) const {
    return text(name) + number(type) + value;
  }

  std::string object(std::string_view path, const std::string& index,
                     const std::vector<std::string>& properties = {}) const {
    std::string bytes = text(path) + index + number(static_cast<std::uint32_t>(properties.size()));
    for (const std::string& property : properties) bytes += property;
    return bytes;
  }

  /// A channel of the group "G".
  std::string channel(std::string_view name, const std::string& index,
                      const std::vector<std::string>& properties = {}) const {
    return object("/'G'/'" + std::string(name) + "'", index, properties);
  }

  static constexpr std::uint32_t interleaved = 0x20;
  static constexpr std::uint32_t continued = 0x10000;  ///< ours: no new list of objects
  static constexpr std::uint32_t bare = 0x20000;       ///< ours: no list at all

  /// A segment; `length` and `raw_offset` replace what its head says of the rest.
  std::string segment(const std::vector<std::string>& objects, const std::string& data,
                      std::uint32_t flags = 0, std::optional<std::uint64_t> length = {},
                      std::optional<std::uint64_t> raw_offset = {}) const {
    std::string list;
    std::uint32_t contents = (flags & 0xFF) | (data.empty() ? 0U : 8U) | (big_ ? 0x40U : 0U);
    if ((flags & bare) == 0) {
      contents |= (flags & continued) != 0 ? 2U : 6U;
      list = number(static_cast<std::uint32_t>(objects.size()));
      for (const std::string& object : objects) list += object;
    }
    return "TDSm" + bytes_of_number(contents) + number(std::uint32_t{4713}) +
           number(length.value_or(list.size() + data.size())) +
           number(raw_offset.value_or(list.size())) + list + data;
  }

 private:
  bool big_;
};

/// Small files of every kind of raw data.
inline std::vector<std::string> tdms_seeds() {
  std::vector<std::string> seeds;
  for (const bool big : {false, true}) {
    const TdmsParts t(big);
    const std::vector<std::int16_t> shorts = {1, 2, 3, 4};
    const std::vector<double> doubles = {0.5, 1.5};
    seeds.push_back(
        t.segment({t.object("/", t.none(), {t.property("name", "run")}), t.object("/'G'", t.none()),
                   t.channel("F", t.index(2, 2),
                             {t.property("unit_string", "N"), t.property("wf_increment", 1e-3),
                              t.raw_property("wf_start_time", 0x44, t.time(3600000000)),
                              t.property("NI_Number_Of_Scales", 1U),
                              t.property("NI_Scale[0]_Scale_Type", "Polynomial"),
                              t.property("NI_Scale[0]_Polynomial_Coefficients_Size", 3U),
                              t.property("NI_Scale[0]_Polynomial_Coefficients[0]", 1.0),
                              t.property("NI_Scale[0]_Polynomial_Coefficients[1]", 2.0),
                              t.property("NI_Scale[0]_Polynomial_Coefficients[2]", 3.0)}),
                   t.channel("v", t.index(10, 2))},
                  t.numbers(std::vector<std::int16_t>{1, 2}) + t.numbers(doubles)) +
        t.segment({}, t.numbers(std::vector<std::int16_t>{3, 4}) + t.numbers(doubles),
                  TdmsParts::bare) +
        t.segment({t.channel("v", t.none())}, t.numbers(shorts), TdmsParts::continued));
    seeds.push_back(t.segment({t.channel("a", t.index(2, 2)), t.channel("b", t.index(2, 2))},
                              t.numbers(shorts), TdmsParts::interleaved));
    seeds.push_back(t.segment({t.channel("a", t.daqmx_index(2, {{3, 0, 0, 0}}, {4})),
                               t.channel("b", t.daqmx_index(2, {{3, 0, 2, 0}}, {4}))},
                              t.numbers(shorts), 0x80));
    seeds.push_back(t.segment({t.channel("a", t.daqmx_index(4, {{0, 0, 3, 0}}, {2}, 0x126A))},
                              t.numbers(shorts), 0x80));
    seeds.push_back(t.segment(
        {t.channel("t", t.index(0x44, 2)), t.channel("c", t.index(0x08000C, 2))},
        t.time(3600000000) + t.time(3600000001) + t.numbers(doubles), 0, ~std::uint64_t{0}));
    seeds.push_back(
        t.segment({t.channel("t", t.daqmx_index(2, {{0xFFFFFFFF, 0, 0, 0}}, {18}, 0x1269, 0x44)),
                   t.channel("a", t.daqmx_index(2, {{3, 0, 16, 0}}, {18}, 0x1269, 2))},
                  t.time(3600000000) + t.number(std::int16_t{1}) + t.time(3600000001) +
                      t.number(std::int16_t{2})));
    const auto changing = [&t](std::string_view unit, std::int64_t seconds, double slope) {
      return t.segment({t.channel("F", t.index(2, 2),
                                  {t.property("unit_string", unit), t.property("wf_increment", 0.5),
                                   t.raw_property("wf_start_time", 0x44, t.time(seconds)),
                                   t.property("NI_Scale[0]_Scale_Type", "Linear"),
                                   t.property("NI_Scale[0]_Linear_Slope", slope),
                                   t.property("NI_Scale[0]_Linear_Y_Intercept", 0.0)})},
                       t.numbers(std::vector<std::int16_t>{1, 2}));
    };
    seeds.push_back(changing("N", 3600000000, 2.0) + changing("N", 3600000001, 2.0) +
                    changing("kN", 3600000009, 2.0) + changing("kN", 3600000010, 3.0));
    seeds.push_back(t.segment({t.channel("s", t.text_index(1, 6)), t.channel("a", t.index(2, 4))},
                              t.number(std::uint32_t{2}) + "ab" + t.numbers(shorts)));
  }
  return seeds;
}

}  // namespace impactrig::acquisition::tests

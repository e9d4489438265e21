// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "acquisition/exporters/formats.hpp"
#include "acquisition/exporters/not_kept.hpp"
#include "acquisition/exporters/output_file.hpp"
#include "acquisition/importers/number.hpp"
#include "acquisition/importers/time_axis.hpp"
#include "acquisition/uff58_codes.hpp"
#include "datasets/input_error.hpp"

namespace impactrig::acquisition {

using datasets::Channel;
using datasets::FileError;
using datasets::Record;

namespace {

std::string attribute(const Channel& channel, const std::string& key) {
  const auto found = channel.attributes.find(key);
  return found == channel.attributes.end() ? std::string() : found->second;
}

double number_attribute(const Channel& channel, const std::string& key) {
  return number_in(attribute(channel, key)).value_or(0.0);
}

/// Text for a field, "NONE" where there is none, without blanks around it: four of them before a -1
/// would close the dataset. What does not fit is refused, not cut.
std::string field(const std::string& path, std::string_view what, std::string_view whole,
                  std::size_t width) {
  const std::string text(trimmed(whole));
  if (text.empty()) return "NONE";
  if (text.size() > width)
    throw FileError(
        path, fmt::format("{} '{}' is longer than the {} bytes that dataset 58 has for it", what,
                          text, width));
  if (text.find_first_of("\r\n") != std::string::npos)
    throw FileError(path, fmt::format("{} '{}' has a line break", what, text));
  return text;
}

/// "FS (full scale = 1.0)": where such a unit does not fit, what is in the parentheses comes off.
struct UnitText {
  std::string unit, comment;
};

UnitText unit_text(const std::string& unit, std::size_t width) {
  const std::size_t open = unit.rfind(" (");
  if (unit.size() <= width || open == std::string::npos || open == 0 || !unit.ends_with(')'))
    return {unit, {}};
  return {unit.substr(0, open), unit.substr(open + 2, unit.size() - open - 3)};
}

/// A label, and a name, may lose its end: at most `width` bytes of it, cut between characters.
std::string label(std::string text, std::size_t width) {
  if (text.size() > width) {
    std::size_t end = width;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    text.resize(end);
  }
  return text.empty() ? "NONE" : text;
}

/// The shape of a channel in dataset 58.
struct Form {
  bool over_time = true;
  bool even = true;
  double start = 0.0;
  double increment = 0.0;
};

Form form_of(const OutgoingChannel& outgoing) {
  const Channel& channel = *outgoing.head;
  Form form;
  const std::string domain = attribute(channel, "domain");
  form.over_time = domain.empty() || domain == "time";
  form.even = outgoing.uniform;
  form.start = form.over_time ? channel.clock.start : number_attribute(channel, "abscissa first");
  form.increment =
      form.over_time ? channel.clock.interval : number_attribute(channel, "abscissa increment");
  return form;
}

/// True when E13.5 gives the number back.
bool survives(double value) {
  return number_in(fmt::format("{:13.5E}", value)) == value;
}

/// "m/s^2" of a frequency response in "(m/s^2)/(N)", which has "N" for its denominator.
std::string ordinate_unit(const Channel& channel) {
  const std::string below = fmt::format(")/({})", attribute(channel, "denominator unit"));
  const std::string& unit = channel.unit;
  if (!unit.starts_with('(') || !unit.ends_with(below)) return unit;
  return unit.substr(1, unit.size() - 1 - below.size());
}

void print_header(OutputFile& out, const std::string& path, const Record& record,
                  const OutgoingChannel& outgoing, const Form& form) {
  const Channel& channel = *outgoing.head;
  const auto id = [&](int line) {
    return field(path, fmt::format("id line {}", line),
                 attribute(channel, fmt::format("id line {}", line)), 80);
  };
  const bool exact =
      !form.even || !form.over_time || (survives(form.start) && survives(form.increment));
  // reading back tells of a name that is cut
  const std::string called = label(std::string(trimmed(channel.name)), 80);
  out.print("{}\n{}\n", field(path, "the name", called, 80), id(2));
  out.print("{}\n{}\n", field(path, "the date", uff_date(record.started), 80), id(4));
  const bool stale = attribute(channel, "id line 5").starts_with("clock: ");
  out.print("{}\n", !exact ? uff58_exact_clock(channel.clock) : stale ? "NONE" : id(5));
  const auto integer = [&channel](const std::string& key) {
    return integer_in(attribute(channel, key)).value_or(0);
  };
  out.print("{:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n",
            form.over_time ? 1 : uff58_function(attribute(channel, "function")), 0, 0, 0,
            label(attribute(channel, "response entity"), 10), integer("response node"),
            integer("response direction"), label(attribute(channel, "reference entity"), 10),
            integer("reference node"), integer("reference direction"));
  out.print("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", outgoing.complex ? 6 : 4, outgoing.size,
            form.even ? 1 : 0, form.even ? form.start : 0.0, form.even ? form.increment : 0.0, 0.0);
  const auto axis = [&out](int type, const std::string& name, const std::string& unit) {
    out.print("{:10}{:5}{:5}{:5} {:<20} {:<20}\n", type, 0, 0, 0, name, unit);
  };
  if (form.over_time) {
    axis(17, "Time", "s");
  } else {
    axis(attribute(channel, "domain") == "frequency" ? 18 : 1,
         label(attribute(channel, "abscissa label"), 20),
         field(path, "the abscissa's unit", attribute(channel, "abscissa unit"), 20));
  }
  const UnitText unit = unit_text(ordinate_unit(channel), 20);
  std::string ordinate = attribute(channel, "ordinate label");
  if (ordinate.empty()) ordinate = unit.comment;
  if (ordinate.empty()) ordinate = datasets::name(channel.quantity);
  axis(uff58_type(channel.quantity), label(ordinate, 20), field(path, "the unit", unit.unit, 20));
  axis(0, "NONE",
       field(path, "the denominator's unit", attribute(channel, "denominator unit"), 20));
  axis(0, "NONE", "NONE");
}

std::string little_endian(double value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) bytes.assign(bytes.rbegin(), bytes.rend());
  return bytes;
}

void write_binary(OutputFile& out, const OutgoingChannel& channel, const Form& form) {
  std::string block;
  channel.each([&](const Channel& part, std::uint64_t) {
    block.clear();
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (!form.even) block += little_endian(part.clock.times[i]);
      block += little_endian(part.value(i));
      if (channel.complex) block += little_endian(part.imaginary[i]);
    }
    out.write(block);
  });
}

void print_text(OutputFile& out, const std::string& path, const OutgoingChannel& channel) {
  std::size_t in_line = 0;
  const auto put = [&](double value, std::uint64_t i) {
    if (!std::isfinite(value))
      throw FileError(
          path,
          fmt::format(
              "sample {} of '{}' is not finite, which dataset 58 cannot hold as text: write a "
              ".uff file (58b)",
              i, channel.head->name));
    out.print("{:20.12E}", value);
    if (++in_line == 4) {
      out.print("\n");
      in_line = 0;
    }
  };
  channel.each([&](const Channel& part, std::uint64_t first) {
    for (std::size_t i = 0; i < part.size(); ++i) {
      put(part.value(i), first + i);
      if (channel.complex) put(part.imaginary[i], first + i);
    }
  });
  if (in_line > 0) out.print("\n");
}

std::vector<std::string> write_uff(const OutgoingRecording& recording, const std::string& path,
                                   bool binary) {
  if (recording.channels.empty()) throw FileError(path, "the recording has no channels to write");
  OutputFile out(path);
  for (const OutgoingChannel& channel : recording.channels) {
    const Form form = form_of(channel);
    if (!form.even && !binary)
      throw FileError(
          path,
          fmt::format(
              "the samples of '{}' are not evenly spaced, and dataset 58 holds times as text with "
              "six digits only: write a .uff file (58b)",
              channel.head->name));
    const std::size_t numbers = (form.even ? 1U : 2U) + (channel.complex ? 1U : 0U);
    out.print("    -1\n    58");
    if (binary) {
      out.print("b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}", 1, 2, 11,
                channel.size * numbers * sizeof(double), 0, 0, 0, 0);
    }
    out.print("\n");
    print_header(out, path, recording.record, channel, form);
    if (binary) {
      write_binary(out, channel, form);
    } else {
      print_text(out, path, channel);
    }
    out.print("    -1\n");
  }
  out.finish();
  std::vector<std::string> warnings;
  for (const OutgoingChannel& channel : recording.channels)
    tell_of_marks(channel, "a universal file", warnings);
  tell_of_calibrations(recording.record, "a universal file", warnings);
  tell_of_filters(recording.record, "a universal file", warnings);
  return warnings;
}

}  // namespace

std::vector<std::string> write_uff58b(const OutgoingRecording& recording, const std::string& path) {
  return write_uff(recording, path, true);
}

std::vector<std::string> write_uff58(const OutgoingRecording& recording, const std::string& path) {
  return write_uff(recording, path, false);
}

}  // namespace impactrig::acquisition

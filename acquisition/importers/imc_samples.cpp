// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/imc_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquisition/importers/header_fields.hpp"

namespace impactrig::acquisition {

using datasets::Record;

namespace {

std::optional<NumberKind> kind_of(int format) {
  switch (format) {
    case 1:
      return NumberKind::u8;
    case 2:
      return NumberKind::i8;
    case 3:
      return NumberKind::u16;
    case 4:
      return NumberKind::i16;
    case 5:
      return NumberKind::u32;
    case 6:
      return NumberKind::i32;
    case 7:
      return NumberKind::f32;
    case 8:
      return NumberKind::f64;
    case 12:
      return NumberKind::u64;
    case 14:
      return NumberKind::i64;
    default:
      return std::nullopt;
  }
}

/// Bytes from one group of numbers to the next.
std::uint64_t stride_of(const ImcComponent& one, std::uint64_t width) {
  return width * one.count + one.distance;
}

}  // namespace

std::optional<NumberKind> imc_kind(const ImcComponent& one) {
  return one.digital ? NumberKind::u16 : kind_of(one.number_format);
}

std::uint64_t ImcSamples::filled_of(const ImcBuffer& buffer) const {
  if (contents_.closed || buffer.filled > 0) return std::min(buffer.filled, buffer.bytes);
  const std::uint64_t there = buffer.samples_bytes - std::min(buffer.samples_bytes, buffer.offset);
  return buffer.bytes > 0 ? std::min(buffer.bytes, there) : there;
}

std::uint64_t ImcSamples::announced_in(const ImcComponent& one, const ImcBuffer& buffer,
                                       std::uint64_t width) const {
  const std::uint64_t filled = filled_of(buffer);
  return filled < one.offset + width ? 0
                                     : (filled - one.offset - width) / stride_of(one, width) + 1;
}

ImcRuns ImcSamples::runs_of(const ImcComponent& one, const ImcBuffer& buffer, NumberKind kind,
                            std::uint64_t width, std::uint64_t within, const std::string& name) {
  ImcRuns runs;
  if (!buffer.samples_at) return runs;
  const std::uint64_t filled = filled_of(buffer);
  const std::uint64_t stride = stride_of(one, width);
  const std::uint64_t size = std::max(buffer.bytes, filled);
  const std::uint64_t available =
      buffer.samples_bytes - std::min(buffer.samples_bytes, buffer.offset);
  std::uint64_t there = 0;
  const auto add = [&](std::uint64_t from, std::uint64_t bytes) {
    // whole numbers of [from, from + bytes) of the buffer
    const std::uint64_t left = std::min(bytes, available - std::min(available, from));
    const std::uint64_t skipped = one.offset + within;
    if (left < skipped + size_of(kind)) return;
    const std::uint64_t count = (left - skipped - size_of(kind)) / stride + 1;
    runs.push_back({*buffer.samples_at + buffer.offset + from + skipped, count, stride});
    there += count;
  };
  // a ring begins anywhere
  if (buffer.first < size && filled > size - buffer.first) {
    add(buffer.first, size - buffer.first);
    add(0, filled - (size - buffer.first));
  } else {
    add(buffer.first, filled);
  }
  if (within > 0) return runs;
  const std::uint64_t announced = announced_in(one, buffer, width);
  if (there < announced) warnings_.push_back(cut_off(name, there, announced));
  if (!contents_.closed && buffer.filled == 0 && there > 0)
    warnings_.push_back(
        fmt::format("'{}': the file, which was not closed, states that no samples are filled: "
                    "all {} that are there are read",
                    name, there));
  return runs;
}

StoredNumbers ImcSamples::numbers_in(const ImcRuns& runs, NumberKind kind, std::uint64_t first,
                                     std::uint64_t count) const {
  StoredNumbers numbers(kind, contents_.big_endian);
  for (const NumberRun& run : runs) {
    const std::uint64_t skipped = std::min(first, run.count);
    const std::uint64_t taken = std::min(count, run.count - skipped);
    first -= skipped;
    count -= taken;
    if (taken > 0) numbers.add({run.offset + skipped * run.stride, taken, run.stride});
  }
  return numbers;
}

std::vector<std::vector<ImcBuffer>> ImcSamples::joined_buffers(const ImcComponent& one,
                                                               std::uint64_t width) const {
  std::vector<std::vector<ImcBuffer>> parts;
  std::uint64_t samples = 0;  // of the last part
  for (const ImcBuffer& buffer : one.buffers) {
    bool goes_on =
        !parts.empty() && !buffer.new_event && buffer.samples_at && parts.back().front().samples_at;
    if (goes_on) {
      const ImcBuffer& first = parts.back().front();
      const double expected = first.start + one.abscissa.interval * static_cast<double>(samples);
      goes_on = buffer.add_time == first.add_time &&
                (buffer.start == 0.0 ||
                 std::abs(buffer.start - expected) <= 0.5 * std::abs(one.abscissa.interval));
    }
    if (!goes_on) {
      parts.emplace_back();
      samples = 0;
    }
    parts.back().push_back(buffer);
    samples += announced_in(one, buffer, width);
  }
  return parts;
}

ImcRuns ImcSamples::runs_of(const ImcComponent& one, const std::vector<ImcBuffer>& buffers,
                            NumberKind kind, const std::string& name) {
  ImcRuns runs;
  for (const ImcBuffer& buffer : buffers) {
    const ImcRuns more = runs_of(one, buffer, kind, size_of(kind), 0, name);
    runs.insert(runs.end(), more.begin(), more.end());
  }
  return runs;
}

std::vector<double> ImcSamples::values_of(const ImcComponent& one) {
  Record record;
  std::vector<StoredChannel> parts;
  const ImcBuffer& buffer = one.buffers.front();
  const bool split = one.number_format == imc_six_bytes;
  const NumberKind kind = split ? NumberKind::u32 : *imc_kind(one);
  const std::uint64_t low = split && contents_.big_endian ? 2 : 0;
  const auto numbers = [&](NumberKind of, std::uint64_t within) {
    return numbers_in(runs_of(one, buffer, of, split ? 6 : size_of(of), within, one.name), of);
  };
  parts.push_back({numbers(kind, low)});
  if (split) parts.push_back({numbers(NumberKind::u16, contents_.big_endian ? 0 : 4)});
  record.channels.resize(parts.size());
  const auto reader = reader_of_numbers(std::make_unique<MappedFile>(file_.path()),
                                        std::move(record), std::move(parts));
  const Record read = read_into_memory(*reader);
  std::vector<double> values = read.channels.front().values();
  if (split) {
    const std::vector<double> high = read.channels.back().values();
    values.resize(std::min(values.size(), high.size()));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0x1p32 * high[i];
  }
  for (double& value : values) value = one.factor * value + one.shift;
  return values;
}

}  // namespace impactrig::acquisition

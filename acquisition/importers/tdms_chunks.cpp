// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/importers/tdms_chunks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace impactrig::acquisition {

void TdmsChunks::start_list(std::uint64_t at) {
  spend(list_.size(), at);
  for (const std::size_t i : list_) objects_[i].listed = objects_[i].has_data = false;
  list_.clear();
  changed_ = true;
}

void TdmsChunks::list(std::size_t which) {
  if (objects_[which].listed) return;
  objects_[which].listed = true;
  list_.push_back(which);
}

/// Counts steps that a file of few bytes could ask for again and again.
void TdmsChunks::spend(std::uint64_t steps, std::uint64_t at) {
  steps_ += steps;
  if (steps_ > 10000000 + 64 * std::uint64_t{file_.bytes().size()})
    fail_in_tdms(file_, at,
                 "the list of channels changes in so many segments that reading it would not end");
}

void TdmsChunks::arrange(std::uint64_t at) {
  spend(list_.size(), at);
  active_.clear();
  buffers_.clear();
  chunk_bytes_ = 0;
  std::size_t daqmx = 0;
  for (const std::size_t i : list_) {
    const TdmsObject& object = objects_[i];
    if (!object.has_data || !object.index) continue;
    const TdmsRawIndex& index = *object.index;
    if (index.daqmx) {
      ++daqmx;
      active_.push_back(i);
      add_to_buffers(object, at);
    } else if (index.bytes > 0) {
      active_.push_back(i);
      chunk_bytes_ += index.bytes;
    }
  }
  if (daqmx > 0 && daqmx != active_.size())
    fail_in_tdms(file_, at, "a segment mixes DAQmx raw data with other data");
  daqmx_ = daqmx > 0;
  for (const Buffer& buffer : buffers_) chunk_bytes_ += buffer.rows * buffer.width;
  changed_ = false;
}

void TdmsChunks::add_to_buffers(const TdmsObject& object, std::uint64_t at) {
  const TdmsRawIndex& index = *object.index;
  if (buffers_.empty())
    for (const std::uint32_t width : index.widths) buffers_.push_back({0, width});
  spend(index.widths.size(), at);
  const bool alike = std::ranges::equal(index.widths, buffers_, {}, {}, &Buffer::width);
  if (!alike)
    fail_in_tdms(
        file_, at,
        fmt::format("{} states rows of {} bytes in the DAQmx raw data, the channels before it {}",
                    object.path, widths_text(index.widths), widths_text(buffers_)));
  for (const TdmsScaler& scaler : index.scalers) {
    Buffer& buffer = buffers_[scaler.buffer];
    if (buffer.rows != 0 && buffer.rows != index.count)
      fail_in_tdms(file_, at,
                   fmt::format("{} states {} rows in a DAQmx raw buffer, the channels before it {}",
                               object.path, index.count, buffer.rows));
    buffer.rows = index.count;
  }
}

std::string TdmsChunks::place(bool big_endian, bool interleaved, std::uint64_t data,
                              std::uint64_t total, bool cut) {
  if (changed_) arrange(data);
  big_endian_ = big_endian;
  if (chunk_bytes_ == 0) {
    return fmt::format("{} bytes of raw data from byte {} on belong to no channel", total, data);
  }
  const std::uint64_t chunks = total / chunk_bytes_;
  const std::uint64_t rest = total % chunk_bytes_;
  if (rest > 0) spend(active_.size(), data);
  if (daqmx_) {
    place_buffers(data, chunks, buffers_);
    if (rest > 0) place_buffers(data + chunks * chunk_bytes_, 1, buffers_within(rest));
  } else if (interleaved && !only_texts()) {
    place_rows(data, total);
  } else {
    place_blocks(data, chunks);
    if (rest > 0) place_part(data + chunks * chunk_bytes_, rest, cut);
  }
  if (rest == 0 || cut) return {};
  return fmt::format(
      "the {} bytes of raw data from byte {} on are no whole number of chunks of {} "
      "bytes: the last one is read in part",
      total, data, chunk_bytes_);
}

bool TdmsChunks::only_texts() const {
  return active_.size() == 1 && objects_[active_.front()].index->type->role == TdmsRole::text;
}

void TdmsChunks::place_blocks(std::uint64_t data, std::uint64_t chunks) {
  if (chunks == 0) return;
  const bool alone = active_.size() == 1;
  for (const std::size_t i : active_) {
    const TdmsRawIndex& index = *objects_[i].index;
    if (alone && index.type->role != TdmsRole::text)
      add(objects_[i], data, index.count * chunks, 1);
    else
      add(objects_[i], data, index.count, chunks);
    data += index.bytes;
  }
}

void TdmsChunks::place_part(std::uint64_t data, std::uint64_t rest, bool cut) {
  const std::uint64_t end = data + rest;
  for (const std::size_t i : active_) {
    const TdmsRawIndex& index = *objects_[i].index;
    if (index.type->role == TdmsRole::text) {
      if (end - data < index.bytes) return;
      add(objects_[i], data, index.count, 1);
      data += index.bytes;
      continue;
    }
    const auto share = static_cast<std::uint64_t>(static_cast<long double>(index.count) *
                                                  static_cast<long double>(rest) /
                                                  static_cast<long double>(chunk_bytes_));
    const std::uint64_t there = (end - data) / index.type->size;
    const std::uint64_t count = std::min({cut ? index.count : share, index.count, there});
    if (count > 0) add(objects_[i], data, count, 1);
    data += count * index.type->size;
    if (cut && count < index.count) return;
  }
}

void TdmsChunks::place_rows(std::uint64_t data, std::uint64_t total) {
  std::uint64_t width = 0;
  const std::uint64_t count = objects_[active_.front()].index->count;
  for (const std::size_t i : active_) {
    const TdmsObject& object = objects_[i];
    if (object.index->type->role == TdmsRole::text)
      fail_in_tdms(file_, data, fmt::format("{} has texts among interleaved data", object.path));
    if (object.index->count != count)
      fail_in_tdms(
          file_, data,
          fmt::format("{} has {} values in a chunk of interleaved data, the channels before "
                      "it {}",
                      object.path, object.index->count, count));
    width += object.index->type->size;
  }
  const std::uint64_t rows = total / width;
  if (rows == 0) return;
  for (const std::size_t i : active_) {
    add(objects_[i], data, rows, 1, width);
    data += objects_[i].index->type->size;
  }
}

std::vector<TdmsChunks::Buffer> TdmsChunks::buffers_within(std::uint64_t rest) const {
  std::vector<Buffer> there;
  for (Buffer buffer : buffers_) {
    if (buffer.width > 0) buffer.rows = std::min(buffer.rows, rest / buffer.width);
    rest -= buffer.rows * buffer.width;
    there.push_back(buffer);
    if (buffer.rows < buffers_[there.size() - 1].rows) rest = 0;
  }
  return there;
}

void TdmsChunks::place_buffers(std::uint64_t data, std::uint64_t chunks,
                               const std::vector<Buffer>& buffers) {
  if (chunks == 0) return;
  std::vector<std::uint64_t> begins;
  for (std::uint64_t at = data; const Buffer& buffer : buffers) {
    begins.push_back(at);
    at += buffer.rows * buffer.width;
  }
  for (const std::size_t i : active_) {
    TdmsObject& object = objects_[i];
    for (const TdmsScaler& scaler : object.index->scalers) {
      const Buffer& buffer = buffers[scaler.buffer];
      if (buffer.rows == 0) continue;
      if (object.index->type != nullptr) {  // time stamps
        add(object, begins[scaler.buffer] + scaler.offset, buffer.rows, chunks, buffer.width);
        continue;
      }
      TdmsSource& source = source_of(object, scaler.id, scaler.kind, scaler.bit, data);
      NumberRun run{begins[scaler.buffer] + scaler.offset, buffer.rows, buffer.width, chunks,
                    chunk_bytes_};
      if (buffers.size() == 1 || chunks == 1) {  // the rows of all chunks follow each other
        run.count *= chunks;
        run.repeats = 1;
      }
      run.other_order = source.numbers.big_endian() != big_endian_;
      source.numbers.add(run);
    }
  }
}

TdmsSource& TdmsChunks::source_of(TdmsObject& object, std::uint32_t id, NumberKind kind, int bit,
                                  std::uint64_t at) {
  for (TdmsSource& source : object.sources) {
    const bool raw = source.id == TdmsScaling::raw_data;
    if (raw != (id == TdmsScaling::raw_data))
      fail_in_tdms(file_, at, fmt::format("the type of {} changes within the file", object.path));
    if (source.id != id) continue;
    if (source.numbers.kind() != kind || source.bit != bit)
      fail_in_tdms(file_, at, fmt::format("the type of {} changes within the file", object.path));
    return source;
  }
  if (object.sources.size() == 64)
    fail_in_tdms(file_, at, fmt::format("{} has more than 64 DAQmx scalers", object.path));
  object.sources.push_back({id, bit, StoredNumbers(kind, big_endian_)});
  return object.sources.back();
}

void TdmsChunks::add(TdmsObject& object, std::uint64_t at, std::uint64_t count,
                     std::uint64_t chunks, std::uint64_t stride) {
  const TdmsType& type = *object.index->type;
  if (object.type != nullptr && object.type != &type)
    fail_in_tdms(file_, at,
                 fmt::format("the type of {} changes within the file, from {} to {}", object.path,
                             object.type->name, type.name));
  object.type = &type;
  if (type.role == TdmsRole::text) {
    object.texts += count * chunks;
    return;
  }
  if (stride == 0) stride = type.size;
  TdmsSource& source = source_of(object, TdmsScaling::raw_data, type.kind, -1, at);
  NumberRun run{at, count, stride, chunks, chunk_bytes_};
  run.other_order = source.numbers.big_endian() != big_endian_;
  if (type.role == TdmsRole::time) {
    if (run.other_order)
      fail_in_tdms(
          file_, at,
          fmt::format("the byte order of the time stamps {} changes within the file", object.path));
    if (source.numbers.size() == 0) object.first_value = at;
    object.last_value = at + (count - 1) * stride + (chunks - 1) * chunk_bytes_;
    run.offset += 4;  // the middle of 16 bytes: see tdms_recording.cpp
  }
  source.numbers.add(run);
  if (type.role == TdmsRole::complex) {
    run.offset += type.size / 2;
    if (source.imaginary.size() == 0)
      source.imaginary = StoredNumbers(type.kind, source.numbers.big_endian());
    source.imaginary.add(run);
  }
}

std::string TdmsChunks::widths_text(const std::vector<std::uint32_t>& widths) {
  return fmt::format("{}", fmt::join(widths, " + "));
}

std::string TdmsChunks::widths_text(const std::vector<Buffer>& buffers) {
  std::vector<std::uint32_t> widths;
  for (const Buffer& buffer : buffers) widths.push_back(static_cast<std::uint32_t>(buffer.width));
  return widths_text(widths);
}

}  // namespace impactrig::acquisition

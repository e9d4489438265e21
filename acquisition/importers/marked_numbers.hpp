// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "acquisition/recording_reader.hpp"

namespace impactrig::acquisition {

/// Marks as not valid, while they are handed over, numbers by which a format says that there is no
/// sample. Rule:
///
///     bool is_none(std::size_t channel, double stored) const;  // `channel` of the head
///     std::string warning(const std::string& name, std::uint64_t found,
///                         std::uint64_t samples) const;
template <typename Rule>
class MarkedNumbers final : public RecordingReader {
 public:
  MarkedNumbers(std::unique_ptr<RecordingReader> numbers, Rule rule)
      : numbers_(std::move(numbers)),
        rule_(std::move(rule)) {}

  const RecordingHead& head() const override { return numbers_->head(); }

  datasets::Record read(const Selection& wanted, SampleSink& sink) override {
    Marks marks(rule_, selected_channels(head(), wanted), sink);
    datasets::Record record = numbers_->read(wanted, marks);
    marks.tell(record);
    return record;
  }

 private:
  class Marks final : public SampleSink {
   public:
    Marks(const Rule& rule, std::vector<std::size_t> chosen, SampleSink& next)
        : rule_(rule),
          chosen_(std::move(chosen)),
          found_(chosen_.size()),
          samples_(chosen_.size()),
          next_(next) {}

    void take_times(std::size_t index, std::span<const double> times) override {
      next_.take_times(index, times);
    }

    void take(std::size_t index, const SampleBlock& block) override {
      valid_.assign(block.size(), 1);
      std::uint64_t found = 0;
      std::visit(
          [&](auto stored) {
            for (std::size_t i = 0; i < stored.size(); ++i) {
              if (!rule_.is_none(chosen_[index], static_cast<double>(stored[i]))) continue;
              valid_[i] = 0;
              ++found;
            }
          },
          block.raw);
      SampleBlock marked = block;
      if (found > 0) marked.valid = valid_;
      found_[index] += found;
      samples_[index] += block.size();
      next_.take(index, marked);
    }

    void tell(datasets::Record& record) const {
      for (std::size_t i = 0; i < chosen_.size(); ++i)
        if (found_[i] > 0)
          record.warnings.push_back(rule_.warning(record.channels[i].name, found_[i], samples_[i]));
    }

   private:
    const Rule& rule_;
    std::vector<std::size_t> chosen_;
    std::vector<std::uint64_t> found_, samples_;
    SampleSink& next_;
    std::vector<std::uint8_t> valid_;
  };

  std::unique_ptr<RecordingReader> numbers_;
  Rule rule_;
};

}  // namespace impactrig::acquisition

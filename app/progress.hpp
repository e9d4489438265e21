// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace impactrig::app {

/// A line on stderr that says how far a long job is, five times a second; nothing where stderr is
/// no terminal, and nothing in the first half second.
class Progress {
 public:
  /// `total` in the unit of add(); what is shown is a share of it.
  Progress(std::string what, std::uint64_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void add(std::uint64_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string what_;
  std::uint64_t total_;
  std::uint64_t done_ = 0;
  bool shown_ = false;
  bool wanted_;
  Clock::time_point begun_ = Clock::now();
  Clock::time_point next_ = begun_ + std::chrono::milliseconds(500);
};

}  // namespace impactrig::app

// SPDX-License-Identifier: BSD-3-Clause
#include "app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace impactrig::app {

Progress::Progress(std::string what, std::uint64_t total, bool quiet)
    : what_(std::move(what)),
      total_(std::max<std::uint64_t>(total, 1)),
      wanted_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (shown_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::add(std::uint64_t done) {
  done_ += done;
  if (!wanted_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  shown_ = true;
  // a total that was estimated may be passed
  const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
  const double spent = std::chrono::duration<double>(now - begun_).count();
  constexpr int width = 30;
  const int full = static_cast<int>(share * width);
  fmt::print(stderr, "\r{} [{:=<{}}{:{}}] {:3.0f} %, {:.0f} s left \x1b[K", what_, "", full, "",
             width - full, 100.0 * share, share > 0.0 ? spent * (1.0 - share) / share : 0.0);
  std::fflush(stderr);
}

}  // namespace impactrig::app

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>

#include "acquisition/conditioning/background.hpp"
#include "acquisition/conditioning/trace.hpp"

namespace impactrig::acquisition {

/// The floor of a noise estimate: a digitiser whose noise is below its step shows none, and then
/// reaches 4.5 steps less than once in 10⁶ samples.
inline double noise_above_step(double sigma, double grain) {
  return std::max(sigma, 0.75 * grain);
}

/// What is known of a pulse before its baseline is.
struct Pulse {
  double height = 0.0;     ///< above the level
  std::size_t top = 0;     ///< sample
  std::size_t length = 0;  ///< samples
};

/// What the signal would do without the contact.
struct Baseline {
  QuietFit fit{};
  bool steady = false;  ///< the whole window before touch could be used
  bool line = false;    ///< fit, else constant
  double constant = 0.0;
  double sigma = 0.0;     ///< scatter about it
  std::size_t until = 0;  ///< sample from which on a line is level

  double at(std::size_t i) const {
    return line ? fit.at(static_cast<double>(std::min(i, until))) : constant;
  }
};

/// Tells the baseline of a pulse by the signal before it.
class BaselineSearch {
 public:
  /// `grain`: grain_of() the trace; `window` [samples]: most of what tells the level.
  BaselineSearch(const Trace& trace, double grain, std::size_t window)
      : trace_(trace),
        grain_(grain),
        window_(window) {}

  /// The course before sample `end`, from at most a window before it, and nothing before `floor`.
  /// Where it is not steady (the foot of the pulse, the ringing of the impact before), what is
  /// further from the pulse counts. A line goes on behind the top for as long as it was seen. None
  /// of fewer than 8 samples, or where the foot takes all of them.
  std::optional<Baseline> before(std::size_t end, std::size_t floor, const Pulse& pulse) const;

 private:
  QuietFit course(std::size_t begin, std::size_t end, int degree) const;
  double sound_share(const QuietFit& fit) const;
  double trend_scatter(const QuietFit& fit) const;
  bool scatters_alike(const QuietFit& fit, const QuietFit& nearest) const;
  std::optional<QuietFit> sloping(const QuietFit& fit) const;
  std::optional<QuietFit> line_below(std::size_t end, std::size_t floor, std::size_t length,
                                     const QuietFit& nearest) const;

  const Trace& trace_;
  double grain_;
  std::size_t window_;
};

}  // namespace impactrig::acquisition

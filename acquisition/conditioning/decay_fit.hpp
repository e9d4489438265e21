// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// c + a exp(-t/T), t from the first of the quiet samples.
struct Decay {
  double constant = 0.0, amplitude = 0.0;  ///< [the channel's unit]
  double time = 0.0;                       ///< T [s]
  double origin = 0.0;                     ///< of t [s]
  double hum = 0.0;                        ///< the fundamental fitted beside it [Hz]; 0: none

  /// At a time of the channel's clock; before the origin, where it is not known, 0.
  double at(double time) const;
};

/// What a fitted decay is uncertain by: standard errors, infinite where the data do not tell.
struct DecayErrors {
  double of_constant = 0.0, of_amplitude = 0.0;  ///< [the channel's unit]
  double of_time = 0.0;                          ///< [s]; 0 where T was stated
  double at_most = 0.0;  ///< of the decay, from its origin to the last sample
  /// Of that the part by which another course fits the quiet samples clearly better: with another T
  /// where one was stated, else with a second, faster decay; 0 where none does.
  double misfit = 0.0;
};

struct FittedDecay {
  Decay decay;
  DecayErrors errors;
};

/// Fits by least squares over the sound samples of `wanted.quiet`, not empty; T as stated or where
/// the sum of squares is least, between a hundredth of the time they span and 30 times it.
///
/// `hum`: the mains is in the channel too, as remove_hum() takes it for. Where the quiet samples
/// span a period of it, a sinusoid and its multiples are fitted with the decay, at the stated
/// frequency first and then at the one that is found in what the decay leaves; their errors are in
/// the decay's.
///
/// Throws std::invalid_argument when fewer than 16 samples are quiet or T is not positive.
FittedDecay fit_decay(const datasets::Channel& channel, const datasets::RemoveDecay& wanted,
                      const datasets::RemoveHum* hum);

}  // namespace impactrig::acquisition

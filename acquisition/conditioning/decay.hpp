// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "datasets/conditioning.hpp"
#include "datasets/record.hpp"

namespace impactrig::acquisition {

/// Takes c + a exp(-(t - t₀)/T) off the channel from t₀ on: a charge amplifier on its way back to
/// zero after an overload or a reset. What lies before t₀ stays: when the decay began, and what it
/// was then, is not in the data. c, a and T as fit_decay() has them, t₀ the first quiet sample.
/// `hum`: the mains hum that the channel has too, and that stays.
///
/// The edit holds c, a and T with the standard uncertainty of T, which takes the residuals'
/// autocorrelation into account. Throws std::invalid_argument when fewer than 16 samples are quiet,
/// or T is to come from the data and is uncertain by more than half of itself: then a line
/// (remove_drift) says all that is there.
datasets::Edit remove_decay(datasets::Channel& channel, const datasets::RemoveDecay& decay,
                            const datasets::RemoveHum* hum = nullptr);

/// Undoes a first-order high-pass of 3 dB frequency f: x = y + 2 pi f ∫ y dt from the first sample
/// on, by the trapezoidal rule, after the mean over the quiet stretch has been taken off. An error
/// b of that mean grows to b (1 + 2 pi f t) after t; what is not valid is bridged by lines, of
/// which the stated uncertainty holds what they may miss. Throws std::invalid_argument when f is
/// not positive or fewer than 3 samples are quiet.
datasets::Edit undo_low_cut(datasets::Channel& channel, const datasets::UndoLowCut& low_cut);

}  // namespace impactrig::acquisition

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit.hpp"

namespace impactrig::fitting {

/// Of one of the fit's channels, from its curves, the impacts' digitiser steps and the phases of
/// the predictions. Of fits whose model is right, at most 5 % have a channel that is called
/// unsound.
ChannelDiagnostics diagnostics_of(const Fit& fit, const ChannelFit& channel);

}  // namespace impactrig::fitting

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fitting/fit.hpp"

namespace impactrig::fitting {

/// Fills ChannelFit::diagnostics of every channel from its curves, the impacts' digitiser steps and
/// the phases of the predictions. Of fits whose model is right, at most 5 % have a channel that is
/// called unsound.
void add_diagnostics(Fit& fit);

}  // namespace impactrig::fitting

// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/fit.hpp"

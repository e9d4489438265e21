// SPDX-License-Identifier: BSD-3-Clause
#include "models/rig.hpp"

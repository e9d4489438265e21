// SPDX-License-Identifier: BSD-3-Clause
#include "fitting/rig_file.hpp"

// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/impact.hpp"

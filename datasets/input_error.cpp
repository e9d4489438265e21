// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/input_error.hpp"

// SPDX-License-Identifier: BSD-3-Clause
#include "acquisition/conditioning/condition.hpp"

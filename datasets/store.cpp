// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/store.hpp"

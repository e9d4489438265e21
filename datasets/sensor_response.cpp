// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/sensor_response.hpp"

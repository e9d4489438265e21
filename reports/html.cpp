// SPDX-License-Identifier: BSD-3-Clause
#include "reports/report_data.hpp"

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "acquisition/importer.hpp"
#include "fitting/fit.hpp"
#include "models/contact/damping/exact.hpp"
#include "reports/report_data.hpp"

int main() {
  const bool formats = !impactrig::acquisition::importers().empty();
  const double d = impactrig::models::exact_damping_factor(0.5);
  return formats && std::abs(impactrig::models::free_rebound_ratio(d) - 0.5) < 1e-12 ? 0 : 1;
}

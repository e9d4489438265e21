// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "reports/report_data.hpp"

namespace impactrig::tests {

/// An INVENTED fit, for the writers of reports only: no instrument has recorded it, nothing has
/// been fitted. A bar of three modes strikes a stop at 0.441 m/s; force (45 kHz resonance, 6 N
/// noise) and velocity (1.5 mm/s noise) of 3000 samples at 1 MHz, eight parameters of which one
/// sits at its bound and one cannot be identified, flags, edits, warnings. The energies, impulses
/// and episodes follow from the motion; parameters, intervals, correlations and chi2 are made up.
/// `recordings` > 1 repeats it at other speeds, each with its own noise (fixed seeds).
reports::ReportData example_report(int recordings = 1);

}  // namespace impactrig::tests

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

/// Curves over two logarithmic axes as a self-contained SVG, for the programs that measure.
namespace impactrig::bench {

struct LogCurve {
  std::string label;
  std::vector<double> x, y;  ///< > 0; others are left out (n)
  std::string colour;
  bool dashed = false;
};

struct LogPlot {
  std::string title;
  std::string x_label, y_label;
  std::vector<LogCurve> curves;
};

/// The plots side by side under one legend; curves of equal label look alike.
std::string log_svg(const std::vector<LogPlot>& plots);

}  // namespace impactrig::bench

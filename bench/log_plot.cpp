// SPDX-License-Identifier: BSD-3-Clause
#include "bench/log_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace impactrig::bench {
namespace {

constexpr double width = 340.0, height = 300.0;  // of a plotted area [px]
constexpr double left = 62.0, right = 18.0, head = 64.0, foot = 48.0;
constexpr const char* ink = "#1d232b";
constexpr const char* grid = "#e3e6ea";

struct LogAxis {
  int low = 1000, high = -1000;  // powers of ten

  void hold(double value) {
    low = std::min(low, static_cast<int>(std::floor(std::log10(value))));
    high = std::max(high, static_cast<int>(std::ceil(std::log10(value))));
  }

  /// Of a value in [0, 1].
  double at(double value) const { return (std::log10(value) - low) / std::max(high - low, 1); }
};

std::string text(double x, double y, const char* anchor, const std::string& content,
                 const char* extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, extra, content);
}

std::string line(const LogCurve& curve, const LogAxis& x, const LogAxis& y, double from) {
  std::string points, dots;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    if (!(curve.x[i] > 0.0 && curve.y[i] > 0.0)) continue;
    const double px = from + width * x.at(curve.x[i]);
    const double py = head + height * (1.0 - y.at(curve.y[i]));
    points += fmt::format("{:.1f},{:.1f} ", px, py);
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.4\" fill=\"{}\"/>\n", px, py,
                        curve.colour);
  }
  return fmt::format(
             "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\"{}/>\n",
             points, curve.colour, curve.dashed ? " stroke-dasharray=\"5 3\"" : "") +
         dots;
}

std::string panel(const LogPlot& plot, double from) {
  LogAxis x, y;
  for (const LogCurve& curve : plot.curves)
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!(curve.x[i] > 0.0 && curve.y[i] > 0.0)) continue;
      x.hold(curve.x[i]);
      y.hold(curve.y[i]);
    }
  if (x.low > x.high) return "";
  std::string svg;
  for (int e = x.low; e <= x.high; ++e) {
    const double at = from + width * x.at(std::pow(10.0, e));
    svg += fmt::format("<path d=\"M{:.1f} {} v{}\" stroke=\"{}\"/>\n", at, head, height, grid);
    svg += text(at, head + height + 18.0, "middle", fmt::format("1e{}", e));
  }
  for (int e = y.low; e <= y.high; ++e) {
    const double at = head + height * (1.0 - y.at(std::pow(10.0, e)));
    svg += fmt::format("<path d=\"M{:.1f} {:.1f} h{}\" stroke=\"{}\"/>\n", from, at, width, grid);
    svg += text(from - 6.0, at + 4.0, "end", fmt::format("1e{}", e));
  }
  svg += text(from, head - 10.0, "start", plot.title, " font-weight=\"600\"");
  svg += text(from + 0.5 * width, head + height + 38.0, "middle", plot.x_label);
  svg += text(0.0, 0.0, "middle", plot.y_label,
              fmt::format(" transform=\"translate({:.1f} {:.1f}) rotate(-90)\"", from - 44.0,
                          head + 0.5 * height)
                  .c_str());
  for (const LogCurve& curve : plot.curves) svg += line(curve, x, y, from);
  return svg;
}

std::vector<LogCurve> all_curves(const std::vector<LogPlot>& plots) {
  std::vector<LogCurve> curves;
  for (const LogPlot& plot : plots)
    curves.insert(curves.end(), plot.curves.begin(), plot.curves.end());
  return curves;
}

std::string legend(const std::vector<LogPlot>& plots, double whole) {
  std::string svg;
  std::set<std::string> shown;
  double x = left, y = 16.0;
  for (const LogCurve& curve : all_curves(plots)) {
    if (!shown.insert(curve.label).second) continue;
    const double entry = 28.0 + 6.6 * static_cast<double>(curve.label.size());
    if (x > left && x + entry > whole) {
      x = left;
      y += 16.0;
    }
    svg += fmt::format("<path d=\"M{:.1f} {:.1f} h22\" stroke=\"{}\" stroke-width=\"2\"{}/>\n", x,
                       y, curve.colour, curve.dashed ? " stroke-dasharray=\"5 3\"" : "");
    svg += text(x + 28.0, y + 4.0, "start", curve.label);
    x += entry + 24.0;
  }
  return svg;
}

}  // namespace

std::string log_svg(const std::vector<LogPlot>& plots) {
  const double whole = (left + width + right) * static_cast<double>(plots.size());
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" "
      "height=\"{1}\" font-family=\"sans-serif\" font-size=\"12\" fill=\"{2}\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
      whole, head + height + foot, ink);
  svg += legend(plots, whole);
  double from = left;
  for (const LogPlot& plot : plots) {
    svg += panel(plot, from);
    from += left + width + right;
  }
  return svg + "</svg>\n";
}

}  // namespace impactrig::bench

// SPDX-License-Identifier: BSD-3-Clause
#include "reports/svg.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "reports/line_tags.hpp"

namespace impactrig::reports {

namespace {

constexpr double margin_left = 58.0, margin_right = 12.0;  // tick labels; half an x label
constexpr double head = 26.0;                              // axis title and legend above a panel
constexpr double foot = 40.0;                              // x labels and title
constexpr double gap = 10.0;                               // between panels
constexpr double heading_height = 20.0;                    // above the first panel's head
constexpr double key_row = 15.5;                           // of the labels at the right
constexpr double tag_radius = 7.0;
constexpr const char* grid_colour = "#e3e6ea";
constexpr const char* label_colour = "#565e69";

/// Maps SI to px.
struct Scale {
  double low, high, from, to;

  double operator()(double value) const {
    return from + (value - low) / (high - low) * (to - from);
  }
};

void widen(std::array<double, 2>& range, double value) {
  if (!std::isfinite(value)) return;
  range[0] = std::min(range[0], value);
  range[1] = std::max(range[1], value);
}

constexpr std::array<double, 2> nothing{std::numeric_limits<double>::infinity(),
                                        -std::numeric_limits<double>::infinity()};

/// A range that can be divided by its width, whatever the data were.
std::array<double, 2> sound(std::array<double, 2> range, double margin) {
  if (!(range[0] <= range[1])) return {0.0, 1.0};
  double width = range[1] - range[0];
  if (width <= 0.0) width = range[0] == 0.0 ? 1.0 : std::abs(range[0]);
  if (range[1] == range[0]) margin = 0.5;
  return {range[0] - margin * width, range[1] + margin * width};
}

std::array<double, 2> x_range(const Figure& figure) {
  if (figure.x.range) return sound(*figure.x.range, 0.0);
  std::array<double, 2> range = nothing;
  for (const Panel& panel : figure.panels)
    for (const Series& series : panel.series)
      for (const double x : series.x) widen(range, x);
  return sound(range, 0.0);
}

std::array<double, 2> y_range(const Panel& panel) {
  if (panel.y.range) return sound(*panel.y.range, 0.0);
  std::array<double, 2> range = nothing;
  for (const Series& series : panel.series)
    for (const double y : series.y) widen(range, y);
  for (const Band& band : panel.bands) {
    widen(range, band.low);
    widen(range, band.high);
  }
  if (panel.zero_line) widen(range, 0.0);
  return sound(range, 0.05);
}

std::string line(double x1, double y1, double x2, double y2, const char* colour, double width) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\" "
      "stroke-width=\"{}\"/>",
      x1, y1, x2, y2, colour, width);
}

std::string text(double x, double y, const char* anchor, const std::string& content,
                 const char* colour = label_colour, const char* extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\"{}>{}</text>",
                     x, y, anchor, colour, extra, escaped(content));
}

std::string rectangle(double x, double y, double width, double height, const char* fill) {
  return fmt::format(
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x, y,
      std::max(0.0, width), std::max(0.0, height), fill);
}

std::string opened(double width, double height, const std::string& title) {
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" "
      "height=\"{:.0f}\" role=\"img\" aria-label=\"{}\" font-family=\"Helvetica Neue, Helvetica, "
      "Arial, sans-serif\" font-size=\"11\">",
      width, height, width, height, escaped(title));
}

/// Estimated width of a label [px]: the page's fonts are not known here. 6 px a character of 11 px
/// type is the average of Arial and its wider kin.
double text_width(const std::string& label) {
  const auto starts = std::count_if(label.begin(), label.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  });
  return 6.2 * static_cast<double>(starts);
}

std::string axis_title(const Axis& axis) {
  return axis.unit.text.empty() ? axis.name : fmt::format("{} [{}]", axis.name, axis.unit.text);
}

/// The samples worth drawing: extremes of each px column where x ascends, else all.
std::vector<std::size_t> drawn(const Series& series, double pixels) {
  const bool ascending = std::is_sorted(series.x.begin(), series.x.end());
  return min_max_indices(series.y, ascending ? static_cast<std::size_t>(pixels) : series.y.size());
}

std::string dash_attribute(const Series& series) {
  return series.dashes.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", series.dashes);
}

std::string path(const Series& series, const Scale& x, const Scale& y) {
  std::string d;
  bool pen_up = true;
  for (const std::size_t i : drawn(series, x.to - x.from)) {
    if (i >= series.x.size()) break;
    if (!std::isfinite(series.x[i]) || !std::isfinite(series.y[i])) {
      pen_up = true;
      continue;
    }
    d += fmt::format("{}{:.1f} {:.1f}", pen_up ? "M" : "L", x(series.x[i]), y(series.y[i]));
    pen_up = false;
  }
  if (d.empty()) return "";
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-opacity=\"{}\" "
      "stroke-linejoin=\"round\"{}/>",
      d, series.colour, series.width, series.opacity, dash_attribute(series));
}

/// A head at sample i that points where the next samples lie, at least 3 px away.
std::string arrow(const Series& series, std::size_t i, const Scale& x, const Scale& y) {
  if (i >= series.x.size()) return "";
  const double x0 = x(series.x[i]), y0 = y(series.y[i]);
  for (std::size_t k = i + 1; k < series.x.size(); ++k) {
    const double dx = x(series.x[k]) - x0, dy = y(series.y[k]) - y0;
    const double length = std::hypot(dx, dy);
    if (length < 3.0) continue;
    const double ux = dx / length, uy = dy / length;
    return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" fill=\"{}\"/>",
                       x0 + 5.5 * ux, y0 + 5.5 * uy, x0 - 4.5 * ux - 4.0 * uy,
                       y0 - 4.5 * uy + 4.0 * ux, x0 - 4.5 * ux + 4.0 * uy, y0 - 4.5 * uy - 4.0 * ux,
                       series.colour);
  }
  return "";
}

/// A piece of the line, 18 px from the origin, at the height of small letters.
std::string swatch(const Series& series) {
  return fmt::format(
      "<line x1=\"0\" y1=\"-4\" x2=\"18\" y2=\"-4\" stroke=\"{}\" stroke-width=\"{}\" "
      "stroke-opacity=\"{}\"{}/>",
      series.colour, std::max(1.4, series.width), series.opacity, dash_attribute(series));
}

std::string disc(const Pixel& at, const Series& series) {
  return fmt::format(
      "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"#ffffff\" stroke=\"{}\"/>{}", at[0],
      at[1], tag_radius, series.colour,
      text(at[0], at[1] + 3.2, "middle", series.tag, palette::ink, " font-size=\"9\""));
}

/// Discs on the lines that have a tag.
std::string tags(const Panel& panel, const Scale& x, const Scale& y) {
  std::vector<const Series*> tagged;
  std::vector<std::vector<Pixel>> lines;
  for (const Series& series : panel.series) {
    if (series.tag.empty()) continue;
    tagged.push_back(&series);
    lines.emplace_back();
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
      if (std::isfinite(series.x[i]) && std::isfinite(series.y[i]))
        lines.back().push_back({x(series.x[i]), y(series.y[i])});
  }
  std::string out;
  const auto places = tag_places(lines, tag_radius);
  for (std::size_t i = 0; i < tagged.size(); ++i)
    if (places[i]) out += disc(*places[i], *tagged[i]);
  return out;
}

/// The labels of a panel below each other, at the right of its plot.
std::string key_column(const Figure& figure, const Panel& panel, double left, double top) {
  constexpr double indent = 2.0 * tag_radius + 28.0;  // of labels, behind tag and swatch
  const double right = figure.width - 4.0 * margin_right;
  double baseline = top + 9.0;
  std::string out = text(left, baseline, "start", figure.key_title) +
                    text(right, baseline, "end", figure.note_title);
  baseline += key_row + 2.0;
  for (const Series& series : panel.series) {
    if (series.label.empty()) continue;
    const char* weight = series.width >= 2.0 ? " font-weight=\"600\"" : "";
    if (!series.tag.empty()) out += disc({left + tag_radius, baseline - 3.5}, series);
    out += fmt::format("<g transform=\"translate({:.1f},{:.1f})\">{}</g>",
                       left + 2.0 * tag_radius + 5.0, baseline, swatch(series));
    out += text(right, baseline, "end", series.note, palette::ink, weight);
    for (std::size_t from = 0; from != std::string::npos; baseline += key_row) {
      const std::size_t end = series.label.find('\n', from);
      out += text(left + indent, baseline, "start", series.label.substr(from, end - from),
                  palette::ink, weight);
      from = end == std::string::npos ? end : end + 1;
    }
  }
  for (const std::string& remark : figure.key_foot)
    out += text(left, (baseline += key_row) - key_row + 8.0, "start", remark);
  return out;
}

/// Right-aligned on the line of the axis title, so that it never lies on data.
std::string legend(const Figure& figure, const Panel& panel, double baseline) {
  struct Entry {
    std::string label, mark;
  };

  std::vector<Entry> entries;
  for (const Series& series : panel.series)
    if (!series.label.empty()) entries.push_back({series.label, swatch(series)});
  const auto add_band = [&](const Band& band, const char* fill) {
    if (!band.label.empty())
      entries.push_back({band.label, rectangle(0.0, -9.0, 18.0, 10.0, fill)});
  };
  for (const Band& band : panel.bands) add_band(band, "#dfe5ec");
  if (&panel == &figure.panels.front() && !figure.shaded.empty())
    add_band(figure.shaded.front(), "#f0f1f3");
  double width = 0.0;
  for (const Entry& entry : entries) width += 24.0 + text_width(entry.label) + 14.0;
  double x = figure.width - margin_right - width + 14.0;
  std::string out;
  for (const Entry& entry : entries) {
    out += fmt::format("<g transform=\"translate({:.1f},{:.1f})\">{}{}</g>", x, baseline,
                       entry.mark, text(24.0, 0.0, "start", entry.label, palette::ink));
    x += 24.0 + text_width(entry.label) + 14.0;
  }
  return out;
}

/// One panel with its top at `top`.
std::string drawn_panel(const Figure& figure, const Panel& panel, const Scale& x, double top) {
  const std::array<double, 2> range = y_range(panel);
  const Scale y{range[0], range[1], top + panel.height, top};
  std::string out;
  for (const Band& band : figure.shaded) {
    const double left = std::clamp(x(band.low), x.from, x.to);
    const double right = std::clamp(x(band.high), x.from, x.to);
    out += rectangle(left, top, right - left, panel.height, "#f0f1f3");
  }
  for (const Band& band : panel.bands)
    out += rectangle(x.from, y(band.high), x.to - x.from, y(band.low) - y(band.high), "#dfe5ec");
  const double factor = panel.y.unit.factor;
  const Ticks ticks = nice_ticks(range[0] * factor, range[1] * factor, panel.ticks);
  for (const double tick : ticks.values) {
    const double at = y(tick / factor);
    const bool zero = panel.zero_line && std::abs(tick) < 1e-9 * ticks.step;
    out += line(x.from, at, x.to, at, zero ? "#8f969f" : grid_colour, zero ? 1.0 : 0.8);
    out += text(x.from - 7.0, at + 3.8, "end", tick_text(tick, ticks.decimals));
  }
  for (auto series = panel.series.rbegin(); series != panel.series.rend(); ++series) {
    out += path(*series, x, y);
    for (const std::size_t i : series->arrows) out += arrow(*series, i, x, y);
  }
  out += text(4.0, top - 10.0, "start", axis_title(panel.y), palette::ink, " font-weight=\"600\"");
  out += tags(panel, x, y);
  return out + (figure.key > 0.0 ? key_column(figure, panel, x.to + 14.0, top)
                                 : legend(figure, panel, top - 10.0));
}

std::string x_axis(const Figure& figure, const Scale& x, double bottom) {
  const double factor = figure.x.unit.factor;
  const Ticks ticks = nice_ticks(x.low * factor, x.high * factor, figure.ticks);
  std::string out = line(x.from, bottom, x.to, bottom, "#8f969f", 1.0);
  for (const double tick : ticks.values) {
    const double at = x(tick / factor);
    out += line(at, bottom, at, bottom + 4.0, "#8f969f", 1.0);
    out += text(at, bottom + 16.0, "middle", tick_text(tick, ticks.decimals));
  }
  return out + text((x.from + x.to) / 2.0, bottom + 33.0, "middle", axis_title(figure.x),
                    palette::ink, " font-weight=\"600\"");
}

}  // namespace

namespace {

struct Drawing {
  std::string body;
  double height;
};

Drawing drawing_of(const Figure& figure) {
  const std::array<double, 2> range = x_range(figure);
  const Scale x{range[0], range[1], margin_left, figure.width - margin_right - figure.key};
  std::string body;
  double top = 0.0;
  if (!figure.heading.empty()) {
    body += text(4.0, 14.0, "start", figure.heading, palette::ink,
                 " font-weight=\"600\" font-size=\"13\"");
    top += heading_height;
  }
  for (const Panel& panel : figure.panels) {
    top += head;
    body += drawn_panel(figure, panel, x, top);
    top += panel.height + gap;
  }
  const double bottom = top - gap;
  return {body + x_axis(figure, x, bottom), bottom + foot};
}

}  // namespace

std::string svg(const Figure& figure) {
  const Drawing drawing = drawing_of(figure);
  return opened(figure.width, drawing.height, figure.title) + drawing.body + "</svg>";
}

std::string svg_beside(const std::string& title, const std::vector<Figure>& figures) {
  std::string body;
  double left = 0.0, height = 0.0;
  for (const Figure& figure : figures) {
    const Drawing drawing = drawing_of(figure);
    body += fmt::format("<g transform=\"translate({:.1f},0)\">{}</g>", left, drawing.body);
    left += figure.width;
    height = std::max(height, drawing.height);
  }
  return opened(left, height, title) + body + "</svg>";
}

namespace {

constexpr double cell_width = 240.0, cell_height = 20.0, cell_margin = 8.0;

Scale cell_scale(double largest) {
  return {0.0, largest, cell_margin, cell_width - cell_margin};
}

}  // namespace

std::string svg_interval(double value, const std::array<double, 2>& interval, double largest,
                         const char* colour) {
  const Scale x = cell_scale(largest);
  constexpr double middle = cell_height / 2.0;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" "
      "width=\"{0:.0f}\" height=\"{1:.0f}\" aria-hidden=\"true\">",
      cell_width, cell_height);
  out += line(x.from, middle, x.to, middle, grid_colour, 1.0);
  for (const double tick : nice_ticks(0.0, largest, 2).values)
    out += line(x(tick), middle - 3.0, x(tick), middle + 3.0, "#c3c9d0", 1.0);
  if (std::isfinite(interval[0]) && std::isfinite(interval[1]) && interval[1] > interval[0]) {
    const double from = x(std::clamp(interval[0], 0.0, largest));
    const double to = x(std::clamp(interval[1], 0.0, largest));
    out += line(from, middle, to, middle, colour, 2.5);
    out += line(from, middle - 5.0, from, middle + 5.0, colour, 1.5);
    out += line(to, middle - 5.0, to, middle + 5.0, colour, 1.5);
  }
  if (std::isfinite(value))
    out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>",
                       x(std::clamp(value, 0.0, largest)), middle, colour);
  return out + "</svg>";
}

std::string svg_interval_scale(double largest) {
  const Scale x = cell_scale(largest);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} 14\" width=\"{0:.0f}\" "
      "height=\"14\" aria-hidden=\"true\" font-family=\"Helvetica Neue, Helvetica, Arial, "
      "sans-serif\" font-size=\"10.5\">",
      cell_width);
  const Ticks ticks = nice_ticks(0.0, largest, 2);
  for (const double tick : ticks.values)
    out += text(x(tick), 11.0, "middle", tick_text(tick, ticks.decimals));
  return out + "</svg>";
}

}  // namespace impactrig::reports

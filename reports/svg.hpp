// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/numbers.hpp"

/// Line plots as SVG for screen and paper: text stays text, no script, no request, one XML element
/// that may stand in HTML or alone in a file.
namespace impactrig::reports {

/// Blue and vermilion of Okabe and Ito 2008 and neighbours: told apart by colour-blind readers, and
/// in grey by their lightness and width.
namespace palette {
inline constexpr const char* measured = "#0f4584";
inline constexpr const char* model = "#f0862e";
inline constexpr const char* muted = "#8a9099";
inline constexpr const char* ink = "#1d232b";
}  // namespace palette

/// Text safe in HTML and XML, as content and in double-quoted attributes: & < > " ' escaped, bytes
/// that are no UTF-8 and control characters replaced by U+FFFD.
std::string escaped(std::string_view text);

/// A quantity along an axis. Data are SI; shown = unit.factor * SI.
struct Axis {
  std::string name;  ///< "Force"
  DisplayUnit unit;
  std::optional<std::array<double, 2>> range;  ///< SI; none: the data's, widened by 4 %
};

struct Series {
  std::string label;         ///< in the legend; "" for none; in a column it may have several lines
  std::vector<double> x, y;  ///< SI (n); samples that are not finite interrupt the line
  std::string colour = palette::ink;
  double width = 1.2;  ///< of the line, in the drawing's px (720 wide)
  double opacity = 1.0;
  std::vector<std::size_t> arrows;  ///< indices where a head shows the direction of time
  std::string dashes = {};          ///< lengths of dash and gap [px], "6 3"; "" a solid line
  std::string tag = {};             ///< a few characters on the line and beside its label; "" none
  std::string note = {};            ///< right of the label, where labels stand in a column
};

/// Something marked off behind the data: between two values of x, or of y.
struct Band {
  double low = 0.0, high = 0.0;  ///< SI
  std::string label;             ///< in the legend; "" for none
};

struct Panel {
  Axis y;
  double height = 200.0;       ///< of the plotted area [px]
  std::vector<Series> series;  ///< the first is listed first and drawn last, on top
  std::vector<Band> bands;     ///< of y
  bool zero_line = true;
  int ticks = 4;  ///< wanted along y
};

/// Panels one below the other over one x axis.
struct Figure {
  std::string title;  ///< what a screen reader says
  Axis x;
  double width = 720.0;  ///< [px]
  std::vector<Panel> panels;
  std::vector<Band> shaded;  ///< of x, through all panels
  int ticks = 7;             ///< wanted along x
  std::string heading = {};  ///< above the first panel; "" none
  /// Width of a column for the labels at the right [px]; 0: they stand above their panel.
  double key = 0.0;
  std::string key_title = {}, note_title = {};  ///< heads of that column
  std::vector<std::string> key_foot = {};       ///< lines below it
};

std::string svg(const Figure& figure);

/// Figures from left to right, each with axes of its own.
std::string svg_beside(const std::string& title, const std::vector<Figure>& figures);

/// A number as a dot and its interval as a whisker on a scale from 0 to `largest`, to stand in a
/// table's cell; what is not finite, or an interval of no width, is not drawn.
std::string svg_interval(double value, const std::array<double, 2>& interval, double largest,
                         const char* colour);

/// The scale of svg_interval, for the head of its column.
std::string svg_interval_scale(double largest);

}  // namespace impactrig::reports

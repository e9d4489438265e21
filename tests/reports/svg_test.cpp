// SPDX-License-Identifier: BSD-3-Clause
#include "reports/svg.hpp"

#include <cmath>
#include <limits>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reports/line_tags.hpp"
#include "tests/reports/markup.hpp"

namespace impactrig {
namespace {

using reports::nice_ticks;
using testing::HasSubstr;

const double nan = std::nan("");

/// A line plot of y over 0, 1, 2, ... us.
reports::Figure figure_of(const std::vector<double>& y) {
  reports::Figure figure;
  figure.title = "Force";
  figure.x = {"Time", {1e6, "µs"}, {}};
  reports::Series series{"measured", {}, y, "#123456", 1.0, 1.0, {}};
  for (std::size_t i = 0; i < y.size(); ++i) series.x.push_back(1e-6 * static_cast<double>(i));
  reports::Panel panel;
  panel.y = {"Force", {1.0, "N"}, {}};
  panel.series = {series};
  figure.panels = {panel};
  return figure;
}

/// The y coordinates [px] of the first path of colour #123456.
std::vector<double> path_heights(const std::string& svg) {
  std::smatch match;
  std::vector<double> out;
  if (!std::regex_search(svg, match, std::regex("<path d=\"([^\"]*)\"[^>]*#123456"))) return out;
  const std::string d = match[1];
  const std::regex point("[ML]([-0-9.]+) ([-0-9.]+)");
  for (std::sregex_iterator it(d.begin(), d.end(), point), end; it != end; ++it)
    out.push_back(std::stod((*it)[2]));
  return out;
}

TEST(Numbers, RoundToTwoDigitsOfTheUncertainty) {
  const auto text = [](double value, double error, const char* unit) {
    const reports::RoundedValue r = reports::rounded(value, error, unit);
    return r.value + "|" + r.error + "|" + r.unit;
  };
  EXPECT_EQ(text(0.51234, 0.0113, "1"), "0.512|0.011|");
  EXPECT_EQ(text(0.51234, 0.0996, "1"), "0.51|0.10|");  // 0.0996 rounds up to 0.10
  EXPECT_EQ(text(0.51234, 0.00996, "1"), "0.512|0.010|");
  EXPECT_EQ(text(1.237e-7, 4.4e-8, "s"), "124|44|ns");
  EXPECT_EQ(text(0.44083, 0.00037, "m/s"), "440.83|0.37|mm/s");
  EXPECT_EQ(text(1234.0, 123.0, "N"), "1230|120|N");
  EXPECT_EQ(text(21043.0, 123.0, "N"), "21.04|0.12|kN");
  EXPECT_EQ(text(-0.31, 0.22, "N"), "−310|220|mN");
  EXPECT_EQ(text(0.5, 0.0, "1"), "0.5000||");
  EXPECT_EQ(text(0.5, nan, "1"), "0.5000||");
  EXPECT_EQ(text(nan, 0.1, "N"), "–||N");
  EXPECT_EQ(text(1e-3, 12.0, "1"), "0|12|");
}

TEST(Numbers, TakeThePrefixThatReadsWell) {
  EXPECT_EQ(reports::quantity(343e-6, "s"), "343\u00a0µs");
  EXPECT_EQ(reports::quantity(1571.9, "N", 4), "1572\u00a0N");
  EXPECT_EQ(reports::quantity(2280.0, "N"), "2.28\u00a0kN");
  EXPECT_EQ(reports::quantity(1.8e-3, "m/s"), "1.80\u00a0mm/s");
  EXPECT_EQ(reports::quantity(0.4255, "N s", 4), "425.5\u00a0mN·s");
  EXPECT_EQ(reports::quantity(68.952e9, "Pa", 4), "68.95\u00a0GPa");
  EXPECT_EQ(reports::quantity(7.0686e-4, "m^2", 4), "0.0007069\u00a0m²");  // no milli-square metre
  EXPECT_EQ(reports::quantity(1500.0, "kg"), "1500\u00a0kg");
  EXPECT_EQ(reports::quantity(0.5, "1"), "0.500");
  EXPECT_EQ(reports::quantity(nan, "N"), "–");
}

TEST(Numbers, ShareUnitAndDecimalsInAColumn) {
  const reports::NumberColumn column = reports::number_column({1906.3, 2233.1, 88.0, nan}, "N", 4);
  EXPECT_EQ(column.unit.text, "kN");
  EXPECT_EQ(column.cells, (std::vector<std::string>{"1.906", "2.233", "0.088", "–"}));
  EXPECT_EQ(reports::number_column({0.0}, "s", 3, 342e-6).unit.text, "µs");
  EXPECT_EQ(reports::number_column({}, "N", 3).unit.text, "N");
  EXPECT_EQ(reports::number_column({0.0}, "N", 3).cells, (std::vector<std::string>{"0"}));
  EXPECT_EQ(reports::number_column({12345.6}, "1", 3).cells, (std::vector<std::string>{"12346"}));
}

TEST(Numbers, WriteSignificantDigits) {
  EXPECT_EQ(reports::significant(0.0, 3), "0");
  EXPECT_EQ(reports::significant(9.996, 3), "10.0");
  EXPECT_EQ(reports::significant(-1234.5, 2), "−1200");
  EXPECT_EQ(reports::significant(1.2345e-7, 3), "1.23·10⁻⁷");
  EXPECT_EQ(reports::significant(9.99e11, 2), "1.0·10¹²");
  EXPECT_EQ(reports::significant(std::numeric_limits<double>::infinity(), 2), "–");
  EXPECT_EQ(reports::percent(0.2337), "23\u00a0%");
  EXPECT_EQ(reports::percent(0.0312), "3.1\u00a0%");
  EXPECT_EQ(reports::percent(-0.0002), "−0.02\u00a0%");
  EXPECT_EQ(reports::percent(0.0), "0\u00a0%");
  EXPECT_EQ(reports::grouped(1537024), "1\u202f537\u202f024");
  EXPECT_EQ(reports::grouped(3000), "3000");
}

TEST(Ticks, AreMultiplesOfOneTwoOrFive) {
  const reports::Ticks ticks = nice_ticks(-500.0, 2500.0, 7);
  EXPECT_EQ(ticks.values, (std::vector<double>{-500, 0, 500, 1000, 1500, 2000, 2500}));
  EXPECT_EQ(nice_ticks(0.0, 0.35, 4).step, 0.1);
  EXPECT_EQ(nice_ticks(0.0, 0.35, 4).decimals, 1);
  for (double high = 1e-9; high < 1e9; high *= 1.37) {
    const reports::Ticks t = nice_ticks(0.0, high, 5);
    const double lead = t.step / std::pow(10.0, std::floor(std::log10(t.step) + 1e-9));
    EXPECT_TRUE(std::abs(lead - 1) < 1e-6 || std::abs(lead - 2) < 1e-6 || std::abs(lead - 5) < 1e-6)
        << high;
    EXPECT_GE(t.values.size(), 3u) << high;
    EXPECT_LE(t.values.size(), 9u) << high;
    EXPECT_LE(t.values.back(), high * (1 + 1e-6)) << high;
  }
}

TEST(Ticks, ExistForARangeOfNoWidth) {
  EXPECT_EQ(nice_ticks(3.0, 3.0, 5).values, (std::vector<double>{3.0}));
  EXPECT_EQ(nice_ticks(nan, 1.0, 5).values, (std::vector<double>{0.0}));
}

TEST(Decimation, KeepsTheExtremesOfEveryBucket) {
  std::vector<double> values(100000, 0.0);
  values[12345] = 7.0;
  values[12346] = -9.0;
  values[99998] = 3.0;
  const std::vector<std::size_t> kept = reports::min_max_indices(values, 700);
  EXPECT_LE(kept.size(), 1402u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end());
  EXPECT_THAT(kept, testing::Contains(12345u));
  EXPECT_THAT(kept, testing::Contains(12346u));
  EXPECT_THAT(kept, testing::Contains(99998u));
  EXPECT_EQ(kept.front(), 0u);
  EXPECT_EQ(kept.back(), 99999u);
}

TEST(Decimation, KeepsEverythingThatFits) {
  EXPECT_EQ(reports::min_max_indices(std::vector<double>(2800, 1.0), 700).size(), 2800u);
  EXPECT_TRUE(reports::min_max_indices({}, 700).empty());
}

TEST(Decimation, SurvivesSamplesThatAreNoNumbers) {
  std::vector<double> values(10000, nan);
  values[5000] = 2.0;
  EXPECT_THAT(reports::min_max_indices(values, 100), testing::Contains(5000u));
}

TEST(Svg, IsWellFormedAndShowsAxesWithUnits) {
  const std::string svg = reports::svg(figure_of({0.0, 1.0, -2.0, 4.0}));
  EXPECT_EQ(tests::markup_problem(svg), "");
  EXPECT_THAT(svg, HasSubstr(">Time [µs]</text>"));
  EXPECT_THAT(svg, HasSubstr(">Force [N]</text>"));
  EXPECT_THAT(svg, HasSubstr(">measured</text>"));
  EXPECT_THAT(svg, HasSubstr(">−2</text>"));
}

// One isolated sample in 100 000 is the highest point of the drawing.
TEST(Svg, ShowsAPeakOfOneSample) {
  std::vector<double> y(100000, 0.0);
  y[54321] = 1.0;
  const std::vector<double> heights = path_heights(reports::svg(figure_of(y)));
  EXPECT_LT(heights.size(), 3000u);
  const double base = heights.front();
  const double top = *std::min_element(heights.begin(), heights.end());
  EXPECT_GT(base - top, 150.0);  // of 200 px; 5 % margins
}

TEST(Svg, MapsValuesLinearly) {
  reports::Figure figure = figure_of({0.0, 1.0, 2.0});
  figure.panels[0].y.range = {{0.0, 2.0}};
  const std::vector<double> heights = path_heights(reports::svg(figure));
  ASSERT_EQ(heights.size(), 3u);
  EXPECT_NEAR(heights[0] - heights[2], 200.0, 0.1);
  EXPECT_NEAR(heights[1], (heights[0] + heights[2]) / 2.0, 0.1);
}

TEST(Svg, InterruptsALineWhereASampleIsMissing) {
  const std::string svg = reports::svg(figure_of({0.0, 1.0, nan, 1.0, 0.0}));
  EXPECT_EQ(path_heights(svg).size(), 4u);
  EXPECT_EQ(tests::markup_problem(svg), "");
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
}

TEST(Svg, CopesWithNothingToDraw) {
  for (const std::vector<double>& y : {std::vector<double>{}, {nan, nan}, {0.0}, {3.0, 3.0}}) {
    const std::string svg = reports::svg(figure_of(y));
    EXPECT_EQ(tests::markup_problem(svg), "");
    EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
    EXPECT_THAT(svg, testing::Not(HasSubstr("inf")));
  }
}

TEST(Svg, EscapesNames) {
  reports::Figure figure = figure_of({0.0, 1.0});
  figure.title = "\"<script>alert(1)</script>&";
  figure.panels[0].series[0].label = "<b>'x'</b>";
  const std::string svg = reports::svg(figure);
  EXPECT_EQ(tests::markup_problem(svg), "");
  EXPECT_THAT(svg, HasSubstr("&quot;&lt;script&gt;alert(1)&lt;/script&gt;&amp;"));
  EXPECT_THAT(svg, HasSubstr("&lt;b&gt;&#39;x&#39;&lt;/b&gt;"));
}

TEST(Svg, DrawsAnIntervalWithinItsCell) {
  const std::string cell = reports::svg_interval(0.5, {-0.2, 1.7}, 1.0, "#123456");
  EXPECT_EQ(tests::markup_problem(cell), "");
  EXPECT_THAT(cell, HasSubstr("cx=\"120.0\""));  // the middle of 240 px
  EXPECT_EQ(tests::markup_problem(reports::svg_interval(nan, {nan, nan}, 1.0, "#123456")), "");
  EXPECT_THAT(reports::svg_interval(nan, {nan, nan}, 1.0, "#123456"),
              testing::Not(HasSubstr("circle")));
}

TEST(Escape, ReplacesWhatIsNoUtf8) {
  EXPECT_EQ(reports::escaped("µm äß €"), "µm äß €");
  EXPECT_EQ(reports::escaped("a\xe4z"), "a\xef\xbf\xbdz");                   // Latin-1
  EXPECT_EQ(reports::escaped("\xc0\xaf"), "\xef\xbf\xbd\xef\xbf\xbd");       // overlong
  EXPECT_EQ(reports::escaped("\xed\xa0\x80").substr(0, 3), "\xef\xbf\xbd");  // surrogate
  EXPECT_EQ(reports::escaped(std::string("a\0b", 3)),
            "a\xef\xbf\xbd"
            "b");
  EXPECT_EQ(reports::escaped("\xe2\x82"), "\xef\xbf\xbd\xef\xbf\xbd");  // cut short
}

/// Two straight lines over 0 ... 4 us that cross.
reports::Figure crossing() {
  reports::Figure figure = figure_of({0.0, 1.0, 2.0, 3.0, 4.0});
  reports::Series other = figure.panels[0].series[0];
  other.y = {4.0, 3.0, 2.0, 1.0, 0.0};
  other.colour = "#654321";
  other.label = "falling,\nslowly";
  other.note = "4 N";
  other.dashes = "6 3";
  other.tag = "2";
  figure.panels[0].series[0].tag = "1";
  figure.panels[0].series.push_back(other);
  return figure;
}

TEST(Svg, LabelsMayStandInAColumnWithTagsAndNotes) {
  reports::Figure figure = crossing();
  figure.key = 200.0;
  figure.key_title = "line";
  figure.note_title = "first";
  figure.key_foot = {"both are straight"};
  figure.heading = "Two lines";
  const std::string svg = reports::svg(figure);
  EXPECT_EQ(tests::markup_problem(svg), "");
  for (const char* text : {">Two lines<", ">line<", ">first<", ">falling,<", ">slowly<", ">4 N<",
                           ">both are straight<"})
    EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray=\"6 3\""));
  // a tag on the line and one in the column, right of the plot that ends at 720 - 12 - 200 px
  const std::regex circle("<circle cx=\"([0-9.]+)\"[^>]*stroke=\"#654321\"");
  std::vector<double> places;
  for (std::sregex_iterator it(svg.begin(), svg.end(), circle), end; it != end; ++it)
    places.push_back(std::stod((*it)[1]));
  ASSERT_EQ(places.size(), 2U);
  EXPECT_LE(places[0], 508.0);
  EXPECT_GT(places[1], 508.0);
}

TEST(Svg, FiguresMayStandBesideEachOther) {
  reports::Figure figure = crossing();
  figure.width = 400.0;
  reports::Figure higher = figure;
  higher.panels[0].height = 300.0;
  const std::string svg = reports::svg_beside("Two & two", {figure, higher});
  EXPECT_EQ(tests::markup_problem(svg), "");
  // head 26, panel 300, foot 40
  EXPECT_THAT(svg, HasSubstr("viewBox=\"0 0 800 366\""));
  EXPECT_THAT(svg, HasSubstr("translate(400.0,0)"));
  EXPECT_THAT(svg, HasSubstr("Two &amp; two"));
}

TEST(LineTags, LieOnTheirLinesAndApart) {
  // a fan of 12 lines from one corner, nearly on each other there
  std::vector<std::vector<reports::Pixel>> lines;
  for (int i = 0; i < 12; ++i) lines.push_back({{0.0, 0.0}, {300.0, 15.0 * i}, {330.0, 15.0 * i}});
  const auto places = reports::tag_places(lines, 7.0);
  ASSERT_EQ(places.size(), lines.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    ASSERT_TRUE(places[i].has_value());
    const auto [x, y] = *places[i];
    const double slope = 15.0 * static_cast<double>(i) / 300.0;
    EXPECT_NEAR(y, slope * std::min(x, 300.0), 1e-9) << i;
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GT(std::hypot(x - (*places[k])[0], y - (*places[k])[1]), 14.0) << i << ' ' << k;
  }
}

TEST(LineTags, ALineWithoutPointsHasNone) {
  const auto places = reports::tag_places({{}, {{5.0, 5.0}}}, 7.0);
  EXPECT_FALSE(places[0].has_value());
  EXPECT_EQ(*places[1], (reports::Pixel{5.0, 5.0}));
}

}  // namespace
}  // namespace impactrig

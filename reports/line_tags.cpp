// SPDX-License-Identifier: BSD-3-Clause
#include "reports/line_tags.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace impactrig::reports {

namespace {

constexpr double spacing = 3.0;     // of the places looked at along a line [px]
constexpr double far_enough = 3.0;  // radii from other lines: beyond it more does not help

double distance(const Pixel& a, const Pixel& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

double distance(const Pixel& place, const std::vector<Pixel>& others) {
  double least = std::numeric_limits<double>::infinity();
  for (const Pixel& other : others) least = std::min(least, distance(place, other));
  return least;
}

/// Points at equal distances along a line.
std::vector<Pixel> spread(const std::vector<Pixel>& line) {
  std::vector<Pixel> out;
  double left = 0.0;  // to the next point
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double length = distance(line[i], line[i + 1]);
    double at = left;
    for (; at < length; at += spacing) {
      const double part = at / length;
      out.push_back({line[i][0] + part * (line[i + 1][0] - line[i][0]),
                     line[i][1] + part * (line[i + 1][1] - line[i][1])});
    }
    left = at - length;
  }
  if (out.empty() && !line.empty()) out.push_back(line.front());
  return out;
}

struct Candidate {
  Pixel place;
  double room;  // to the other lines, at most far_enough radii [px]
};

std::vector<Candidate> candidates(const std::vector<std::vector<Pixel>>& lines, std::size_t own,
                                  double radius) {
  std::vector<Candidate> out;
  for (const Pixel& place : lines[own]) {
    double room = far_enough * radius;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (i != own) room = std::min(room, distance(place, lines[i]));
    out.push_back({place, room});
  }
  return out;
}

/// The roomiest place off the discs there are; where all are on one, the farthest.
Pixel best(const std::vector<Candidate>& places, const std::vector<Pixel>& taken, double radius) {
  const auto rank = [&](const Candidate& candidate) {
    const double off = distance(candidate.place, taken);
    return off > 2.0 * radius + 2.0 ? far_enough * radius + candidate.room : off - 1e3 * radius;
  };
  return std::ranges::max_element(places, {}, rank)->place;
}

}  // namespace

std::vector<std::optional<Pixel>> tag_places(const std::vector<std::vector<Pixel>>& lines,
                                             double radius) {
  std::vector<std::vector<Pixel>> even;
  for (const std::vector<Pixel>& line : lines) even.push_back(spread(line));
  std::vector<std::vector<Candidate>> open(lines.size());
  std::vector<double> room(lines.size(), 0.0);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    open[i] = candidates(even, i, radius);
    for (const Candidate& candidate : open[i]) room[i] = std::max(room[i], candidate.room);
  }
  // lines with little room choose first
  std::vector<std::size_t> order(lines.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return room[i]; });
  std::vector<std::optional<Pixel>> places(lines.size());
  std::vector<Pixel> taken;
  for (const std::size_t i : order) {
    if (open[i].empty()) continue;
    places[i] = best(open[i], taken, radius);
    taken.push_back(*places[i]);
  }
  return places;
}

}  // namespace impactrig::reports

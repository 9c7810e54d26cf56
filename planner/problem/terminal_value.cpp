#include "planner/problem/terminal_value.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.hpp"
#include "core/index.hpp"

namespace vantage::planner {

TerminalValue::TerminalValue(std::vector<Stop> stops, Fields fields)
    : stops_(std::move(stops)), fields_(std::move(fields)) {
  demand(stops_.size() <= index(kStopsMax), "terminal value: must have at most 64 stops");
  double before_s = 0.0;
  for (std::size_t i = 0; i < stops_.size(); ++i) {
    const Stop& stop = stops_[i];
    demand(stop.target >= 0 && stop.target < 65'535,
           "terminal value: a stop's target must be in [0, 65535)");
    demand(stop.rate_per_s >= 0.0 && std::isfinite(stop.rate_per_s),
           "terminal value: rate_per_s must be ≥ 0");
    demand(stop.after_s >= before_s && std::isfinite(stop.after_s),
           "terminal value: after_s must be ≥ 0 and ascending");
    demand(std::isfinite(stop.open) && std::isfinite(stop.done) && stop.done <= stop.open,
           "terminal value: done must be ≤ open, both finite");
    before_s = stop.after_s;
    stop_of_.resize(std::max(stop_of_.size(), index(stop.target) + 1), -1);
    demand(stop_of_[index(stop.target)] < 0, "terminal value: a target must have at most one stop");
    stop_of_[index(stop.target)] = static_cast<std::int8_t>(i);
  }
  if (stops_.empty()) {
    return;
  }
  const std::size_t fields_count = std::min(stops_.size(), index(kFieldsMax));
  demand(fields_.side >= 2 && fields_.cell_m > 0.0 && std::isfinite(fields_.cell_m) &&
             fields_.min_m.allFinite(),
         "terminal value: the grid must have at least 2 × 2 points and cell_m > 0");
  demand(fields_.times_s.size() == fields_count * index(fields_.side) * index(fields_.side),
         "terminal value: times_s must have side × side values for each of the first stops");
  demand(std::all_of(fields_.times_s.begin(), fields_.times_s.end(),
                     [](double t_s) { return t_s >= 0.0 && std::isfinite(t_s); }),
         "terminal value: travel times must be finite and ≥ 0");
  set_slopes();
  const std::vector<double> left(stops_.size(), 1.0);
  whole_ = rest_of(left.data());
}

void TerminalValue::set_slopes() {
  const int side = fields_.side;
  const std::size_t points = index(side) * index(side);
  for (std::size_t field = 0; field * points < fields_.times_s.size(); ++field) {
    const double* const t = fields_.times_s.data() + field * points;
    double steepest = 0.0;
    for (int row = 0; row + 1 < side; ++row) {
      for (int column = 0; column + 1 < side; ++column) {
        const double* const low = t + row * side + column;
        const double* const high = low + side;
        const double x = std::max(std::abs(low[1] - low[0]), std::abs(high[1] - high[0]));
        const double y = std::max(std::abs(high[0] - low[0]), std::abs(high[1] - low[1]));
        steepest = std::max(steepest, std::hypot(x, y));
      }
    }
    slopes_s_per_m_.push_back(steepest / fields_.cell_m);
  }
}

double TerminalValue::time_s(int field, const Eigen::Vector2d& p_m) const {
  const int side = fields_.side;
  const double last = side - 1;
  const double x = std::clamp((p_m.x() - fields_.min_m.x()) / fields_.cell_m, 0.0, last);
  const double y = std::clamp((p_m.y() - fields_.min_m.y()) / fields_.cell_m, 0.0, last);
  const int column = std::min(static_cast<int>(x), side - 2);
  const int row = std::min(static_cast<int>(y), side - 2);
  const double u = x - column;
  const double v = y - row;
  const double* const low = fields_.times_s.data() + (field * side + row) * side + column;
  const double* const high = low + side;
  return (1.0 - v) * ((1.0 - u) * low[0] + u * low[1]) + v * ((1.0 - u) * high[0] + u * high[1]);
}

TerminalValue::Rest TerminalValue::rest_of(const double* left) const {
  const int count = static_cast<int>(stops_.size());
  const int first = static_cast<int>(
      std::find_if(left, left + count, [](double share) { return share > 0.0; }) - left);
  Rest rest;
  if (first >= count) {
    return rest;
  }
  for (int i = first; i < count; ++i) {
    const Stop& stop = stops_[index(i)];
    const double rate_per_s = left[i] * stop.rate_per_s;
    rest.rate_per_s += rate_per_s;
    rest.offset += rate_per_s * (stop.after_s - stops_[index(first)].after_s);
  }
  rest.field = first < kFieldsMax ? first : -1;
  return rest;
}

double TerminalValue::least_within(const Rest& rest, const Eigen::Vector2d& p_m,
                                   double reach_m) const {
  if (rest.field < 0) {
    return rest.offset;
  }
  const double nearer_s = time_s(rest.field, p_m) - slopes_s_per_m_[index(rest.field)] * reach_m;
  return rest.offset + rest.rate_per_s * std::max(0.0, nearer_s);
}

}  // namespace vantage::planner

#include "models/mapping/ray_walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vantage::models {
namespace {

struct Axis {
  int step = 0;
  double to_edge_m = std::numeric_limits<double>::infinity();
  double pitch_m = std::numeric_limits<double>::infinity();
};

// `place`: start coordinate in cells. `cosine`: component of the ray's direction along this axis.
Axis axis_of(double place, int cell, double cosine, double resolution_m) {
  if (std::abs(cosine) < 1e-12) {
    return {};  // the ray crosses no edge of this axis within the grid
  }
  const double edge = cosine > 0.0 ? cell + 1.0 : cell;
  return {cosine > 0.0 ? 1 : -1, std::max(0.0, (edge - place) * resolution_m / cosine),
          resolution_m / std::abs(cosine)};
}

}  // namespace

RayWalk::RayWalk(const GridGeometry& geometry, const Eigen::Vector2d& from_m, double bearing_rad,
                 double range_max_m)
    : columns_(geometry.columns), rows_(geometry.rows), range_max_m_(range_max_m) {
  const int start = geometry.index_of(from_m);
  if (start < 0 || !(range_max_m > 0.0) || !std::isfinite(bearing_rad)) {
    ended_ = true;
    return;
  }
  column_ = start % columns_;
  row_ = start / columns_;
  const Eigen::Vector2d place = (from_m - geometry.origin_m) / geometry.resolution_m;
  const Axis x = axis_of(place.x(), column_, std::cos(bearing_rad), geometry.resolution_m);
  const Axis y = axis_of(place.y(), row_, std::sin(bearing_rad), geometry.resolution_m);
  column_step_ = x.step;
  row_step_ = y.step;
  next_column_m_ = x.to_edge_m;
  next_row_m_ = y.to_edge_m;
  column_pitch_m_ = x.pitch_m;
  row_pitch_m_ = y.pitch_m;
}

double RayWalk::exit_m() const { return std::min({next_column_m_, next_row_m_, range_max_m_}); }

bool RayWalk::next() {
  if (ended_) {
    return false;
  }
  if (!begun_) {
    begun_ = true;
    return true;
  }
  enter_m_ = exit_m();
  if (next_column_m_ <= next_row_m_) {
    column_ += column_step_;
    next_column_m_ += column_pitch_m_;
  } else {
    row_ += row_step_;
    next_row_m_ += row_pitch_m_;
  }
  ended_ =
      enter_m_ >= range_max_m_ || column_ < 0 || column_ >= columns_ || row_ < 0 || row_ >= rows_;
  return !ended_;
}

}  // namespace vantage::models

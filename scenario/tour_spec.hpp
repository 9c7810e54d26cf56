#pragma once

namespace vantage::scenario {

/// Tour over targets and unexplored regions beyond a search's horizon (planner/tour).
struct TourSpec {
  double horizon_s = 0.0;  ///< s; time over which the tour sums the uncertainty; 0: no tour
  double weight = 1.0;     ///< factor of the terminal value that the tour gives a search
  double visit_s = 1.0;    ///< s; duration of the measurements of one visit
  /// Edge of the square regions whose unexplored parts are stops, m; 0: exploration landmarks are
  /// stops instead.
  double region_m = 0.0;
};

}  // namespace vantage::scenario

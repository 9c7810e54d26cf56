#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace vantage::models {

/// Finder of pairs of bodies that may be near each other, for many bodies that move little between
/// calls. Bodies are sorted along x, so each is compared only with those in its strip.
class NearPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< i < j

  /// Returns at least every pair whose centres are at most `within_m` apart (∞: all pairs),
  /// ascending. Bodies whose centre is not finite are in no pair. Valid until the next call.
  const std::vector<Pair>& find(std::span<const Eigen::Vector3d> centres_m, double within_m);

 private:
  std::vector<std::uint32_t> order_;  ///< by ascending x at the last call
  std::vector<Pair> pairs_;
};

}  // namespace vantage::models

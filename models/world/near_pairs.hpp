#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace vantage::models {

/// Who may be near whom, of many bodies that move little from call to call: sorted along x, so a
/// body is held against those in its strip alone and not against all.
class NearPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< i < j

  /// At least every pair whose centres are no farther apart than `within_m` (∞: all), ascending;
  /// bodies whose centre is not finite are in none. Good until the next call.
  const std::vector<Pair>& find(std::span<const Eigen::Vector3d> centres_m, double within_m);

 private:
  std::vector<std::uint32_t> order_;  ///< by ascending x, as of the last call
  std::vector<Pair> pairs_;
};

}  // namespace vantage::models

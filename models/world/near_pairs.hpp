#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace vantage::models {

/// Finder of nearby pairs among many bodies that move little between calls. The bodies stay sorted
/// by x, and only bodies that differ in x by at most the search distance are compared.
class NearPairs {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;  ///< i < j

  /// Returns all pairs with centres no farther apart than `within_m` (∞: all), and possibly others;
  /// ascending. Bodies with a non-finite centre are excluded. The reference is valid until the next
  /// call.
  const std::vector<Pair>& find(std::span<const Eigen::Vector3d> centres_m, double within_m);

 private:
  std::vector<std::uint32_t> order_;  ///< body indices by ascending x at the last call
  std::vector<Pair> pairs_;
};

}  // namespace vantage::models

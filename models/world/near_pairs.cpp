#include "models/world/near_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace vantage::models {

const std::vector<NearPairs::Pair>& NearPairs::find(std::span<const Eigen::Vector3d> centres_m,
                                                    double within_m) {
  pairs_.clear();
  std::erase_if(
      order_, [&](std::uint32_t i) { return i >= centres_m.size() || !centres_m[i].allFinite(); });
  std::vector<bool> is_listed(centres_m.size(), false);
  for (const std::uint32_t i : order_) {
    is_listed[i] = true;
  }
  for (std::size_t i = 0; i < centres_m.size(); ++i) {
    if (!is_listed[i] && centres_m[i].allFinite()) {
      order_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return centres_m[a].x() != centres_m[b].x() ? centres_m[a].x() < centres_m[b].x() : a < b;
  });
  for (std::size_t a = 0; a < order_.size(); ++a) {
    const Eigen::Vector3d& here_m = centres_m[order_[a]];
    for (std::size_t b = a + 1; b < order_.size(); ++b) {
      const Eigen::Vector3d& there_m = centres_m[order_[b]];
      if (there_m.x() - here_m.x() > within_m) {
        break;
      }
      if (std::abs(there_m.y() - here_m.y()) <= within_m) {
        pairs_.emplace_back(std::minmax(order_[a], order_[b]));
      }
    }
  }
  std::sort(pairs_.begin(), pairs_.end());
  return pairs_;
}

}  // namespace vantage::models

#include "planner/search/crossing_index.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace vantage::planner {

CrossingIndex::CrossingIndex(std::size_t entries_max)
    : heads_(std::bit_ceil(std::min<std::size_t>(entries_max, 1U << 16U))),
      epochs_(heads_.size()),
      entries_(entries_max + 1) {}

void CrossingIndex::prefault() {
  heads_.prefault();
  epochs_.prefault();
  entries_.prefault();
}

void CrossingIndex::reset(double delta_m) {
  constexpr double kFinestCell_m = 1e-3;
  cell_m_ = std::max(delta_m, kFinestCell_m);
  ++epoch_;
  count_ = 1;
}

std::int32_t CrossingIndex::cell_of(double coordinate_m) const {
  constexpr double kFarthest = 1e9;
  return static_cast<std::int32_t>(
      std::floor(std::clamp(coordinate_m / cell_m_, -kFarthest, kFarthest)));
}

std::size_t CrossingIndex::bucket(std::int32_t x, std::int32_t y) const {
  const std::uint32_t mixed = static_cast<std::uint32_t>(x) * 0x9E3779B1U ^
                              std::rotl(static_cast<std::uint32_t>(y) * 0x85EBCA77U, 13);
  return (mixed ^ (mixed >> 15U)) & (heads_.size() - 1);
}

bool CrossingIndex::insert(const Pose2& pose, NodeId id) {
  if (count_ == entries_.size()) {
    return false;
  }
  const std::int32_t x = cell_of(pose.x_m);
  const std::int32_t y = cell_of(pose.y_m);
  const std::size_t b = bucket(x, y);
  const std::uint32_t head = epochs_[b] == epoch_ ? heads_[b] : 0;
  entries_[count_] = {id, head, x, y};
  heads_[b] = static_cast<std::uint32_t>(count_++);
  epochs_[b] = epoch_;
  return true;
}

}  // namespace vantage::planner

#pragma once

#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/world/near_pairs.hpp"

namespace vantage::logs {

/// True target positions of the last `memory_s` seconds, and the smallest distance between robots.
class TruthHistory {
 public:
  explicit TruthHistory(double memory_s = 10.0) : memory_s_(memory_s) {}

  /// Adds a frame. A frame that is not newer than the newest one is ignored.
  void add(const models::TruthFrame& frame);

  /// Returns the position of a target at `time`, interpolated linearly between frames; nullopt
  /// outside the stored time.
  [[nodiscard]] std::optional<Eigen::Vector3d> target_position_m(int target_id, Time time) const;

  /// Returns the least distance so far between the centres of two robots, in 3-D. The motion
  /// between frames is assumed linear, so that no near miss between frames is overlooked. Returns
  /// nullopt until two robots have been seen.
  [[nodiscard]] std::optional<double> min_separation_m() const;

 private:
  struct Frame {
    Time time{};
    std::map<int, Eigen::Vector3d> targets;
    std::map<std::string, Eigen::Vector3d> robots;
  };
  void approach(const Frame& before, const Frame& after);

  double memory_s_;
  models::NearPairs near_;
  std::deque<Frame> frames_;
  double min_separation_m_ = std::numeric_limits<double>::infinity();
};

}  // namespace vantage::logs

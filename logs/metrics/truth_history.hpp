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

/// Where the targets really were, at any instant of the last while, and how near the robots ever
/// came to each other.
class TruthHistory {
 public:
  explicit TruthHistory(double memory_s = 10.0) : memory_s_(memory_s) {}

  /// Frames that are not newer than the newest are ignored and counted.
  void add(const models::TruthFrame& frame);

  /// Position of a target at `time`, linear between the frames around it; nullopt outside what is
  /// remembered.
  [[nodiscard]] std::optional<Eigen::Vector3d> target_position_m(int target_id, Time time) const;

  /// Least distance so far between the centres of two robots, in space, with linear motion between
  /// frames (so that nothing tunnels); nullopt before two robots were seen.
  [[nodiscard]] std::optional<double> min_separation_m() const;

  [[nodiscard]] std::int64_t frames_ignored() const { return frames_ignored_; }

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
  std::int64_t frames_ignored_ = 0;
};

}  // namespace vantage::logs

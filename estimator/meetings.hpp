#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "estimator/track_table.hpp"

namespace vantage::estimator {

/// Targets are discs: no two of them are in one place, and who walks into another turns back there.
/// Where a belief allows that its target does, samples of it do, and what comes of it is no
/// Gaussian (docs/decisions/0024).
///
/// A value, of nothing but scratch. Nothing allocates up to TrackTable::kReserved targets.
class Meetings {
 public:
  /// Of up to so many targets, whose middles come no nearer than `distance_m` to each other.
  Meetings(int target_count, double distance_m);

  /// Those of the dt_s from now on. Of which of `tracks` a sample walks into another's, it is told
  /// by samples from here on; predicted by dt_s, they are where they are after it. What is told of
  /// them, their information, is as it was. `key` chooses which sample meets which, for the same
  /// targets the same. Precondition: a model with a velocity.
  void let_meet(TrackTable& tracks, double dt_s, std::uint64_t key);

 private:
  /// A target, and the disc that it hardly leaves within the time.
  struct Party {
    int target_id = 0;
    Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
    double radius_m = 0.0;
    bool has_met = false;
    Samples samples = {};  ///< of who is near another; none of a belief that is nothing definite
  };
  [[nodiscard]] bool may_meet(const Party& one, const Party& other) const;

  double distance_m_;
  std::vector<Party> parties_;
};

}  // namespace vantage::estimator

#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// A target's position as one robot estimates it, with the velocity marginalised out.
struct PositionEstimate {
  std::string robot;
  Time time{};  ///< time of the belief
  Time last_seen{};
  models::PositionVector mean_m;
  models::PositionMatrix covariance_m2;
  double entropy_nats = 0.0;  ///< ½ log det(2πe Σ) of the position

  /// Returns the square root of the mean variance of the coordinates, m.
  [[nodiscard]] double sigma_m() const;
  /// Returns the normalised squared error (NEES) eᵀ Σ⁻¹ e of the position. Its mean is the number
  /// of coordinates if the estimator is consistent.
  [[nodiscard]] double nees(const models::PositionVector& true_m) const;
};

/// Returns the position estimate of `belief`; nullopt if the information matrix is not invertible.
std::optional<PositionEstimate> position_estimate(const models::TargetBelief& belief,
                                                  const std::string& robot, Time time,
                                                  int position_dim);

/// Returns the entropy of an isotropic Gaussian position with a standard deviation of `sigma_m` in
/// each of `position_dim` axes.
double isotropic_entropy_nats(double sigma_m, int position_dim);

/// The team's estimate of each target: the estimate with the least position entropy among the
/// robots that know the target. In a tie the more recent sighting is used, then the first robot in
/// alphabetical order.
class TeamEstimate {
 public:
  void offer(int target_id, const PositionEstimate& candidate);
  /// Returns the team's estimate of a target; nullptr if no robot knows the target.
  [[nodiscard]] const PositionEstimate* find(int target_id) const;

 private:
  std::map<int, PositionEstimate> best_;
};

}  // namespace vantage::logs

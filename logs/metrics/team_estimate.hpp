#pragma once

#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// A target's position as one robot knows it, the velocity marginalised away.
struct PositionEstimate {
  std::string robot;
  Time time{};  ///< of the belief
  Time last_seen{};
  models::PositionVector mean_m;
  models::PositionMatrix covariance_m2;
  double entropy_nats = 0.0;  ///< ½ log det(2πe Σ) of the position

  /// Root of the mean variance of the coordinates.
  [[nodiscard]] double sigma_m() const;
  /// Normalised squared error eᵀ Σ⁻¹ e of the position against the true one; the number of
  /// coordinates in the mean where the estimator is consistent.
  [[nodiscard]] double nees(const models::PositionVector& true_m) const;
};

/// nullopt when the information matrix cannot be inverted.
std::optional<PositionEstimate> position_estimate(const models::TargetBelief& belief,
                                                  const std::string& robot, Time time,
                                                  int position_dim);

/// Entropy of an isotropic Gaussian position with 1σ of `sigma_m` in each of `position_dim` axes.
double isotropic_entropy_nats(double sigma_m, int position_dim);

/// The team's estimate of each target: among the robots that know it, the one with the least
/// position entropy (the most information); of equals the one with the newer sighting, then the
/// robot first in the alphabet.
class TeamEstimate {
 public:
  void offer(int target_id, const PositionEstimate& candidate);
  /// nullptr when nobody knows it.
  [[nodiscard]] const PositionEstimate* find(int target_id) const;

 private:
  std::map<int, PositionEstimate> best_;
};

}  // namespace vantage::logs

#pragma once

#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "models/target/target_model.hpp"
#include "models/world/world.hpp"

namespace vantage::sim {

/// Returns a draw from N(0, L D Lᵀ), which may be singular; `root` is the decomposition of the
/// covariance.
models::StateVector draw_gaussian(const Eigen::LDLT<models::StateMatrix>& root,
                                  std::mt19937_64& rng);

/// Targets that move exactly as their model: x ← A x + w, w ~ N(0, W) of one step. A target that
/// leaves the bounds is reflected back.
class LinearTargets {
 public:
  /// @param starts  position and velocity, 4 components
  /// @param rng  engine used only for their noise
  LinearTargets(const models::TargetModel& model, double step_s, const models::Rectangle& bounds,
                std::vector<models::StateVector> starts, const std::mt19937_64& rng);

  /// Moves each target by one step.
  void move();
  [[nodiscard]] const std::vector<models::StateVector>& states() const { return states_; }

 private:
  models::StateMatrix A_;
  Eigen::LDLT<models::StateMatrix> root_of_W_;
  models::Rectangle bounds_;
  std::vector<models::StateVector> states_;
  std::mt19937_64 rng_;
};

}  // namespace vantage::sim

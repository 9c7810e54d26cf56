#pragma once

#include <random>
#include <vector>

#include <Eigen/Cholesky>

#include "models/target/target_model.hpp"
#include "models/world/world.hpp"

namespace vantage::sim {

/// Returns a sample of N(0, P), where `root` is the LDLᵀ decomposition of the covariance P, which
/// may be singular.
models::StateVector draw_gaussian(const Eigen::LDLT<models::StateMatrix>& root,
                                  std::mt19937_64& rng);

/// Targets that move exactly by their model: in each step x ← A x + w, w ~ N(0, W). A target that
/// would leave the bounds is reflected.
class LinearTargets {
 public:
  /// @param starts  position and velocity, 4 components
  /// @param rng  engine used only for the process noise
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

#include "localizer/team_smoother.hpp"

#include <Eigen/Cholesky>

#include "core/angle.hpp"

namespace vantage::localizer {

void TeamSmoother::begin_step(const TeamFilter& filter, Time time) {
  Step& step = steps_.emplace_back();
  step.time = time;
  step.filtered = filter.state();
  step.covariance = filter.joint_covariance();
}

void TeamSmoother::end_step(const TeamFilter& filter) {
  Step& step = steps_.back();
  step.predicted = filter.state();
  step.predicted_variances = filter.joint_covariance().diagonal();
  step.transition = filter.transition();
}

void TeamSmoother::forget_before(Time time) {
  while (!steps_.empty() && steps_.front().time < time) {
    steps_.pop_front();
  }
}

void TeamSmoother::smooth(const TeamFilter& filter, const Use& use) const {
  constexpr int kDim = TeamFilter::kRobotDim;
  constexpr double kVarianceMin = 1e-12;  // lower limit; needed for robots without a pose
  Eigen::VectorXd state = filter.state();
  Eigen::MatrixXd covariance = filter.joint_covariance();
  const Eigen::Index n = state.size();
  Eigen::MatrixXd cross(n, n);
  Eigen::MatrixXd predicted(n, n);
  for (auto step = steps_.rbegin(); step != steps_.rend(); ++step) {
    // cross = F P and predicted = F P Fᵀ + Q; Q is diagonal and known from the recorded variances.
    for (int robot = 0; robot < filter.robots(); ++robot) {
      const auto& F = step->transition[static_cast<std::size_t>(robot)];
      cross.middleRows<kDim>(robot * kDim).noalias() =
          F * step->covariance.middleRows<kDim>(robot * kDim);
    }
    const Eigen::Index landmarks = n - Eigen::Index{kDim} * filter.robots();
    cross.bottomRows(landmarks) = step->covariance.bottomRows(landmarks);  // landmarks do not move
    for (int robot = 0; robot < filter.robots(); ++robot) {
      const auto& F = step->transition[static_cast<std::size_t>(robot)];
      predicted.middleCols<kDim>(robot * kDim).noalias() =
          cross.middleCols<kDim>(robot * kDim) * F.transpose();
    }
    predicted.rightCols(landmarks) = cross.rightCols(landmarks);
    predicted.diagonal() = step->predicted_variances.array() + kVarianceMin;
    const Eigen::MatrixXd gain = predicted.ldlt().solve(cross).transpose();  // P Fᵀ predicted⁻¹
    Eigen::VectorXd change = state - step->predicted;
    for (int robot = 0; robot < filter.robots(); ++robot) {
      change(robot * kDim + 2) = wrap_to_pi(change(robot * kDim + 2));
    }
    state = step->filtered + gain * change;
    for (int robot = 0; robot < filter.robots(); ++robot) {
      state(robot * kDim + 2) = wrap_to_pi(state(robot * kDim + 2));
    }
    covariance = step->covariance + gain * (covariance - predicted) * gain.transpose();
    covariance = 0.5 * (covariance + covariance.transpose()).eval();
    use(step->time, state, covariance);
  }
}

}  // namespace vantage::localizer

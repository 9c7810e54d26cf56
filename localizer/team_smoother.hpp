#pragma once

#include <deque>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "localizer/team_filter.hpp"

namespace vantage::localizer {

/// Recorded steps of a TeamFilter, for estimates in hindsight (Rauch–Tung–Striebel).
///
/// Usage: begin_step() before and end_step() after each TeamFilter::advance(); smooth() at any
/// time. Allocates memory for each step. A slip that TeamFilter::observe() detects is not part of
/// the recorded motion; hindsight is then too confident before the slip.
class TeamSmoother {
 public:
  /// Receives the time, joint state and joint covariance of one recorded step.
  using Use = std::function<void(Time, const Eigen::VectorXd&, const Eigen::MatrixXd&)>;

  /// Records the state of `filter` at `time`, after its observations and before the next advance().
  void begin_step(const TeamFilter& filter, Time time);
  /// Records the motion and the prediction of the advance() since begin_step().
  void end_step(const TeamFilter& filter);
  /// Drops the steps before `time`.
  void forget_before(Time time);

  /// Calls `use` for each recorded step, from the newest to the oldest, with the estimate that
  /// contains all observations of `filter`. `filter` is the filter after the last step.
  void smooth(const TeamFilter& filter, const Use& use) const;

 private:
  struct Step {
    Time time{};
    Eigen::VectorXd filtered;
    Eigen::MatrixXd covariance;
    Eigen::VectorXd predicted;
    Eigen::VectorXd predicted_variances;  ///< diagonal of the predicted covariance
    std::vector<Eigen::Matrix<double, TeamFilter::kRobotDim, TeamFilter::kRobotDim>> transition;
  };
  std::deque<Step> steps_;
};

}  // namespace vantage::localizer

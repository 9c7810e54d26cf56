#pragma once

#include <vector>

#include "localizer/judge/judge.hpp"

namespace vantage::localizer {

/// Collects the estimates of a run and computes their figures.
class Score {
 public:
  /// `recording` must outlive the score.
  Score(const Recording& recording, const std::vector<bool>& heading_trusted,
        const JudgeOptions& options);

  void add(std::size_t robot, Time time, const Pose2& pose, const Eigen::Matrix3d& covariance);
  /// Counts an instant at which `robot` should have a pose.
  void add_missing(std::size_t robot, Time time);

  /// @param found  landmarks at estimated positions; used if landmarks were hidden
  [[nodiscard]] JudgeFigures figures(const std::vector<scenario::LandmarkSpec>& found) const;

 private:
  struct Sample {
    std::size_t robot = 0;
    Pose2 pose;
    Pose2 truth;
    Eigen::Matrix3d covariance;
  };
  [[nodiscard]] Pose2 world_from_map() const;
  void judge_landmarks(const std::vector<scenario::LandmarkSpec>& found,
                       const Pose2& world_from_map, JudgeFigures& out) const;

  const Recording& recording_;
  std::vector<bool> trusted_;
  PoseWatch watch_;
  std::vector<scenario::LandmarkSpec> hidden_;
  std::vector<Sample> samples_;
  int missing_ = 0;
};

/// Returns the landmarks in the state of `filter`.
std::vector<scenario::LandmarkSpec> landmarks_of(const TeamFilter& filter);

}  // namespace vantage::localizer

#include "localizer/judge/score.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "core/angle.hpp"

namespace vantage::localizer {
namespace {

constexpr double kInside2 = 5.991465;  // 95 % quantile of χ² with 2 degrees of freedom
constexpr double kInside3 = 7.814728;

/// Returns the rotation and translation that moves `from` to `to` with the least squared error.
Pose2 alignment_of(const std::vector<Eigen::Vector2d>& from,
                   const std::vector<Eigen::Vector2d>& to) {
  if (from.empty()) {
    return {};
  }
  Eigen::Vector2d mean_from = Eigen::Vector2d::Zero();
  Eigen::Vector2d mean_to = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) {
    mean_from += from[k] / static_cast<double>(from.size());
    mean_to += to[k] / static_cast<double>(from.size());
  }
  double cosine = 0.0;
  double sine = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Eigen::Vector2d p = from[k] - mean_from;
    const Eigen::Vector2d q = to[k] - mean_to;
    cosine += p.dot(q);
    sine += p.x() * q.y() - p.y() * q.x();
  }
  Pose2 to_from_from{0.0, 0.0, std::atan2(sine, cosine)};
  const Eigen::Vector2d origin_m = mean_to - to_from_from * mean_from;
  to_from_from.x_m = origin_m.x();
  to_from_from.y_m = origin_m.y();
  return to_from_from;
}

/// Returns the root mean square distance of the points `from`, moved by `to_from_from`, from `to`.
double rmse_of(const Pose2& to_from_from, const std::vector<Eigen::Vector2d>& from,
               const std::vector<Eigen::Vector2d>& to) {
  double squares = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    squares += (to_from_from * from[k] - to[k]).squaredNorm();
  }
  return from.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(from.size()));
}

ErrorFigures figures_of(std::vector<double> errors) {
  ErrorFigures out;
  out.count = static_cast<int>(errors.size());
  if (errors.empty()) {
    return out;
  }
  std::sort(errors.begin(), errors.end());
  double squares = 0.0;
  for (const double error : errors) {
    squares += error * error;
  }
  const auto quantile = [&](double share) {
    return errors[static_cast<std::size_t>(share * static_cast<double>(errors.size() - 1))];
  };
  out.rmse = std::sqrt(squares / static_cast<double>(errors.size()));
  out.median = quantile(0.5);
  out.p95 = quantile(0.95);
  out.max = errors.back();
  return out;
}

}  // namespace

Score::Score(const Recording& recording, const std::vector<bool>& heading_trusted,
             const JudgeOptions& options)
    : recording_(recording),
      trusted_(heading_trusted),
      watch_(options.watch),
      hidden_(options.hidden_landmarks) {}

void Score::add(std::size_t robot, Time time, const Pose2& pose,
                const Eigen::Matrix3d& covariance) {
  if (watch_) {
    watch_(robot, time, pose, covariance);
  }
  if (const auto truth = recording_[robot].truth.at(time)) {
    samples_.push_back({robot, pose, *truth, covariance});
  }
}

void Score::add_missing(std::size_t robot, Time time) {
  missing_ += recording_[robot].truth.at(time) ? 1 : 0;
}

Pose2 Score::world_from_map() const {
  if (hidden_.empty()) {
    return {};
  }
  std::vector<Eigen::Vector2d> from;
  std::vector<Eigen::Vector2d> to;
  for (const Sample& sample : samples_) {
    from.push_back(sample.pose.position_m());
    to.push_back(sample.truth.position_m());
  }
  return alignment_of(from, to);
}

void Score::judge_landmarks(const std::vector<scenario::LandmarkSpec>& found,
                            const Pose2& world_from_map, JudgeFigures& out) const {
  std::vector<Eigen::Vector2d> to;
  for (const scenario::LandmarkSpec& landmark : found) {
    const auto truth =
        std::find_if(hidden_.begin(), hidden_.end(),
                     [&](const scenario::LandmarkSpec& each) { return each.id == landmark.id; });
    if (truth != hidden_.end()) {
      out.landmarks_m.push_back(landmark.position_m);
      to.push_back(truth->position_m);
    }
  }
  out.landmarks_rmse_m = rmse_of(world_from_map, out.landmarks_m, to);
  out.landmarks_own_rmse_m = rmse_of(alignment_of(out.landmarks_m, to), out.landmarks_m, to);
}

JudgeFigures Score::figures(const std::vector<scenario::LandmarkSpec>& found) const {
  JudgeFigures out;
  const Pose2 map = world_from_map();
  judge_landmarks(found, map, out);
  std::vector<double> all;
  std::vector<std::vector<double>> by_robot(recording_.size());
  std::vector<double> yaw;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(map.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  for (const Sample& sample : samples_) {
    const Pose2 pose = map * sample.pose;
    const Eigen::Matrix3d P3 = turn * sample.covariance * turn.transpose();
    const Eigen::Vector3d error(pose.x_m - sample.truth.x_m, pose.y_m - sample.truth.y_m,
                                wrap_to_pi(pose.yaw_rad - sample.truth.yaw_rad));
    by_robot[sample.robot].push_back(error.head<2>().norm());
    all.push_back(error.head<2>().norm());
    const Eigen::Matrix2d P = P3.topLeftCorner<2, 2>();
    const double of_position = error.head<2>().dot(P.inverse() * error.head<2>());
    out.nees_position += of_position;
    out.inside_position += of_position <= kInside2 ? 1 : 0;
    if (trusted_.empty() || trusted_[sample.robot]) {
      yaw.push_back(std::abs(error.z()));
      const double of_pose = error.dot(P3.inverse() * error);
      out.nees_pose += of_pose;
      out.inside_pose += of_pose <= kInside3 ? 1 : 0;
    }
  }
  for (const std::vector<double>& errors : by_robot) {
    out.robot_position_m.push_back(figures_of(errors));
  }
  out.position_m = figures_of(all);
  out.yaw_rad = figures_of(yaw);
  const double positions = std::max(1.0, static_cast<double>(all.size()));
  const double poses = std::max(1.0, static_cast<double>(yaw.size()));
  out.nees_position /= positions;
  out.inside_position /= positions;
  out.nees_pose /= poses;
  out.inside_pose /= poses;
  out.without_pose = missing_;
  return out;
}

std::vector<scenario::LandmarkSpec> landmarks_of(const TeamFilter& filter) {
  std::vector<scenario::LandmarkSpec> found;
  for (std::size_t k = 0; k < filter.mapped().size(); ++k) {
    if (filter.mapped()[k] != kNoBodyId) {
      found.push_back({filter.mapped()[k], filter.landmark_m(static_cast<int>(k))});
    }
  }
  return found;
}

}  // namespace vantage::localizer

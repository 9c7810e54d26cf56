#include "drivers/vehicle/estimated_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace vantage::drivers {
namespace {

constexpr double kSigmaMinM = 1e-3;  // m; 0 would mean motion capture

}  // namespace

void EstimatedPose::on_pose(const models::PoseEstimate& estimate) {
  if (estimate.robot == robot_ && estimate.source != models::PoseSource::kNone) {
    pose_.correct(estimate);
    newest_ = estimate;
  }
}

void EstimatedPose::on_odometry(const models::OdometryReport& odometry) {
  if (odometry.robot == robot_ && odometry.kind == models::OdometryKind::kIncrement) {
    pose_.move(odometry.stamp.time, odometry.motion_body);
  }
}

std::optional<EstimatedPose::Filled> EstimatedPose::fill(const models::MocapFrame& frame) const {
  const Time time = frame.stamp.time;
  const Duration age = newest_ ? time - newest_->stamp.time : kAgeMax;
  if (!newest_ || age > kAgeMax || age < -kAgeMax) {  // a stamp in the future would never be old
    return std::nullopt;
  }
  const auto named = [this](const models::MocapBody& body) { return body.name == robot_; };
  const auto seen = std::find_if(frame.bodies.begin(), frame.bodies.end(), named);
  if (seen != frame.bodies.end() && !seen->occluded) {
    return std::nullopt;
  }
  Filled filled{frame, kSigmaMinM};
  auto body = std::find_if(filled.frame.bodies.begin(), filled.frame.bodies.end(), named);
  if (body == filled.frame.bodies.end()) {
    filled.frame.bodies.emplace_back().name = robot_;
    body = std::prev(filled.frame.bodies.end());
  }
  body->world_from_body = lift(pose_.at(time), height_m_);
  body->occluded = false;
  const Eigen::Matrix2d covariance = newest_->covariance.topLeftCorner<2, 2>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance, Eigen::EigenvaluesOnly);
  filled.sigma_m = std::max(std::sqrt(std::max(axes.eigenvalues()(1), 0.0)), kSigmaMinM);
  return filled;
}

}  // namespace vantage::drivers

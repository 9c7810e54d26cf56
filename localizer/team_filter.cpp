#include "localizer/team_filter.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/angle.hpp"
#include "localizer/sighting_model.hpp"

namespace vantage::localizer {
namespace {

using RobotVector = Eigen::Matrix<double, TeamFilter::kRobotDim, 1>;
using Block = Eigen::Matrix<double, TeamFilter::kRobotDim, TeamFilter::kRobotDim>;
/// Matrix of a frame without heap memory.
using FrameMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2 * kFrameSightingsMax,
                                  2 * kFrameSightingsMax>;

// Indices in a robot's state.
constexpr int kYaw = 2;
constexpr int kTurnError = 3;
constexpr int kSpeedError = 4;

constexpr double kWeakenSigma = 2.5;  // σ; a sighting beyond gets a larger variance
constexpr double kRejectSigma = 5.0;  // σ; a sighting beyond is rejected
// 1σ that is added to the pose after a slip of the wheels.
constexpr double kSlipYawSigmaRad = 0.2;
constexpr double kSlipPositionSigmaM = 0.05;
constexpr int kSlipLandmarksMin = 2;  // number of rejected landmark sightings that indicates a slip

}  // namespace

TeamFilter::TeamFilter(const scenario::LocalizerSpec& spec)
    : spec_(spec), placed_(spec.robots.size(), 0), F_(spec.robots.size(), Block::Identity()) {
  const int n = static_cast<int>(spec.robots.size()) * kRobotDim;
  x_ = Eigen::VectorXd::Zero(n);
  P_ = Eigen::MatrixXd::Zero(n, n);
  block_row_ = Eigen::MatrixXd::Zero(kRobotDim, n);
  gain_ = Eigen::MatrixXd::Zero(2 * kFrameSightingsMax, n);
  rows_.reserve(kFrameSightingsMax);
  for (int robot = 0; robot < robots(); ++robot) {
    reset_errors(robot);
  }
}

void TeamFilter::reset_errors(int robot) {
  const int i = at(robot);
  P_.middleRows(i, kRobotDim).setZero();
  P_.middleCols(i, kRobotDim).setZero();
  x_.segment<kRobotDim>(i).setZero();
  const auto variance = [](double sigma) { return sigma * sigma; };
  P_(i + kTurnError, i + kTurnError) = variance(spec_.odometry_noise.turn_drift_radps);
  P_(i + kSpeedError, i + kSpeedError) = variance(spec_.odometry_noise.speed_drift_share);
}

void TeamFilter::place(int robot, const Pose2& world_from_body, const Eigen::Matrix3d& covariance) {
  reset_errors(robot);
  const int i = at(robot);
  x_.segment<3>(i) << world_from_body.x_m, world_from_body.y_m, world_from_body.yaw_rad;
  P_.block<3, 3>(i, i) = covariance;
  placed_[index(robot)] = 1;
}

void TeamFilter::remove(int robot) {
  reset_errors(robot);
  placed_[index(robot)] = 0;
}

void TeamFilter::assign(const TeamFilter& other) {
  std::copy(other.placed_.begin(), other.placed_.end(), placed_.begin());
  x_ = other.x_;
  P_ = other.P_;
  std::copy(other.F_.begin(), other.F_.end(), F_.begin());
  counts_ = other.counts_;
}

Pose2 TeamFilter::pose(int robot) const {
  const int i = at(robot);
  return {x_(i), x_(i + 1), x_(i + kYaw)};
}

Eigen::Matrix3d TeamFilter::covariance(int robot) const {
  return P_.block<3, 3>(at(robot), at(robot));
}

void TeamFilter::advance(double duration_s, std::span<const Eigen::Vector3d> increments,
                         std::span<const double> noise_scale) {
  const scenario::OdometryNoiseSpec& odometry = spec_.odometry_noise;
  const double keep_turn = std::exp(-duration_s / odometry.turn_drift_time_s);
  const double keep_speed = std::exp(-duration_s / odometry.speed_drift_time_s);
  const auto renewed = [](double sigma, double keep) {
    return sigma * sigma * (1.0 - keep * keep);
  };

  for (int robot = 0; robot < robots(); ++robot) {
    const int i = at(robot);
    Block& F = F_[index(robot)];
    F.setIdentity();
    F(kTurnError, kTurnError) = keep_turn;
    F(kSpeedError, kSpeedError) = keep_speed;

    RobotVector Q = RobotVector::Zero();
    Q(kTurnError) = renewed(odometry.turn_drift_radps, keep_turn);
    Q(kSpeedError) = renewed(odometry.speed_drift_share, keep_speed);

    if (is_placed(robot)) {
      const Eigen::Vector3d& increment = increments[index(robot)];
      const double scale = noise_scale.empty() ? 1.0 : noise_scale[index(robot)];
      const double distance_m = increment.head<2>().norm();
      const double turn_rad = increment.z() + x_(i + kTurnError) * duration_s;
      const double forward_m = increment.x() * (1.0 + x_(i + kSpeedError));
      const double middle_rad = x_(i + kYaw) + 0.5 * x_(i + kTurnError) * duration_s;
      const double c = std::cos(middle_rad);
      const double s = std::sin(middle_rad);
      const double east_m = c * forward_m - s * increment.y();
      const double north_m = s * forward_m + c * increment.y();
      F(0, kYaw) = -north_m;
      F(1, kYaw) = east_m;
      F(0, kTurnError) = -0.5 * duration_s * north_m;
      F(1, kTurnError) = 0.5 * duration_s * east_m;
      F(0, kSpeedError) = c * increment.x();
      F(1, kSpeedError) = s * increment.x();
      F(kYaw, kTurnError) = duration_s;
      const double slide = odometry.slide_sigma_per_sqrt_m;
      Q(0) = Q(1) = scale * slide * slide * distance_m;
      const double per_s = odometry.turn_sigma_rad_per_sqrt_s;
      const double per_rad = odometry.turn_sigma_per_sqrt_rad;
      Q(kYaw) = scale * (per_s * per_s * duration_s + per_rad * per_rad * std::abs(increment.z()));
      x_(i) += east_m;
      x_(i + 1) += north_m;
      x_(i + kYaw) = wrap_to_pi(x_(i + kYaw) + turn_rad);
    }
    x_(i + kTurnError) *= keep_turn;
    x_(i + kSpeedError) *= keep_speed;

    // P = F P Fᵀ + Q, one block row and one block column.
    block_row_.noalias() = F.lazyProduct(P_.middleRows<kRobotDim>(i));
    P_.middleRows<kRobotDim>(i) = block_row_;
    block_row_.noalias() = F.lazyProduct(P_.middleCols<kRobotDim>(i).transpose());
    P_.middleCols<kRobotDim>(i) = block_row_.transpose();
    P_.diagonal().segment<kRobotDim>(i) += Q;
  }
}

void TeamFilter::linearise(int robot, std::span<const models::Sighting> sightings) {
  const scenario::SightingNoiseSpec& noise = spec_.sighting_noise;
  const scenario::SightingSpec& camera = spec_.robots[index(robot)].sightings;
  rows_.clear();
  for (const models::Sighting& sighting : sightings) {
    Row row;
    Eigen::Vector2d point_m;
    const auto landmark =
        std::find_if(spec_.landmarks.begin(), spec_.landmarks.end(),
                     [&](const scenario::LandmarkSpec& each) { return each.id == sighting.id; });
    if (landmark != spec_.landmarks.end()) {
      point_m = landmark->position_m;
    } else {
      const auto mate = std::find_if(
          spec_.robots.begin(), spec_.robots.end(),
          [&](const scenario::LocalizedRobotSpec& each) { return each.id == sighting.id; });
      row.other = mate == spec_.robots.end() ? -1 : static_cast<int>(mate - spec_.robots.begin());
      if (row.other < 0 || row.other == robot) {
        ++counts_.unknown;
        continue;
      }
      if (!is_placed(row.other)) {
        ++counts_.unplaced;
        continue;
      }
      point_m = x_.segment<2>(at(row.other));
    }
    if (rows_.size() == kFrameSightingsMax) {
      ++counts_.unknown;
      continue;
    }
    const ExpectedSighting expected = expected_sighting(camera, pose(robot), point_m);
    row.residual << sighting.range_m - expected.range_m,
        wrap_to_pi(sighting.bearing_rad - expected.bearing_rad);
    row.by_own.setZero();
    row.by_own.leftCols<3>() = expected.by_pose;
    row.by_other = expected.by_point;
    const double d = expected.distance_m;
    const double range_sigma_m = noise.range_sigma_m + noise.range_sigma_per_m * d * d;
    row.R.setZero();
    row.R(0, 0) = range_sigma_m * range_sigma_m;
    row.R(1, 1) = noise.bearing_sigma_rad * noise.bearing_sigma_rad +
                  noise.across_sigma_m * noise.across_sigma_m / (d * d);
    if (row.other >= 0) {
      row.R += noise.teammate_sigma_m * noise.teammate_sigma_m * expected.by_point *
               expected.by_point.transpose();
    }
    rows_.push_back(row);
  }
}

Eigen::Matrix2d TeamFilter::innovation(int robot, const Row& row) const {
  const int i = at(robot);
  Eigen::Matrix2d S =
      row.R + row.by_own * P_.block<kRobotDim, kRobotDim>(i, i) * row.by_own.transpose();
  if (row.other >= 0) {
    const int j = at(row.other);
    const Eigen::Matrix2d cross =
        row.by_own * P_.block<kRobotDim, 2>(i, j) * row.by_other.transpose();
    S += cross + cross.transpose() + row.by_other * P_.block<2, 2>(j, j) * row.by_other.transpose();
  }
  const double shared = spec_.sighting_noise.frame_bearing_sigma_rad;
  S(1, 1) += shared * shared;
  return S;
}

int TeamFilter::weigh(int robot) {
  int rejected_landmarks = 0;
  for (Row& row : rows_) {
    const Eigen::Matrix2d S = innovation(robot, row);
    const double squared = row.residual.dot(S.inverse() * row.residual);
    if (squared > kRejectSigma * kRejectSigma) {
      row.weight = 0.0;
      rejected_landmarks += row.other < 0 ? 1 : 0;
    } else {
      row.weight =
          squared > kWeakenSigma * kWeakenSigma ? kWeakenSigma * kWeakenSigma / squared : 1.0;
    }
  }
  return rejected_landmarks;
}

void TeamFilter::observe(int robot, std::span<const models::Sighting> sightings) {
  if (!is_placed(robot)) {
    counts_.unplaced += static_cast<std::int64_t>(sightings.size());
    return;
  }
  linearise(robot, sightings);
  if (const int rejected = weigh(robot);
      rejected >= kSlipLandmarksMin && 2 * rejected >= static_cast<int>(rows_.size())) {
    const int i = at(robot);
    P_(i, i) += kSlipPositionSigmaM * kSlipPositionSigmaM;
    P_(i + 1, i + 1) += kSlipPositionSigmaM * kSlipPositionSigmaM;
    P_(i + kYaw, i + kYaw) += kSlipYawSigmaRad * kSlipYawSigmaRad;
    ++counts_.slips;
    weigh(robot);
  }
  for (const Row& row : rows_) {
    counts_.rejected += row.weight == 0.0 ? 1 : 0;
    counts_.used += row.weight > 0.0 ? 1 : 0;
    counts_.weakened += row.weight > 0.0 && row.weight < 1.0 ? 1 : 0;
  }
  std::erase_if(rows_, [](const Row& row) { return row.weight == 0.0; });
  if (!rows_.empty()) {
    update(robot);
  }
}

void TeamFilter::update(int robot) {
  const int i = at(robot);
  const int m = 2 * static_cast<int>(rows_.size());
  // gain_ = H P, one pair of rows per sighting.
  for (int k = 0; k < m / 2; ++k) {
    const Row& row = rows_[index(k)];
    auto HP = gain_.middleRows<2>(2 * k);
    HP.noalias() = row.by_own.lazyProduct(P_.middleRows<kRobotDim>(i));
    if (row.other >= 0) {
      HP.noalias() += row.by_other.lazyProduct(P_.middleRows<2>(at(row.other)));
    }
  }
  FrameMatrix S(m, m);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 2 * kFrameSightingsMax, 1> residual(m);
  const double shared = spec_.sighting_noise.frame_bearing_sigma_rad;
  for (int l = 0; l < m / 2; ++l) {
    const Row& row = rows_[index(l)];
    residual.segment<2>(2 * l) = row.residual;
    for (int k = 0; k < m / 2; ++k) {
      Eigen::Matrix2d HPHt =
          gain_.block<2, kRobotDim>(2 * k, i).lazyProduct(row.by_own.transpose());
      if (row.other >= 0) {
        HPHt += gain_.block<2, 2>(2 * k, at(row.other)).lazyProduct(row.by_other.transpose());
      }
      HPHt(1, 1) += shared * shared;
      if (k == l) {
        HPHt += row.R / row.weight;
      }
      S.block<2, 2>(2 * k, 2 * l) = HPHt;
    }
  }
  // S = L Lᵀ. With W = L⁻¹ H P: x += Wᵀ L⁻¹ r and P −= Wᵀ W.
  const Eigen::LLT<FrameMatrix> factor(S);
  if (factor.info() != Eigen::Success) {
    return;
  }
  for (int k = 0; k < m; ++k) {
    for (int l = 0; l < k; ++l) {
      gain_.row(k) -= factor.matrixLLT()(k, l) * gain_.row(l);
      residual(k) -= factor.matrixLLT()(k, l) * residual(l);
    }
    gain_.row(k) /= factor.matrixLLT()(k, k);
    residual(k) /= factor.matrixLLT()(k, k);
  }
  for (int k = 0; k < m; ++k) {
    x_ += residual(k) * gain_.row(k).transpose();
    for (Eigen::Index column = 0; column < P_.cols(); ++column) {
      P_.col(column) -= gain_(k, column) * gain_.row(k).transpose();
    }
  }
  for (int each = 0; each < robots(); ++each) {
    x_(at(each) + kYaw) = wrap_to_pi(x_(at(each) + kYaw));
  }
}

}  // namespace vantage::localizer

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
/// Matrix for the sightings of one frame; it needs no heap memory.
using FrameMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 2 * kFrameSightingsMax,
                                  2 * kFrameSightingsMax>;

// Indices in a robot's state.
constexpr int kYaw = 2;
constexpr int kTurnError = 3;
constexpr int kSpeedError = 4;

// m; a sighting at a smaller distance does not determine its landmark's position
constexpr double kMappedDistanceMinM = 0.1;
constexpr double kWeakenSigma = 2.5;  // σ; a sighting with a larger error gets a larger variance
constexpr double kRejectSigma = 5.0;  // σ; a sighting with a larger error is rejected
// 1σ that is added to the pose after a slip of the wheels.
constexpr double kSlipYawSigmaRad = 0.2;
constexpr double kSlipPositionSigmaM = 0.05;
constexpr int kSlipLandmarksMin = 2;  // number of rejected landmark sightings that indicates a slip
constexpr int kSureUses = 4;          // number of sightings after which a landmark stays mapped

}  // namespace

TeamFilter::TeamFilter(const scenario::LocalizerSpec& spec)
    : spec_(spec), placed_(spec.robots.size(), 0), F_(spec.robots.size(), Block::Identity()) {
  const int n = static_cast<int>(spec.robots.size()) * kRobotDim + 2 * spec.unknown_landmarks_max;
  x_ = Eigen::VectorXd::Zero(n);
  P_ = Eigen::MatrixXd::Zero(n, n);
  block_row_ = Eigen::MatrixXd::Zero(kRobotDim, n);
  gain_ = Eigen::MatrixXd::Zero(2 * kFrameSightingsMax, n);
  rows_.reserve(kFrameSightingsMax);
  ids_.reserve(kFrameSightingsMax);
  candidates_.reserve(spec.landmarks.size() + spec.robots.size() +
                      index(spec.unknown_landmarks_max));
  mapped_.assign(index(spec.unknown_landmarks_max), kNoBodyId);
  uses_.assign(index(spec.unknown_landmarks_max), 0);
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
  std::copy(other.mapped_.begin(), other.mapped_.end(), mapped_.begin());
  std::copy(other.uses_.begin(), other.uses_.end(), uses_.begin());
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
                         std::span<const GuessNoise> guesses) {
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
      const GuessNoise guess = guesses.empty() ? GuessNoise{} : guesses[index(robot)];
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
      Q(0) = Q(1) = guess.scale * slide * slide * distance_m + guess.position_m2;
      const double per_s = odometry.turn_sigma_rad_per_sqrt_s;
      const double per_rad = odometry.turn_sigma_per_sqrt_rad;
      const double turn_rad2 =
          per_s * per_s * duration_s + per_rad * per_rad * std::abs(increment.z());
      Q(kYaw) = guess.scale * turn_rad2 + guess.heading_rad2;
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

TeamFilter::Body TeamFilter::find_body(int id, bool& is_new) const {
  is_new = false;
  if (id < 0) {
    return {};
  }
  const auto has_id = [&](const auto& each) { return each.id == id; };
  const auto landmark = std::find_if(spec_.landmarks.begin(), spec_.landmarks.end(), has_id);
  if (landmark != spec_.landmarks.end()) {
    return {true, false, -1, landmark->position_m};
  }
  const auto mate = std::find_if(spec_.robots.begin(), spec_.robots.end(), has_id);
  if (mate != spec_.robots.end()) {
    const int robot = static_cast<int>(mate - spec_.robots.begin());
    return {is_placed(robot), true, at(robot), x_.segment<2>(at(robot))};
  }
  const auto mapped = std::find(mapped_.begin(), mapped_.end(), id);
  if (mapped != mapped_.end()) {
    const int column = at_landmark(static_cast<int>(mapped - mapped_.begin()));
    return {true, false, column, x_.segment<2>(column)};
  }
  is_new = std::find(mapped_.begin(), mapped_.end(), kNoBodyId) != mapped_.end();
  return {};
}

TeamFilter::Row TeamFilter::row_of(int robot, const Pose2& world_from_body,
                                   const models::Sighting& sighting, const Body& body) const {
  const ExpectedSighting expected =
      expected_sighting(spec_.robots[index(robot)].sightings, world_from_body, body.position_m);
  Row row;
  row.column = body.column;
  row.is_mate = body.is_mate;
  row.residual << sighting.range_m - expected.range_m,
      wrap_to_pi(sighting.bearing_rad - expected.bearing_rad);
  row.by_own.setZero();
  row.by_own.leftCols<3>() = expected.by_pose;
  row.by_other = expected.by_point;
  row.R = sighting_covariance(spec_.sighting_noise, expected, body.is_mate);
  return row;
}

bool TeamFilter::map_landmark(int robot, const models::Sighting& sighting) {
  const scenario::SightingSpec& law = spec_.robots[index(robot)].sightings;
  const Eigen::Vector2d point_m = sighted_point_m(law, sighting.range_m, sighting.bearing_rad);
  if (!((point_m - Eigen::Vector2d(law.forward_m, 0.0)).norm() >= kMappedDistanceMinM)) {
    return false;
  }
  const int k =
      static_cast<int>(std::find(mapped_.begin(), mapped_.end(), kNoBodyId) - mapped_.begin());
  const int column = at_landmark(k);
  const int i = at(robot);
  Body body{true, false, column, Eigen::Vector2d::Zero()};
  body.position_m = pose(robot) * point_m;
  const Row row = row_of(robot, pose(robot), sighting, body);
  const Eigen::Matrix2d to_point = row.by_other.inverse();
  const Eigen::Matrix<double, 2, kRobotDim> by_own = -to_point * row.by_own;
  Eigen::Matrix2d R = row.R;
  const double shared = spec_.sighting_noise.frame_bearing_sigma_rad;
  R(1, 1) += shared * shared;
  auto cross = gain_.topRows<2>();
  cross.noalias() = by_own.lazyProduct(P_.middleRows<kRobotDim>(i));
  P_.middleRows<2>(column) = cross;
  P_.middleCols<2>(column) = cross.transpose();
  P_.block<2, 2>(column, column) =
      by_own * P_.block<kRobotDim, kRobotDim>(i, i) * by_own.transpose() +
      to_point * R * to_point.transpose();
  x_.segment<2>(column) = body.position_m;
  mapped_[index(k)] = sighting.id;
  uses_[index(k)] = 0;
  return true;
}

void TeamFilter::forget_landmark(int k) {
  P_.middleRows<2>(at_landmark(k)).setZero();
  P_.middleCols<2>(at_landmark(k)).setZero();
  x_.segment<2>(at_landmark(k)).setZero();
  mapped_[index(k)] = kNoBodyId;
}

void TeamFilter::linearise(int robot, std::span<const models::Sighting> sightings) {
  rows_.clear();
  for (std::size_t k = 0; k < sightings.size(); ++k) {
    const int id = k < ids_.size() ? ids_[k] : sightings[k].id;
    bool is_new = false;
    const Body body = find_body(id, is_new);
    if (is_new) {
      models::Sighting first = sightings[k];
      first.id = id;
      if (!map_landmark(robot, first)) {
        ++counts_.unknown;
      }
      continue;
    }
    if (!body.is_known || body.column == at(robot)) {
      const bool was_assigned = k < ids_.size() && sightings[k].id == kNoBodyId;
      const bool is_unplaced = body.is_mate && body.column != at(robot);
      (is_unplaced ? counts_.unplaced : counts_.unknown) += was_assigned ? 0 : 1;
      continue;
    }
    if (rows_.size() == kFrameSightingsMax) {
      ++counts_.unknown;
      continue;
    }
    Row row = row_of(robot, pose(robot), sightings[k], body);
    row.id = id;
    rows_.push_back(row);
  }
}

void TeamFilter::associate(int robot, std::span<const models::Sighting> sightings) {
  ids_.clear();
  bool has_unknown = false;
  for (const models::Sighting& sighting :
       sightings.first(std::min(sightings.size(), static_cast<std::size_t>(kFrameSightingsMax)))) {
    ids_.push_back(sighting.id);
    has_unknown = has_unknown || sighting.id == kNoBodyId;
  }
  if (!has_unknown) {
    return;
  }
  const int i = at(robot);
  candidates_.clear();
  for (const scenario::LandmarkSpec& landmark : spec_.landmarks) {
    candidates_.push_back({landmark.id, false, landmark.position_m});
  }
  const auto add = [&](int id, bool is_mate, int column) {
    candidates_.push_back({id, is_mate, x_.segment<2>(column), P_.block<2, 2>(column, column),
                           P_.block<3, 2>(i, column)});
  };
  for (std::size_t k = 0; k < mapped_.size(); ++k) {
    if (mapped_[k] != kNoBodyId) {
      add(mapped_[k], false, at_landmark(static_cast<int>(k)));
    }
  }
  for (int mate = 0; mate < robots(); ++mate) {
    if (mate != robot && is_placed(mate)) {
      add(spec_.robots[index(mate)].id, true, at(mate));
    }
  }
  assign_frame({spec_.robots[index(robot)].sightings, spec_.sighting_noise, candidates_,
                sightings.first(ids_.size())},
               {pose(robot), P_.block<3, 3>(i, i)}, ids_);
  for (std::size_t k = 0; k < ids_.size(); ++k) {
    if (sightings[k].id == kNoBodyId) {
      counts_.matched += ids_[k] >= 0 ? 1 : 0;
      counts_.ambiguous += ids_[k] == kAmbiguousId ? 1 : 0;
      counts_.unmatched += ids_[k] == kNoBodyId ? 1 : 0;
    }
  }
}

Eigen::Matrix2d TeamFilter::innovation(int robot, const Row& row) const {
  const int i = at(robot);
  Eigen::Matrix2d S =
      row.R + row.by_own * P_.block<kRobotDim, kRobotDim>(i, i) * row.by_own.transpose();
  if (row.column >= 0) {
    const int j = row.column;
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
    if (!(squared <= kRejectSigma * kRejectSigma)) {  // also rejects NaN
      row.weight = 0.0;
      rejected_landmarks += row.is_mate ? 0 : 1;
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
  associate(robot, sightings);
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
  for (const Row& row : rows_) {
    if (row.column < at_landmark(0)) {
      continue;
    }
    // A landmark whose first sighting was wrong is mapped again.
    const int k = (row.column - at_landmark(0)) / 2;
    uses_[index(k)] += row.weight > 0.0 ? 1 : 0;
    if (row.weight == 0.0 && uses_[index(k)] < kSureUses) {
      forget_landmark(k);
    }
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
    if (row.column >= 0) {
      HP.noalias() += row.by_other.lazyProduct(P_.middleRows<2>(row.column));
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
      if (row.column >= 0) {
        HPHt += gain_.block<2, 2>(2 * k, row.column).lazyProduct(row.by_other.transpose());
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
  if (factor.info() != Eigen::Success || !factor.matrixLLT().allFinite()) {
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

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Number of sightings of a frame that are used; further sightings are dropped and counted.
inline constexpr int kFrameSightingsMax = 16;

/// Counts of one filter since its start.
struct FilterCounts {
  std::int64_t used = 0;      ///< sightings with full or reduced weight
  std::int64_t weakened = 0;  ///< of these, sightings with reduced weight
  std::int64_t rejected = 0;  ///< sightings beyond the gate
  std::int64_t unknown = 0;   ///< sightings of an unknown id, or beyond kFrameSightingsMax
  std::int64_t unplaced = 0;  ///< sightings by or of a robot without a pose
  std::int64_t slips = 0;     ///< frames that widened the robot's pose before the update
};

/// Extended Kalman filter of the poses of a complete team: one joint Gaussian, so that every
/// cross-correlation is exact.
///
/// Per robot the state is (x, y, yaw, turn rate error, relative speed error). The last two vary
/// slowly. Robots without a pose are excluded until place(). No function allocates memory after
/// construction.
///
/// Sightings have heavy tails: a sighting beyond kWeakenSigma gets a larger variance, one beyond
/// kRejectSigma is rejected. If a frame's sightings of landmarks are rejected together, the wheels
/// have probably slipped: the robot's pose gets a larger variance, and the frame is used.
class TeamFilter {
 public:
  static constexpr int kRobotDim = 5;

  explicit TeamFilter(const scenario::LocalizerSpec& spec);

  /// Sets the pose of robot `robot` (index in the specification), independent of all other robots.
  void place(int robot, const Pose2& world_from_body, const Eigen::Matrix3d& covariance);
  /// Forgets the pose of `robot`.
  void remove(int robot);
  [[nodiscard]] bool is_placed(int robot) const { return placed_[index(robot)] != 0; }

  /// Moves all robots by `increments` (forward m, left m, turn rad; one per robot), which took
  /// `duration_s`. `noise_scale` multiplies the variances of each robot's increment if its motion
  /// is a guess.
  void advance(double duration_s, std::span<const Eigen::Vector3d> increments,
               std::span<const double> noise_scale = {});

  /// Uses the sightings of one frame of `robot`'s sensor.
  void observe(int robot, std::span<const models::Sighting> sightings);

  [[nodiscard]] int robots() const { return static_cast<int>(placed_.size()); }
  [[nodiscard]] Pose2 pose(int robot) const;
  [[nodiscard]] Eigen::Matrix3d covariance(int robot) const;
  [[nodiscard]] const FilterCounts& counts() const { return counts_; }
  /// Joint state and covariance, for smoothing.
  [[nodiscard]] const Eigen::VectorXd& state() const { return x_; }
  [[nodiscard]] const Eigen::MatrixXd& joint_covariance() const { return P_; }
  /// Transition of the last advance(): block diagonal, one block of kRobotDim per robot.
  [[nodiscard]] const std::vector<Eigen::Matrix<double, kRobotDim, kRobotDim>>& transition() const {
    return F_;
  }

  /// Makes this filter equal to `other`, a filter of the same specification, without allocation.
  void assign(const TeamFilter& other);

 private:
  using Block = Eigen::Matrix<double, kRobotDim, kRobotDim>;
  /// One usable sighting, linearised.
  struct Row {
    int other = -1;  ///< robot index of the sighted teammate; −1: landmark
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, kRobotDim> by_own;
    Eigen::Matrix2d by_other;  ///< derivative with respect to the teammate's position
    Eigen::Matrix2d R;
    double weight = 1.0;  ///< factor of R⁻¹; 0: rejected
  };

  [[nodiscard]] static std::size_t index(int robot) { return static_cast<std::size_t>(robot); }
  [[nodiscard]] static int at(int robot) { return robot * kRobotDim; }
  void reset_errors(int robot);
  /// Fills rows_ from the usable sightings of `robot`.
  void linearise(int robot, std::span<const models::Sighting> sightings);
  /// Returns the covariance of the row's residual, without the error common to the frame.
  [[nodiscard]] Eigen::Matrix2d innovation(int robot, const Row& row) const;
  /// Sets the weights of all rows; returns the number of rejected sightings of landmarks.
  int weigh(int robot);
  void update(int robot);

  scenario::LocalizerSpec spec_;
  std::vector<char> placed_;
  Eigen::VectorXd x_;
  Eigen::MatrixXd P_;
  std::vector<Block> F_;
  Eigen::MatrixXd block_row_;  ///< kRobotDim × n, workspace
  Eigen::MatrixXd gain_;       ///< rows of S^{-1/2} H P, 2 · kFrameSightingsMax × n, workspace
  std::vector<Row> rows_;
  FilterCounts counts_;
};

}  // namespace vantage::localizer

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "localizer/frame_assignment.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Counts of one filter since its start.
struct FilterCounts {
  std::int64_t used = 0;      ///< sightings with full or reduced weight
  std::int64_t weakened = 0;  ///< number of the used sightings that had a reduced weight
  std::int64_t rejected = 0;  ///< sightings beyond the gate
  std::int64_t unknown = 0;   ///< sightings of an unknown id, or beyond kFrameSightingsMax
  std::int64_t unplaced = 0;  ///< sightings made by, or of, a robot without a pose
  std::int64_t slips = 0;     ///< frames before which the variance of the robot's pose was enlarged
  std::int64_t matched = 0;   ///< sightings without an id that were assigned to a body
  std::int64_t ambiguous = 0;  ///< sightings without an id that fit several bodies; not used
  std::int64_t unmatched = 0;  ///< sightings without an id that fit no body
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
///
/// Landmarks at unknown positions (LocalizerSpec::unknown_landmarks_max) are part of the state from
/// their first sighting on. Sightings without an id are assigned to bodies by hypotheses about the
/// complete frame; sightings that the likely hypotheses assign differently are not used.
class TeamFilter {
 public:
  static constexpr int kRobotDim = 5;

  explicit TeamFilter(const scenario::LocalizerSpec& spec);

  /// Sets the pose of robot `robot` (index in the specification), independent of all other robots.
  void place(int robot, const Pose2& world_from_body, const Eigen::Matrix3d& covariance);
  /// Forgets the pose of `robot`.
  void remove(int robot);
  [[nodiscard]] bool is_placed(int robot) const { return placed_[index(robot)] != 0; }

  /// Additional noise of an increment that is a guess.
  struct GuessNoise {
    double scale = 1.0;         ///< factor of the increment's own variances
    double position_m2 = 0.0;   ///< variance added to each coordinate
    double heading_rad2 = 0.0;  ///< variance added to the heading
  };

  /// Moves all robots by `increments` (forward m, left m, turn rad; one per robot), which took
  /// `duration_s`. `guesses`: empty, or one per robot.
  void advance(double duration_s, std::span<const Eigen::Vector3d> increments,
               std::span<const GuessNoise> guesses = {});

  /// Uses the sightings of one frame of `robot`'s sensor.
  void observe(int robot, std::span<const models::Sighting> sightings);

  [[nodiscard]] int robots() const { return static_cast<int>(placed_.size()); }
  [[nodiscard]] Pose2 pose(int robot) const;
  [[nodiscard]] Eigen::Matrix3d covariance(int robot) const;
  /// Returns the ids of the landmarks in the state; kNoBodyId: not used yet.
  [[nodiscard]] std::span<const int> mapped() const { return mapped_; }
  /// Returns the position of landmark `index` of mapped().
  [[nodiscard]] Eigen::Vector2d landmark_m(int index) const {
    return x_.segment<2>(at_landmark(index));
  }
  [[nodiscard]] Eigen::Matrix2d landmark_covariance(int index) const {
    return P_.block<2, 2>(at_landmark(index), at_landmark(index));
  }
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
  /// A landmark or teammate.
  struct Body {
    bool is_known = false;  ///< false: there is no such body, or it has no position yet
    bool is_mate = false;
    int column = -1;  ///< index of the position in the state; −1: landmark at a known position
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
  };
  /// One usable sighting, linearised.
  struct Row {
    int column = -1;  ///< index of the body's position in the state; −1: known landmark
    bool is_mate = false;
    int id = kNoBodyId;
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, kRobotDim> by_own;
    Eigen::Matrix2d by_other;  ///< derivative with respect to the body's position
    Eigen::Matrix2d R;
    double weight = 1.0;  ///< factor of R⁻¹; 0: rejected
  };

  [[nodiscard]] static std::size_t index(int robot) { return static_cast<std::size_t>(robot); }
  [[nodiscard]] static int at(int robot) { return robot * kRobotDim; }
  [[nodiscard]] int at_landmark(int k) const { return at(robots()) + 2 * k; }
  void reset_errors(int robot);
  /// Returns the body with `id`. Sets `is_new` if it is an unknown landmark that can be mapped.
  [[nodiscard]] Body find_body(int id, bool& is_new) const;
  [[nodiscard]] Row row_of(int robot, const Pose2& world_from_body,
                           const models::Sighting& sighting, const Body& body) const;
  /// Adds the landmark of `sighting` to the state. Returns false if the sighting is too near to the
  /// sensor to determine its position.
  bool map_landmark(int robot, const models::Sighting& sighting);
  /// Removes a landmark from the state.
  void forget_landmark(int k);
  /// Fills rows_ from the usable sightings of `robot`.
  void linearise(int robot, std::span<const models::Sighting> sightings);
  /// Sets ids_ to the ids of `sightings`; those without an id get the id of the body that they fit.
  void associate(int robot, std::span<const models::Sighting> sightings);
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
  std::vector<int> ids_;                   ///< ids of the frame's sightings, workspace
  std::vector<CandidateBody> candidates_;  ///< workspace
  std::vector<int> mapped_;                ///< ids of the landmarks in the state
  std::vector<int> uses_;                  ///< number of used sightings of each landmark in mapped_
  FilterCounts counts_;
};

}  // namespace vantage::localizer

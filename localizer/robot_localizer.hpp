#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "localizer/commanded_motion.hpp"
#include "localizer/start_search.hpp"
#include "localizer/team_filter.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"

namespace vantage::localizer {

/// Duration of one increment: the grid of all motion that robots exchange.
inline constexpr Duration kIncrement = std::chrono::milliseconds(100);
/// Number of increments in a message. A teammate that receives no message for longer than this
/// loses data.
inline constexpr int kMessageIncrements = 20;
/// Largest number of sightings in a message.
inline constexpr int kMessageSightings = 64;

/// Counts of a localiser's inputs since its start.
struct InputCounts {
  std::int64_t late_sightings = 0;      ///< sightings that arrived after their step was completed
  std::int64_t missing_increments = 0;  ///< increments of teammates that were replaced by a guess
  std::int64_t refused = 0;             ///< inputs of an unknown robot, or out of order
  std::int64_t lost_sightings = 0;      ///< inputs dropped because a buffer was full
  std::int64_t late_fixes = 0;          ///< mocap poses that arrived after their step was completed
};

/// Localiser of one robot: the joint filter of the whole team, computed by each robot from what it
/// received. Robots exchange their motion and sightings (PoseEstimate), but no estimates, so
/// that no error is counted twice and cross-correlations are exact. A message repeats the last
/// kMessageIncrements increments, so that single losses lose no data.
///
/// Time is divided into steps of kIncrement. A base filter contains all data up to the time until
/// which the data of all teammates are complete. This time is at most kMessageIncrements steps ago.
/// advance_to() copies the base filter and adds the newer data. No function allocates memory after
/// construction, except write_message().
class RobotLocalizer {
 public:
  /// `robot`: index in the specification. @throws UsageError for an unknown index
  RobotLocalizer(const scenario::LocalizerSpec& spec, int robot);

  /// Sets the pose of a robot whose start is known. Precondition: before the first advance_to().
  void place(int robot, const Pose2& world_from_body, const Eigen::Matrix3d& covariance);

  /// Adds a command or an increment of this robot. Increments must follow each other.
  void add_odometry(const models::OdometryReport& odometry);
  /// Adds a frame of this robot's sensor; times in `sightings` are corrected for the latency.
  void add_sightings(std::span<const models::Sighting> sightings);
  /// Adds the data that a teammate sent.
  void add_teammate(const models::PoseEstimate& estimate);

  /// Adds a pose of any robot from motion capture. It replaces what the filter knows about the
  /// robot's pose at `time`, because its error is much smaller.
  void add_fix(int robot, Time time, const PoseBelief& fix);

  /// Computes the estimate at `now`, which is rounded down to the grid.
  void advance_to(Time now);

  [[nodiscard]] Time time() const { return now_; }
  [[nodiscard]] bool is_placed() const { return newest_.is_placed(robot_); }
  [[nodiscard]] Pose2 pose() const { return newest_.pose(robot_); }
  [[nodiscard]] Eigen::Matrix3d covariance() const { return newest_.covariance(robot_); }
  /// Returns the joint filter at time(): this robot's estimate of the whole team.
  [[nodiscard]] const TeamFilter& team() const { return newest_; }
  [[nodiscard]] const InputCounts& counts() const { return counts_; }
  /// Writes the pose at time() and the newest data for teammates. Does not set the stamp's run id
  /// and sequence number.
  void write_message(models::PoseEstimate& message) const;

 private:
  static constexpr int kCells = 64;       ///< number of increments kept per robot
  static constexpr int kSightings = 256;  ///< number of sightings kept per robot
  static constexpr int kFixes = 64;       ///< number of mocap poses kept per robot
  struct Cell {
    std::int64_t index = -1;  ///< start of the cell divided by kIncrement
    Eigen::Vector3d increment = Eigen::Vector3d::Zero();
  };
  /// A pose from motion capture.
  struct Fix {
    Time time{};
    PoseBelief belief;
  };
  /// Newest known motion and sightings of one robot.
  struct Track {
    std::array<Cell, kCells> cells;
    std::int64_t newest = -1;  ///< index of the newest known cell
    /// index of a cell; all cells before it, and their sightings, are known
    std::int64_t complete_until = -1;
    std::vector<models::Sighting> sightings;  ///< ascending in time; capacity kSightings
    std::vector<Fix> fixes;                   ///< ascending in time; capacity kFixes
    StartSearch search;
  };

  [[nodiscard]] static std::int64_t cell_of(Time time);
  [[nodiscard]] static Time start_of(std::int64_t cell);
  void add_increment(std::int64_t cell, Track& track, const Eigen::Vector3d& increment);
  void add_sighting(Track& track, const models::Sighting& sighting);
  /// Sets increments_ and guesses_ for the part [from, to) of grid cell `cell`.
  void set_increments(std::int64_t cell, Time from, Time to, bool is_base);
  /// A frame of sightings or a fix of one robot. If there is none, `robot` is the number of robots.
  struct Event {
    Time time{};
    std::size_t robot = 0;
    bool is_fix = false;
  };
  /// Sets next_sighting_ and next_fix_ to the first data at or after `time`.
  void seek(Time time);
  /// Returns the next data of any robot before `end`.
  [[nodiscard]] Event next_event(Time end) const;
  void apply(TeamFilter& filter, const Event& event, bool is_base);
  /// Moves `filter` through the grid cells [from, to) with all known sightings. Searches for starts
  /// if `is_base`.
  void run(TeamFilter& filter, std::int64_t from, std::int64_t to, bool is_base);
  void forget_before(Time time);
  [[nodiscard]] Track& own() { return tracks_[static_cast<std::size_t>(robot_)]; }
  [[nodiscard]] const Track& own() const { return tracks_[static_cast<std::size_t>(robot_)]; }

  scenario::LocalizerSpec spec_;
  int robot_;
  CommandedMotion motion_;
  /// displacement since the start of the cell that contains partial_to_
  Eigen::Vector3d partial_ = Eigen::Vector3d::Zero();
  Time partial_to_ = Time::min();  ///< end of the newest increment
  bool is_partial_whole_ = false;  ///< partial_ begins at the start of its cell
  bool is_commanded_ = true;       ///< false: the odometer reports increments
  std::vector<Track> tracks_;
  TeamFilter base_;
  TeamFilter newest_;
  std::int64_t first_cell_ = -1;  ///< cell of the first step
  std::int64_t base_cell_ = -1;
  std::int64_t now_cell_ = -1;
  Time now_{};
  Time last_observation_ = Time::min();      ///< time of the newest sighting or fix of this robot
  Time last_fix_ = Time::min();              ///< time of the newest fix of this robot
  std::vector<Eigen::Vector3d> increments_;  ///< workspace
  std::vector<TeamFilter::GuessNoise> guesses_;  ///< workspace
  std::vector<std::size_t> next_sighting_;       ///< workspace
  std::vector<std::size_t> next_fix_;            ///< workspace
  InputCounts counts_;
};

}  // namespace vantage::localizer

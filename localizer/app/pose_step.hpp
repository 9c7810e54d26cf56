#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "localizer/robot_localizer.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/scenario.hpp"

namespace vantage::localizer {

/// One input of a localizer with the name by which POSE_R refers to it.
struct PoseInput {
  models::InputRef ref;
  std::variant<
      std::shared_ptr<const models::OdometryReport>, std::shared_ptr<const models::SightingReport>,
      std::shared_ptr<const models::PoseEstimate>, std::shared_ptr<const models::MocapFrame>>
      content;
};

/// Steps of one robot's localizer. Live and replayed localizers use this class, so the same inputs
/// in the same order give the same bits.
class PoseSteps {
 public:
  /// POSE_R of even steps contains the motion and the sightings for teammates; POSE_R of odd steps
  /// contains only the pose.
  static constexpr std::int64_t kExchangeEvery = 2;
  /// Inputs may be newer than their step by the node's lag and by the offset between the clocks of
  /// hosts. Inputs that are still newer are refused: a false time in the future would block all
  /// later inputs of the same kind.
  static constexpr Duration kAheadMax = std::chrono::milliseconds(500);

  /// @throws UsageError when `scenario` or its section `localizer` has no such robot.
  PoseSteps(const scenario::Scenario& scenario, const std::string& robot);

  /// Adds `inputs` in their order and computes POSE_R for `t`. Only run id and sequence number of
  /// its stamp are not set.
  models::PoseEstimate step(Time t, std::int64_t step, const std::vector<PoseInput>& inputs);

  [[nodiscard]] const RobotLocalizer& localizer() const { return localizer_; }
  [[nodiscard]] const scenario::LocalizerSpec& spec() const { return spec_; }
  /// Returns the names of all other robots in the section `localizer`.
  [[nodiscard]] std::vector<std::string> teammates() const;
  /// True if `frame` contains the pose of a robot in the section `localizer`.
  [[nodiscard]] bool sees_a_robot(const models::MocapFrame& frame) const;
  /// Returns the counters of the localizer and of its filter.
  [[nodiscard]] std::vector<models::NamedCount> counters() const;

 private:
  // `limit`: inputs that are stamped later are refused and counted.
  void add(const models::OdometryReport& odometry, Time limit);
  void add(const models::SightingReport& report, Time limit);
  void add(const models::PoseEstimate& estimate, Time limit);
  void add(const models::MocapFrame& frame, Time limit);

  scenario::LocalizerSpec spec_;
  int robot_;
  Eigen::Matrix3d fix_covariance_;
  RobotLocalizer localizer_;
  std::vector<models::Sighting> corrected_;  ///< workspace
  std::int64_t too_new_ = 0;                 ///< inputs with a time too far in the future
};

}  // namespace vantage::localizer

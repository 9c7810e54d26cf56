#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "localizer/app/pose_step.hpp"
#include "scenario/scenario.hpp"

namespace vantage::localizer {

/// Bus node of a RobotLocalizer. Inputs are ODOMETRY_R, SIGHTINGS_R, the teammates' POSE_* and
/// VICON; the output is POSE_R.
///
/// A step belongs to an instant t on the grid of kIncrement and is computed kLag later, so that the
/// odometry of t has arrived. POSE_R has `utime` = t, `step` = the number of steps since the start,
/// and the names of all inputs, in the order of use. Each step uses only the newest frame of VICON.
class LocalizerNode : public bus::Node {
 public:
  /// Time from the instant of a step to its computation.
  static constexpr Duration kLag = std::chrono::milliseconds(20);

  /// @throws UsageError when `scenario` or its section `localizer` has no such robot.
  LocalizerNode(bus::Bus& bus, const bus::Clock& clock, const scenario::Scenario& scenario,
                const std::string& robot);

  [[nodiscard]] std::string name() const override { return "LOCALIZER_" + robot_; }
  [[nodiscard]] Time next_tick() const override { return next_instant_ + kLag; }
  void tick(Time now) override;
  /// Returns the counters of PoseSteps and these. inputs_overflowed: inputs dropped from a full
  /// queue. misaddressed: messages with a robot name that differs from that of their channel.
  /// mocap_out_of_order: mocap frames that are not newer than the previous one. mocap_too_new:
  /// mocap frames with a time too far in the future.
  [[nodiscard]] std::vector<models::NamedCount> counters() const override;
  /// Returns the number of instants of the grid without a step.
  [[nodiscard]] std::int64_t deadlines_missed() const override { return instants_missed_; }

  [[nodiscard]] const RobotLocalizer& localizer() const { return steps_.localizer(); }

 private:
  template <class Message>
  void subscribe(const bus::Channel<Message>& channel, const std::string& sender);
  void on_mocap(const std::shared_ptr<const models::MocapFrame>& frame);
  void add(PoseInput input);

  bus::Bus& bus_;
  std::string robot_;
  PoseSteps steps_;
  Time next_instant_;
  std::int64_t step_ = 0;
  std::deque<PoseInput> waiting_;                    ///< inputs of the next step
  std::shared_ptr<const models::MocapFrame> mocap_;  ///< newest frame that is not used yet
  Time last_mocap_ = Time::min();
  std::int64_t instants_missed_ = 0;
  std::int64_t inputs_overflowed_ = 0;
  std::int64_t misaddressed_ = 0;
  std::int64_t mocap_out_of_order_ = 0;
  std::int64_t mocap_too_new_ = 0;
};

}  // namespace vantage::localizer

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "models/exchange/onboard_pose.hpp"
#include "scenario/localizer_spec.hpp"
#include "scenario/scenario.hpp"
#include "sim/localisation/landmark_sensor.hpp"
#include "sim/localisation/mocap_outage.hpp"
#include "sim/localisation/odometer.hpp"
#include "sim/world/world_simulation.hpp"

namespace vantage::sim {

/// Simulated sensors of the scenario section localizer.simulation. Publishes ODOMETRY_R and
/// SIGHTINGS_R, withholds motion capture, and meanwhile makes Quadrotors fly by POSE_R.
class SimulatedLocalisation {
 public:
  /// Precondition: `spec.simulation` is present.
  SimulatedLocalisation(bus::Bus& bus, const scenario::Scenario& scenario,
                        const scenario::LocalizerSpec& spec, Time start);

  /// Returns the next instant at which publish() must be called.
  [[nodiscard]] Time next_instant() const;
  /// Publishes the messages that are due at `instant`, and sets the vehicles' assumed poses.
  /// Precondition: `world` has been stepped to `instant`.
  void publish(Time instant, WorldSimulation& world);
  /// Marks bodies that motion capture does not see.
  void hide(models::MocapFrame& frame, const models::TruthFrame& truth);
  [[nodiscard]] std::int64_t misaddressed() const { return misaddressed_; }

 private:
  struct Robot {
    std::string name;
    Odometer odometer;
    LandmarkSensor sensor;
    models::OnboardPose assumed;
    std::optional<Pose2> last;  ///< true pose at the previous report
  };
  void publish_odometry(Time instant, const models::TruthFrame& truth, WorldSimulation& world);

  bus::Bus& bus_;
  MocapOutage outage_;
  std::vector<Robot> robots_;
  Duration odometry_period_;
  Duration sightings_period_;
  Time next_odometry_;
  Time next_sightings_;
  std::int64_t misaddressed_ = 0;
};

}  // namespace vantage::sim

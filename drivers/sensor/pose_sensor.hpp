#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Returns all bodies at `time`, interpolated between two frames: positions linearly, attitudes by
/// spherical interpolation (slerp). A body that is absent or occluded in either frame is occluded
/// in the result. Precondition: before.stamp.time ≤ time ≤ after.stamp.time.
models::MocapFrame interpolate(const models::MocapFrame& before, const models::MocapFrame& after,
                               Time time);

/// Returns a random generator for noise, seeded by the arguments. `stream` is a target's id, or one
/// of the constants below.
std::mt19937_64 noise_of(std::uint64_t seed, const std::string& robot, int stream, Time time);
inline constexpr int kScanStream = -1;
inline constexpr int kClutterStream = -2;

/// Returns the mean horizontal velocity of body `name` from `earlier` to `frame`, in which the body
/// is at `position_m`. Nullopt if the body is absent or occluded in `earlier`, or if `earlier` is
/// not before `frame`.
std::optional<Eigen::Vector2d> velocity_since(const models::MocapFrame& earlier,
                                              const models::MocapFrame& frame,
                                              const std::string& name,
                                              const Eigen::Vector2d& position_m);

/// Returns a measurement of `robot` at the instant of `frame` without detections; nullopt if the
/// frame has no pose of the robot.
std::optional<models::RobotMeasurement> empty_measurement(const models::MocapFrame& frame,
                                                          const std::string& robot, bool jammed);

/// Simulated sensor of one robot: computes its measurements from the poses of all bodies.
///
/// Noise depends only on (seed, robot, target, instant). The measurement of an instant is therefore
/// the same if earlier frames are lost or the instant is replayed.
class PoseSensor {
 public:
  /// @throws UsageError for a robot that is not in the scenario.
  PoseSensor(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns one scan at the instant of `frame`. It has a measurement of each target that is
  /// unoccluded, in the field of view, in line of sight, and detected by the detection model. Under
  /// attack `jammed` is set and the scan is empty. A sensor without ids adds false alarms
  /// and sorts all measurements by value, so that their order does not identify targets. The caller
  /// sets run id, sequence and inputs. Returns nullopt if the frame has no pose of the robot.
  /// @param earlier  a frame before `frame`; a sensor that measures velocities computes each
  /// target's mean velocity since then, and reports no target that is absent or occluded in it.
  /// Null: such a sensor reports no target. Other sensors ignore it.
  [[nodiscard]] std::optional<models::RobotMeasurement> measure(
      const models::MocapFrame& frame, bool jammed,
      const models::MocapFrame* earlier = nullptr) const;

  /// True if measure() needs an earlier frame.
  [[nodiscard]] bool measures_velocity() const { return models::measures_velocity(sensor_); }

 private:
  /// Adds false alarms to `seen`, and removes everything that identifies targets.
  void anonymize(models::RobotMeasurement& seen) const;

  std::string robot_;
  models::SensorModel sensor_;
  models::DetectionModel detection_;
  models::World world_;
  std::vector<scenario::TargetSpec> targets_;
  int position_dim_;
  std::uint64_t seed_;
};

}  // namespace vantage::drivers

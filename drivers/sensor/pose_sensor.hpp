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

/// Returns all bodies at `time` between two frames: positions are interpolated linearly, attitudes
/// along the great circle. A body is occluded unless both frames show it. Precondition:
/// before.stamp.time ≤ time ≤ after.stamp.time.
models::MocapFrame interpolate(const models::MocapFrame& before, const models::MocapFrame& after,
                               Time time);

/// Returns a noise generator that depends only on the arguments. `stream` is a target's id, or one
/// of the constants below.
std::mt19937_64 noise_of(std::uint64_t seed, const std::string& robot, int stream, Time time);
inline constexpr int kScanStream = -1;
inline constexpr int kClutterStream = -2;

/// Returns the scan that `robot` begins at the instant of `frame`, without detections; nullopt if
/// the robot itself is not seen.
std::optional<models::RobotMeasurement> empty_measurement(const models::MocapFrame& frame,
                                                          const std::string& robot, bool jammed);

/// Simulated sensor of one robot: computes its measurements from the poses of all bodies.
///
/// Noise is a function of (seed, robot, target, instant) only, so a replayed instant gives the same
/// measurement whatever was missed before it.
class PoseSensor {
 public:
  /// @throws UsageError for a robot that is not in the scenario.
  PoseSensor(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns one scan at the instant of `frame`: a measurement of each target that is unoccluded,
  /// in view of the sensor model, in line of sight, and not missed by the detection model. Under
  /// attack there are no measurements and `jammed` is set. A sensor without ids adds false alarms
  /// and sorts all measurements by value, so that their order does not identify targets. The caller
  /// sets run id, sequence and inputs. nullopt if the robot itself is not seen.
  [[nodiscard]] std::optional<models::RobotMeasurement> measure(const models::MocapFrame& frame,
                                                                bool jammed) const;

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

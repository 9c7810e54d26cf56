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

/// All bodies at `time`, between two frames: positions linear, attitudes along the great circle.
/// A body takes part only when both frames have it unoccluded. Precondition:
/// before.stamp.time ≤ time ≤ after.stamp.time.
models::MocapFrame interpolate(const models::MocapFrame& before, const models::MocapFrame& after,
                               Time time);

/// Noise that is a function of these alone: `stream` is a target's id, or one of those below.
std::mt19937_64 noise_of(std::uint64_t seed, const std::string& robot, int stream, Time time);
inline constexpr int kScanStream = -1;
inline constexpr int kClutterStream = -2;

/// The look that `robot` begins at the instant of `frame`, of nothing yet; nullopt when the robot
/// itself is not seen.
std::optional<models::DetectionSet> look_of(const models::MocapFrame& frame,
                                            const std::string& robot, bool jammed);

/// A sensor that a lab does not have: it makes the measurements that one robot's sensor would,
/// from everyone's poses.
///
/// Noise is a function of (seed, robot, target, instant) alone, so a replayed instant gives the
/// same measurement whatever was missed before it.
class PoseSensor {
 public:
  /// @throws UsageError for a robot that is not in the scenario.
  PoseSensor(const scenario::Scenario& scenario, const std::string& robot);

  /// One look at the instant of `frame`: a measurement of every target body that is unoccluded,
  /// in view of the sensor model and in line of sight, and that the robot's detection model does
  /// not miss; none, and `jammed` set, under attack. Where it tells no ids, false alarms are among
  /// them and all are in the order of their own numbers, which says nothing of whose they are. Run
  /// id, sequence and inputs are left to the caller. nullopt when the robot itself is not seen.
  [[nodiscard]] std::optional<models::DetectionSet> look(const models::MocapFrame& frame,
                                                         bool jammed) const;

 private:
  /// Adds false alarms to what `seen` has, and leaves nothing that says which they are.
  void hide_names(models::DetectionSet& seen) const;

  std::string robot_;
  models::SensorModel sensor_;
  models::DetectionModel detection_;
  models::World world_;
  std::vector<scenario::TargetSpec> targets_;
  int position_dim_;
  std::uint64_t seed_;
};

}  // namespace vantage::drivers

#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Simulated range finder. It computes the ranges that the scenario's scanner measures from a pose
/// in the scenario's world. It does not detect other robots and targets.
///
/// Noise depends only on (seed, robot, instant), as in PoseSensor.
class RangeScanner {
 public:
  /// @throws UsageError for an invalid scanner.
  RangeScanner(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns one scan at `time` from `viewpoint`. Under attack, the scan has no ranges and `jammed`
  /// is set. The caller sets run id, sequence and inputs.
  [[nodiscard]] models::RangeScan scan(Time time, const models::Viewpoint& viewpoint,
                                       bool jammed) const;

 private:
  std::string robot_;
  models::World world_;
  models::BeamSensor scanner_;
  std::uint64_t seed_;
};

}  // namespace vantage::drivers

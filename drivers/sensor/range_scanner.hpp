#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// A range finder that a lab does not have: what the scenario's scanner would read from a pose in
/// the scenario's world. Other robots and targets do not show.
///
/// Noise is a function of (seed, robot, instant) alone, as of PoseSensor.
class RangeScanner {
 public:
  /// @throws UsageError for a scanner that makes no sense.
  RangeScanner(const scenario::Scenario& scenario, const std::string& robot);

  /// One scan at `time` from `viewpoint`; without ranges, and `jammed` set, under attack. Run id,
  /// sequence and inputs are left to the caller.
  [[nodiscard]] models::RangeScan scan(Time time, const models::Viewpoint& viewpoint,
                                       bool jammed) const;

 private:
  std::string robot_;
  models::World world_;
  models::BeamSensor scanner_;
  std::uint64_t seed_;
};

}  // namespace vantage::drivers

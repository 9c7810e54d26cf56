#pragma once

#include <cstdint>
#include <string>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::drivers {

/// Simulated range finder: the readings of the scenario's scanner from a pose in the scenario's
/// world. Other robots and targets are invisible to it.
///
/// Noise is a function of (seed, robot, instant) only, as in PoseSensor.
class RangeScanner {
 public:
  /// @throws UsageError for an invalid scanner.
  RangeScanner(const scenario::Scenario& scenario, const std::string& robot);

  /// Returns one scan at `time` from `viewpoint`; under attack without ranges and with `jammed`
  /// set. The caller sets run id, sequence and inputs.
  [[nodiscard]] models::RangeScan scan(Time time, const models::Viewpoint& viewpoint,
                                       bool jammed) const;

 private:
  std::string robot_;
  models::World world_;
  models::BeamSensor scanner_;
  std::uint64_t seed_;
};

}  // namespace vantage::drivers

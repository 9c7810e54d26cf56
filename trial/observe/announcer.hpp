#pragma once

#include <optional>
#include <string>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// Returns the version of this build: project version and commit hash.
std::string version();

/// Publisher of SCENARIO, immediately and every 5 s. A log thus begins with this message, and later
/// subscribers receive it too.
class Announcer {
 public:
  /// @param process name of the publisher in the message, for example "trial"
  Announcer(bus::Bus& bus, const scenario::Scenario& scenario, std::string process);
  /// Publishes if a publication is due; the first call always publishes.
  void tick(Time now);
  void publish(Time now);
  [[nodiscard]] Time next_tick() const { return next_; }

 private:
  bus::Bus& bus_;
  models::ScenarioNotice notice_;
  Time next_{};
};

}  // namespace vantage::trial

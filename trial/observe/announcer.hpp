#pragma once

#include <optional>
#include <string>

#include "bus/node/bus.hpp"
#include "core/time.hpp"
#include "scenario/scenario.hpp"

namespace vantage::trial {

/// The version of this build: project version and commit.
std::string version();

/// Publishes SCENARIO: now, and again every 5 s, so that a log begins with it and a late listener
/// learns it.
class Announcer {
 public:
  /// `process` names the publisher, for example "trial".
  Announcer(bus::Bus& bus, const scenario::Scenario& scenario, std::string process);
  /// Publishes when it is time to; the first call always does.
  void tick(Time now);
  void publish(Time now);
  [[nodiscard]] Time next_tick() const { return next_; }

 private:
  bus::Bus& bus_;
  models::ScenarioNotice notice_;
  Time next_{};
};

}  // namespace vantage::trial

#include "test/drivers/safety/fault_catalogue.hpp"

#include <algorithm>

#include "test/drivers/safety/fault_parts.hpp"

namespace vantage::test {

using models::FlightState;

namespace {

// Names of the faults for which Fault::needs_undisturbed_flight is set.
constexpr const char* kNeedQuiet[] = {"head-on at 2 m/s",
                                      "planner that repeatedly plans towards a teammate",
                                      "pushed aside by hand",
                                      "pushed towards the fence",
                                      "pushed through the fence",
                                      "estimate 0.5 m off",
                                      "estimate 1.5 m off",
                                      "stuck while moving",
                                      "stuck while hovering",
                                      "a stationary body has its name",
                                      "the autopilot reports another motion"};

}  // namespace

const std::vector<Fault>& fault_catalogue() {
  static const std::vector<Fault> kAll = [] {
    std::vector<Fault> all;
    std::vector<Fault> plan_faults = faults::plan_faults();
    for (Fault& fault : plan_faults) {
      fault.acts_through_plans = true;
    }
    for (const auto& part : {faults::mocap_faults(), plan_faults, faults::vehicle_faults(),
                             faults::operator_faults()}) {
      all.insert(all.end(), part.begin(), part.end());
    }
    for (Fault& fault : all) {
      for (const char* name : kNeedQuiet) {
        fault.needs_undisturbed_flight =
            fault.needs_undisturbed_flight || std::string(fault.name) == name;
      }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Fault& a, const Fault& b) { return a.number < b.number; });
    return all;
  }();
  return kAll;
}

int severity_of(FlightState state) {
  switch (state) {
    case FlightState::kFollow:
      return 0;
    case FlightState::kHold:
      return 1;
    case FlightState::kLand:
    case FlightState::kIdle:
      return 2;
    case FlightState::kKilled:
      return 3;
  }
  return 0;
}

}  // namespace vantage::test

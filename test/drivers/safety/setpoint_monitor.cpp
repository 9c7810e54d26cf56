#include "test/drivers/safety/setpoint_monitor.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace vantage::test {
namespace {

using models::FlightState;

constexpr double kInTimeS = 1.05;  // s; plans arrive once per second
constexpr double kSmoothed = 1.0 / 16.0;
constexpr double kRoundingM = 0.005;

}  // namespace

SetpointMonitor::Snapshot SetpointMonitor::snapshot_of(const Vehicle& vehicle) {
  const drivers::FlightSetpoint& commanded = vehicle.out.setpoint;
  Snapshot out;
  out.is_tracking = commanded.kind == drivers::FlightSetpoint::Kind::kTrack;
  out.asked_m = commanded.position_world_m.head<2>();
  out.state = vehicle.out.state;
  return out;
}

SetpointMonitor::SetpointMonitor(FlightBench& bench)
    : limits_(drivers::limits_for(FlightBench::scenario(), bench.vehicles().front().name)),
      corner_m_(0.5 * limits_.vehicle.speed_max_mps * drivers::half_window_s(limits_.vehicle)) {
  for (const Vehicle& vehicle : bench.vehicles()) {
    last_.push_back(snapshot_of(vehicle));
  }
}

double SetpointMonitor::step_max_m(const Vehicle& vehicle, const Snapshot& before) const {
  const drivers::SafetyInputs& in = vehicle.guard->inputs();
  const double distance_m =
      limits_.vehicle.speed_max_mps * std::max(FlightBench::kTickS, in.since_last_tick_s);
  const bool follows =
      vehicle.out.state == FlightState::kFollow && before.state == FlightState::kFollow;
  double more_m = corner_m_;
  if (in.plan_age_s < 0.5 * FlightBench::kTickS) {  // accepted at this tick
    more_m = limits_.plan_start_tolerance_m;
  } else if (follows && in.plan_age_s < kInTimeS) {
    more_m = kSmoothed * limits_.plan_start_tolerance_m;
  } else if (!follows) {
    const Eigen::Vector2d body_m = vehicle.guard->world_from_body().translation_m.head<2>();
    const bool is_at_body =
        (vehicle.out.setpoint.position_world_m.head<2>() - body_m).norm() <= kAtBodyM;
    more_m = is_at_body ? std::numeric_limits<double>::infinity() : corner_m_;
  }
  return distance_m + more_m + kRoundingM;
}

void SetpointMonitor::update(FlightBench& bench) {
  for (std::size_t i = 0; i < last_.size(); ++i) {
    const Vehicle& vehicle = bench.vehicles()[i];
    const Snapshot before = last_[i];
    Snapshot now = snapshot_of(vehicle);
    const double step_m = (now.asked_m - before.asked_m).norm();
    now.has_jumped = before.has_jumped;
    now.has_gone_back = before.has_gone_back;
    char words[120];
    if (!now.has_jumped && now.is_tracking && before.is_tracking &&
        !(step_m <= step_max_m(vehicle, before))) {
      now.has_jumped = true;
      std::snprintf(words, sizeof words, "%s in %s at %.2f s: its set-point jumps by %.3f m",
                    vehicle.name.c_str(), name_of(now.state), bench.time_s(), step_m);
      path_violations_.emplace_back(words);
    }
    const auto is_grounding = [](FlightState state) {
      return state != FlightState::kFollow && state != FlightState::kHold;
    };
    const bool goes_back =
        (is_grounding(before.state) && !is_grounding(now.state)) ||
        (before.state == FlightState::kKilled && now.state != FlightState::kKilled);
    if (!now.has_gone_back && goes_back) {
      now.has_gone_back = true;
      std::snprintf(words, sizeof words, "%s at %.2f s: from %s to %s", vehicle.name.c_str(),
                    bench.time_s(), name_of(before.state), name_of(now.state));
      path_violations_.emplace_back(words);
    }
    last_[i] = now;
  }
}

}  // namespace vantage::test

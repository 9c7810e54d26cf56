#pragma once

#include <string_view>

#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/wire_check.hpp"

namespace vantage::logs {

/// True for the channels of planner.algorithm `external`. Their messages are requests to an
/// external planner and its answers: they have the type of plans, but a robot does not fly them.
inline bool is_external(std::string_view channel) { return channel.starts_with("EXTERNAL_"); }

/// Decodes the message in `event` by its fingerprint and calls `visit` with it as a type of
/// models/exchange. Returns false if it is not a vantage message, cannot be decoded, has invalid
/// values, or if the channel is_external().
template <class Visit>
bool visit_message(const LogEvent& event, Visit&& visit) {
  const bus::WireSchema* schema = type_of(event.data);
  if (schema == nullptr || is_external(event.channel)) {
    return false;
  }
  bool was_visited = false;
  const auto attempt = [&]<class Wire>() {
    if (was_visited || schema->name != std::string_view(Wire::getTypeName())) {
      return;
    }
    if (const auto wire = bus::decode_wire<Wire>(event.data)) {
      if (const auto message = bus::from_wire(*wire)) {
        visit(*message);
        was_visited = true;
      }
    }
  };
  const auto attempt_all = [&]<class... Wire>() { (attempt.template operator()<Wire>(), ...); };
  attempt_all.template
  operator()<vantage_lcm::mocap_frame_t, vantage_lcm::truth_t, vantage_lcm::measurement_t,
             vantage_lcm::odometry_t, vantage_lcm::sightings_t, vantage_lcm::pose_estimate_t,
             vantage_lcm::belief_t, vantage_lcm::compact_belief_t, vantage_lcm::mixture_t,
             vantage_lcm::scan_t, vantage_lcm::map_t, vantage_lcm::plan_t, vantage_lcm::proposal_t,
             vantage_lcm::team_proposal_t, vantage_lcm::vehicle_t, vantage_lcm::health_t,
             vantage_lcm::command_t, vantage_lcm::collision_t, vantage_lcm::attack_t,
             vantage_lcm::host_t, vantage_lcm::scenario_t>();
  return was_visited;
}

}  // namespace vantage::logs

#pragma once

#include <string_view>

#include "bus/convert/convert.hpp"
#include "bus/convert/wire_walk.hpp"
#include "logs/file/log_event.hpp"
#include "logs/file/wire_witness.hpp"

namespace vantage::logs {

/// Whether a channel is of planner.algorithm `external`: what others are asked for and answer is no
/// plan of the robot's, though it looks like one.
inline bool is_external(std::string_view channel) { return channel.starts_with("EXTERNAL_"); }

/// Calls `visit` with the message in `event` as a value of models/exchange, by the type that its
/// data name. False when it is none of the house's, does not decode or cannot be true, and for a
/// channel that is_external().
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
  operator()<vantage_lcm::vicon_frame_t, vantage_lcm::truth_t, vantage_lcm::measurement_t,
             vantage_lcm::belief_t, vantage_lcm::mixture_t, vantage_lcm::scan_t, vantage_lcm::map_t,
             vantage_lcm::plan_t, vantage_lcm::proposal_t, vantage_lcm::team_proposal_t,
             vantage_lcm::quadrotor_t, vantage_lcm::health_t, vantage_lcm::command_t,
             vantage_lcm::collision_t, vantage_lcm::attack_t, vantage_lcm::host_t,
             vantage_lcm::scenario_t>();
  return was_visited;
}

}  // namespace vantage::logs

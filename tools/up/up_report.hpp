#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/up/up.hpp"

namespace vantage::tools {

/// True if all of these conditions are met:
/// - no process was given up, killed or ended badly, and this program had no error;
/// - nothing collided, and all vehicles have flown and landed;
/// - the simulator was not restarted (restarts of other processes are permitted);
/// - the log is complete, and no other scenario was flown on the network.
bool is_good(const UpResult& result);

/// Returns the remarks to print in addition to the summary: losses, restarts and errors.
std::vector<std::string> remarks(const UpResult& result);

/// Returns the number of COLLISION messages that a Bus with these counters refused because of their
/// signatures.
std::int64_t contacts_unverified(const std::vector<models::NamedCount>& counters);

/// Returns the summary's keys, then `restarts`, `given_up`, `processes` (those that ended during
/// the trial), `world_restarts`, `log`, `killed`, `cut_short`, `ended_badly`, `never_flown`,
/// `left_flying`, `contacts_unverified`, `other_scenario`, `broken`, `stop_s`.
nlohmann::ordered_json to_json(const UpResult& result);

}  // namespace vantage::tools

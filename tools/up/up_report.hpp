#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/up/up.hpp"

namespace vantage::tools {

/// True if the result has no fault: no process given up, killed or ended badly, no collision, no
/// restart of the simulator, a complete log, and all vehicles flown and landed. Restarts of other
/// processes are no fault.
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

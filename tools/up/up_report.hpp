#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tools/up/up.hpp"

namespace vantage::tools {

/// Nothing was given up or had to be killed, nothing collided, the world is one, the log has its
/// end, and what was to fly has flown and landed. Restarts alone do not spoil a trial.
bool is_good(const UpResult& result);

/// What is to be said besides the summary: losses, restarts, what went wrong. Empty: nothing.
std::vector<std::string> remarks(const UpResult& result);

/// Returns how many COLLISION messages a Bus with these counters refused by their signatures.
std::int64_t contacts_unverified(const std::vector<models::NamedCount>& counters);

/// The summary's keys, then `log`, `processes` (those that ended during the trial), `restarts`,
/// `given_up`, `world_restarts`, `killed`, `ended_badly`, `never_flown`, `left_flying`,
/// `contacts_unverified`, `other_scenario`, `broken`, `stop_s`.
nlohmann::ordered_json to_json(const UpResult& result);

}  // namespace vantage::tools

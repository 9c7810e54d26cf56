#pragma once

#include <chrono>

#include "core/time.hpp"

namespace vantage::models {

/// Time after which an attack without further ATTACK messages is over. It equals three periods of
/// the ATTACK message, which the simulator sends once per second (lcmtypes/README.md).
inline constexpr Duration kAttackTimeout = std::chrono::seconds(3);

}  // namespace vantage::models

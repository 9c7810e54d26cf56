#pragma once

#include <chrono>

#include "core/time.hpp"

namespace vantage::models {

/// Timeout of an attack: the simulator publishes ATTACK once per second (lcmtypes/README.md).
/// Receivers assume that an attack has ended three missed repetitions after its last message.
inline constexpr Duration kAttackKept = std::chrono::seconds(3);

}  // namespace vantage::models

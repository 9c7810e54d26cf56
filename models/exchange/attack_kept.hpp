#pragma once

#include <chrono>

#include "core/time.hpp"

namespace vantage::models {

/// Three of the simulator's repetitions of ATTACK, one a second (lcmtypes/README.md): an attack
/// that is not heard of again for so long is over, with whoever said it.
inline constexpr Duration kAttackKept = std::chrono::seconds(3);

}  // namespace vantage::models

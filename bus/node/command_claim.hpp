#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "bus/auth/authenticator.hpp"

namespace vantage::bus {

/// Reads what a command states before anything of it is proven. `own`: the vehicle that this
/// process is, or empty. nullopt: another channel than COMMAND, or an unreadable payload.
std::optional<auth::Authenticator::CommandClaim> claim_of(std::string_view channel,
                                                          std::span<const std::uint8_t> bytes,
                                                          std::string_view own);

}  // namespace vantage::bus

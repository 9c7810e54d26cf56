#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "bus/auth/authenticator.hpp"

namespace vantage::bus {

/// Returns the unverified content of a command. `own`: vehicle name of this process, or empty.
/// Returns nullopt if the channel is not COMMAND or the payload is unreadable.
std::optional<auth::Authenticator::CommandClaim> claim_of(std::string_view channel,
                                                          std::span<const std::uint8_t> bytes,
                                                          std::string_view own);

}  // namespace vantage::bus

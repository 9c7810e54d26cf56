#pragma once

#include "bus/convert/wire_walk.hpp"
#include "logs/file/log_scan.hpp"

namespace vantage::logs {

/// The house's message type whose fingerprint `data` begin with; nullptr for any other.
const bus::WireSchema* type_of(std::span<const std::uint8_t> data);

/// Testifies for the house's own types: their lengths must add up exactly. Other types: kNone.
Testimony wire_testimony(const LogEvent& event);

}  // namespace vantage::logs

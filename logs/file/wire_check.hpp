#pragma once

#include "bus/convert/wire_walk.hpp"
#include "logs/file/log_scan.hpp"

namespace vantage::logs {

/// Returns the vantage message type with the fingerprint at the start of `data`; nullptr if there
/// is none.
const bus::WireSchema* type_of(std::span<const std::uint8_t> data);

/// Checks that the lengths inside a vantage message are consistent. Returns kNone for other types.
DataCheck check_wire_data(const LogEvent& event);

}  // namespace vantage::logs

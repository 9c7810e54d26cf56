#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "bus/convert/wire_walk.hpp"

// Conversion of every vantage message to JSON with the field names of its .lcm file. It uses
// layouts that are generated from these files, so a new type needs no code here.

namespace vantage::logs {

/// Returns `message` (with its fingerprint, signed or unsigned) as an object with its members in
/// wire order; nullopt if it is not a well-formed vantage message. Non-finite numbers become null
/// because JSON has no such numbers.
std::optional<nlohmann::ordered_json> message_json(std::span<const std::uint8_t> message);

/// Overload for a message of type `schema`, which need not be a vantage type.
std::optional<nlohmann::ordered_json> message_json(std::span<const std::uint8_t> message,
                                                   const bus::WireSchema& schema);

/// Returns `json` on one line. Bytes that are not UTF-8 are replaced.
std::string dumped(const nlohmann::ordered_json& json);

/// Returns the JSON schema (draft 2020-12) of message_json()'s results for messages of type
/// `schema`. Matrices are omitted: Foxglove viewers refuse schemas with nested lists, but display
/// members that the schema does not mention.
nlohmann::ordered_json json_schema(const bus::WireSchema& schema);

}  // namespace vantage::logs

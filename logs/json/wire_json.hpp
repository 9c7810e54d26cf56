#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "bus/convert/wire_walk.hpp"

// Every message of the house as JSON with the names of its .lcm file, from the layouts that are
// generated from those files: a new type needs nothing here.

namespace vantage::logs {

/// The message in `message` (fingerprint included, signed or not) as an object whose members stand
/// in wire order; nullopt when it is none of the house's or not well formed. Numbers that are not
/// finite are null, as JSON has none.
std::optional<nlohmann::ordered_json> message_json(std::span<const std::uint8_t> message);

/// The same of a message whose fingerprint says that it is one of `schema`, the house's or not.
std::optional<nlohmann::ordered_json> message_json(std::span<const std::uint8_t> message,
                                                   const bus::WireSchema& schema);

/// On one line; what is not UTF-8 in it is replaced.
std::string dumped(const nlohmann::ordered_json& json);

/// The JSON schema (draft 2020-12) of message_json()'s answers for messages of type `schema`. Of
/// matrices it says nothing: Foxglove's viewers refuse a channel whose schema has lists of lists,
/// and show what a schema does not mention.
nlohmann::ordered_json json_schema(const bus::WireSchema& schema);

}  // namespace vantage::logs

#pragma once

#include <cstdint>
#include <string>

// The kinds of message that viewers are told: the well-known ones of the Foxglove schemas, which
// their 3D and log panels draw as they are, and a few of our own for numbers. All are JSON text.

namespace vantage::logs::foxglove {

enum class Schema : std::uint8_t {
  kSceneUpdate,
  kGrid,
  kFrameTransforms,
  kLog,
  kScenario,  ///< the world and who is in it
  kTeam,      ///< how well the team knows its targets
  kPlan,      ///< one plan in numbers
  kVehicle,   ///< one vehicle's state with its reasons
  kHealth,    ///< one process
  kAttack,    ///< who is jammed
  kLcm,       ///< a message as it is on the bus, with the names of its .lcm file
};

inline constexpr Schema kSchemas[] = {
    Schema::kSceneUpdate, Schema::kGrid,     Schema::kFrameTransforms,
    Schema::kLog,         Schema::kScenario, Schema::kTeam,
    Schema::kPlan,        Schema::kVehicle,  Schema::kHealth,
    Schema::kAttack,      Schema::kLcm};

/// "foxglove.SceneUpdate", … for the well-known ones; "vantage.Team", … for ours.
const char* name_of(Schema schema);

/// Its JSON Schema (draft 2020-12) as text: what `schema` of a channel is with `schemaEncoding`
/// "jsonschema".
/// Source: the members of the Foxglove schemas; ours are written where they are made.
const std::string& json_schema(Schema schema);

}  // namespace vantage::logs::foxglove

#pragma once

#include <cstdint>
#include <string>

// Message types for viewers: Foxglove schemas, which the 3D and log panels display directly, and
// vantage's own schemas for numbers. All are JSON text.

namespace vantage::logs::foxglove {

enum class Schema : std::uint8_t {
  kSceneUpdate,
  kGrid,
  kFrameTransforms,
  kLog,
  kScenario,  ///< world, robots and targets
  kTeam,      ///< quality of the team's estimates
  kTargets,   ///< discovery and present estimate of each target
  kPlan,      ///< cost, bound and times of one plan
  kVehicle,   ///< state of one vehicle with reasons
  kHealth,    ///< state of one process
  kAttack,    ///< jammed robots
  kLcm,       ///< an unchanged bus message, with the names of its .lcm file
};

inline constexpr Schema kSchemas[] = {
    Schema::kSceneUpdate, Schema::kGrid,   Schema::kFrameTransforms, Schema::kLog,
    Schema::kScenario,    Schema::kTeam,   Schema::kTargets,         Schema::kPlan,
    Schema::kVehicle,     Schema::kHealth, Schema::kAttack,          Schema::kLcm};

/// Returns "foxglove.SceneUpdate", … for Foxglove schemas; "vantage.Team", … for vantage's own.
const char* name_of(Schema schema);

/// Returns the JSON Schema (draft 2020-12) as text, for the field `schema` of a channel with
/// `schemaEncoding` "jsonschema".
/// Source: the members of the Foxglove schemas; vantage's own schemas are defined with their code.
const std::string& json_schema(Schema schema);

}  // namespace vantage::logs::foxglove

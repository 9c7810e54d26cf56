#include "logs/foxglove/schema.hpp"

#include <map>
#include <utility>

#include <nlohmann/json.hpp>

namespace vantage::logs::foxglove {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson number() { return {{"type", "number"}}; }
OrderedJson integer() { return {{"type", "integer"}}; }
OrderedJson text() { return {{"type", "string"}}; }
OrderedJson boolean() { return {{"type", "boolean"}}; }
OrderedJson list_of(OrderedJson items) { return {{"type", "array"}, {"items", std::move(items)}}; }
OrderedJson object(OrderedJson properties) {
  return {{"type", "object"}, {"properties", std::move(properties)}};
}

OrderedJson time() { return object({{"sec", integer()}, {"nsec", integer()}}); }
OrderedJson bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }
OrderedJson vector3() { return object({{"x", number()}, {"y", number()}, {"z", number()}}); }
OrderedJson quaternion() {
  return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}});
}
OrderedJson pose() { return object({{"position", vector3()}, {"orientation", quaternion()}}); }
OrderedJson colour() {
  return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}});
}
OrderedJson key_value() { return object({{"key", text()}, {"value", text()}}); }
OrderedJson counter() { return object({{"name", text()}, {"count", integer()}}); }

OrderedJson scene_entity() {
  const OrderedJson box = object({{"pose", pose()}, {"size", vector3()}, {"color", colour()}});
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"id", text()},
                 {"lifetime", time()},
                 {"frame_locked", boolean()},
                 {"metadata", list_of(key_value())},
                 {"arrows", list_of(object({{"pose", pose()},
                                            {"shaft_length", number()},
                                            {"shaft_diameter", number()},
                                            {"head_length", number()},
                                            {"head_diameter", number()},
                                            {"color", colour()}}))},
                 {"cubes", list_of(box)},
                 {"spheres", list_of(box)},
                 {"cylinders", list_of(object({{"pose", pose()},
                                               {"size", vector3()},
                                               {"bottom_scale", number()},
                                               {"top_scale", number()},
                                               {"color", colour()}}))},
                 {"lines", list_of(object({{"type", integer()},
                                           {"pose", pose()},
                                           {"thickness", number()},
                                           {"scale_invariant", boolean()},
                                           {"points", list_of(vector3())},
                                           {"color", colour()},
                                           {"colors", list_of(colour())},
                                           {"indices", list_of(integer())}}))},
                 {"triangles", list_of(object({{"pose", pose()},
                                               {"points", list_of(vector3())},
                                               {"color", colour()},
                                               {"colors", list_of(colour())},
                                               {"indices", list_of(integer())}}))},
                 {"texts", list_of(object({{"pose", pose()},
                                           {"billboard", boolean()},
                                           {"font_size", number()},
                                           {"scale_invariant", boolean()},
                                           {"color", colour()},
                                           {"text", text()}}))},
                 {"models", list_of(object({{"pose", pose()},
                                            {"scale", vector3()},
                                            {"color", colour()},
                                            {"override_color", boolean()},
                                            {"url", text()},
                                            {"media_type", text()},
                                            {"data", bytes()}}))}});
}

OrderedJson frame_transform() {
  return object({{"timestamp", time()},
                 {"parent_frame_id", text()},
                 {"child_frame_id", text()},
                 {"translation", vector3()},
                 {"rotation", quaternion()}});
}

OrderedJson well_known(Schema schema) {
  switch (schema) {
    case Schema::kSceneUpdate:
      return object(
          {{"deletions",
            list_of(object({{"timestamp", time()}, {"type", integer()}, {"id", text()}}))},
           {"entities", list_of(scene_entity())}});
    case Schema::kGrid:
      return object(
          {{"timestamp", time()},
           {"frame_id", text()},
           {"pose", pose()},
           {"column_count", integer()},
           {"cell_size", object({{"x", number()}, {"y", number()}})},
           {"row_stride", integer()},
           {"cell_stride", integer()},
           {"fields",
            list_of(object({{"name", text()}, {"offset", integer()}, {"type", integer()}}))},
           {"data", bytes()}});
    case Schema::kFrameTransforms:
      return object({{"transforms", list_of(frame_transform())}});
    default:  // kLog
      return object({{"timestamp", time()},
                     {"level", integer()},
                     {"message", text()},
                     {"name", text()},
                     {"file", text()},
                     {"line", integer()}});
  }
}

// Long function: it contains a table with one entry per schema.
OrderedJson vantage_schema(Schema schema) {
  const OrderedJson point = list_of(number());
  const OrderedJson rectangle = object({{"min_m", point}, {"max_m", point}});
  switch (schema) {
    case Schema::kScenario:
      return object(
          {{"timestamp", time()},
           {"name", text()},
           {"version", text()},
           {"process", text()},
           {"session", text()},
           {"yaml", text()},
           {"objective", text()},
           {"grid_memory_s", number()},
           {"duration_s", number()},
           {"ceiling_m", number()},
           {"bounds", rectangle},
           {"robots", list_of(object({{"name", text()},
                                      {"color", colour()},
                                      {"height_m", number()},
                                      {"radius_m", number()},
                                      {"sensor_range_m", number()},
                                      {"fov_rad", number()}}))},
           {"targets",
            list_of(object({{"name", text()}, {"id", integer()}, {"radius_m", number()}}))}});
    case Schema::kTeam:
      return object(
          {{"timestamp", time()},
           {"entropy_nats", number()},
           {"map_entropy_nats", number()},
           {"rmse_m", number()},
           {"robot_entropy_nats", number()},
           {"robot_rmse_m", number()},
           {"nees_by_age",
            list_of(object({{"age_s", text()}, {"samples", integer()}, {"mean", number()}}))},
           {"nees_expected", integer()},
           {"known", integer()},
           {"targets", integer()},
           {"collisions", integer()},
           {"separation_violations", integer()},
           {"rounds", integer()},
           {"rounds_late", integer()},
           {"messages_lost", integer()}});
    case Schema::kTargets:
      return object({{"timestamp", time()},
                     {"targets", list_of(object({{"name", text()},
                                                 {"state", text()},
                                                 {"found_s", number()},
                                                 {"found_by", text()},
                                                 {"error_m", number()},
                                                 {"sigma_m", number()},
                                                 {"seen_by", text()},
                                                 {"unseen_s", number()}}))}});
    case Schema::kPlan:
      return object({{"timestamp", time()},
                     {"robot", text()},
                     {"round", integer()},
                     {"source", text()},
                     {"cost_nat", number()},
                     {"lower_bound_nat", number()},
                     {"gap_nat", number()},
                     {"epsilon", number()},
                     {"delta_m", number()},
                     {"passes", integer()},
                     {"nodes", integer()},
                     {"margin_s", number()},
                     {"late", boolean()}});
    case Schema::kVehicle:
      return object({{"timestamp", time()},
                     {"robot", text()},
                     {"state", text()},
                     {"battery_share", number()},
                     {"plan_round", integer()},
                     {"setpoint", object({{"x_m", number()},
                                          {"y_m", number()},
                                          {"yaw_rad", number()},
                                          {"height_m", number()}})},
                     {"capture_to_setpoint_s", number()},
                     {"reasons", list_of(text())}});
    case Schema::kHealth:
      return object({{"timestamp", time()},
                     {"process", text()},
                     {"state", text()},
                     {"loops", integer()},
                     {"loop_worst_s", number()},
                     {"deadlines_missed", integer()},
                     {"messages_lost", integer()},
                     {"counters", list_of(counter())}});
    case Schema::kLcm:
      return {{"type", "object"}};  // schema of the message's own type
    default:                        // kAttack
      return object({{"timestamp", time()}, {"jammed", list_of(text())}});
  }
}

}  // namespace

const char* name_of(Schema schema) {
  switch (schema) {
    case Schema::kSceneUpdate:
      return "foxglove.SceneUpdate";
    case Schema::kGrid:
      return "foxglove.Grid";
    case Schema::kFrameTransforms:
      return "foxglove.FrameTransforms";
    case Schema::kLog:
      return "foxglove.Log";
    case Schema::kScenario:
      return "vantage.Scenario";
    case Schema::kTeam:
      return "vantage.Team";
    case Schema::kTargets:
      return "vantage.Targets";
    case Schema::kPlan:
      return "vantage.Plan";
    case Schema::kVehicle:
      return "vantage.Vehicle";
    case Schema::kHealth:
      return "vantage.Health";
    case Schema::kAttack:
      return "vantage.Attack";
    case Schema::kLcm:
      return "vantage.Lcm";
  }
  return "";
}

const std::string& json_schema(Schema schema) {
  static const std::map<Schema, std::string> texts = [] {
    std::map<Schema, std::string> made;
    for (const Schema each : kSchemas) {
      OrderedJson document = each <= Schema::kLog ? well_known(each) : vantage_schema(each);
      document["title"] = name_of(each);
      document["$schema"] = "https://json-schema.org/draft/2020-12/schema";
      made[each] = document.dump();
    }
    return made;
  }();
  return texts.at(schema);
}

}  // namespace vantage::logs::foxglove

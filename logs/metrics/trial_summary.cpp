#include "logs/metrics/trial_summary.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::ordered_json;

Json optional_number(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json optional_numbers(const std::vector<std::optional<double>>& values) {
  Json out = Json::array();
  for (const std::optional<double>& value : values) {
    out.push_back(optional_number(value));
  }
  return out;
}

Json to_json(const Consistency& consistency) {
  Json out;
  out["samples"] = consistency.samples;
  out["mean"] = optional_number(consistency.mean_nees);
  out["median"] = optional_number(consistency.median_nees);
  out["coverage_95"] = optional_number(consistency.coverage_95);
  return out;
}

Json to_json(const PoseMeans& poses) {
  Json out;
  out["samples"] = poses.samples;
  out["unknown"] = poses.unknown;
  out["rmse_m"] = optional_number(poses.rmse_m);
  out["error_max_m"] = optional_number(poses.error_max_m);
  out["heading_rmse_rad"] = optional_number(poses.heading_rmse_rad);
  out["position_nees"] = optional_number(poses.position_nees);
  return out;
}

}  // namespace

Json to_json(const TrialSummary& summary) {
  Json out;
  out["seed"] = summary.seed;
  out["duration_s"] = summary.duration_s;
  out["collisions"] = summary.collisions;
  out["separation_violations"] = summary.separation_violations;
  out["min_separation_m"] = optional_number(summary.min_separation_m);
  out["discovered"] = summary.discovered;
  out["targets"] = summary.targets;
  out["discovery_time_s"] = optional_numbers(summary.discovery_time_s);
  out["rmse_m"] = optional_number(summary.rmse_m);
  out["entropy"] = summary.entropy_nats;
  out["rounds"] = summary.rounds;
  out["rounds_late"] = summary.rounds_late;
  out["fallbacks"] = summary.fallbacks;
  out["messages_lost"] = summary.messages_lost;
  out["scenario"] = summary.scenario;
  out["algorithm"] = summary.algorithm;
  out["plans"] = summary.plans;
  out["plans_missing"] = summary.plans_missing;
  out["energy"] = summary.energy_nats;
  out["undiscovered_share"] = summary.undiscovered_share;
  out["rmse_per_target_m"] = optional_numbers(summary.rmse_per_target_m);
  out["entropy_per_target"] = summary.entropy_per_target_nats;
  out["position_nees"] = optional_number(summary.position_nees);
  nlohmann::ordered_json per_robot;
  per_robot["rmse_m"] = optional_number(summary.per_robot.rmse_m);
  per_robot["entropy"] = summary.per_robot.entropy_nats;
  per_robot["discovered"] = summary.per_robot.discovered;
  per_robot["discovery_time_s"] = summary.per_robot.discovery_time_s;
  per_robot["undiscovered_share"] = summary.per_robot.undiscovered_share;
  per_robot["nees"] = to_json(summary.per_robot.consistency);
  Json by_age = Json::array();
  for (std::size_t i = 0; i < kAgeClasses; ++i) {
    Json entry;
    entry["unseen_from_s"] = kAgeEdges_s[i];
    entry.update(to_json(summary.per_robot.consistency_by_age[i]));
    by_age.push_back(std::move(entry));
  }
  per_robot["nees_by_age"] = std::move(by_age);
  out["per_robot"] = std::move(per_robot);
  out["map_entropy"] = optional_number(summary.map_entropy_nats);
  if (summary.poses.samples > 0 || summary.poses.unknown > 0) {
    out["poses"] = to_json(summary.poses);
  }
  return out;
}

}  // namespace vantage::logs

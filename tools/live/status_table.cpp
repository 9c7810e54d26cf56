#include "tools/live/status_table.hpp"

#include <fmt/format.h>

#include "models/scenario/search_name.hpp"

namespace vantage::tools {
namespace {

std::string cell(const std::optional<double>& value, int decimals, const char* unit) {
  return value ? fmt::format("{:.{}f} {}", *value, decimals, unit) : "-";
}

std::string target_row(const logs::TargetStatus& target) {
  std::optional<double> sigma_m;
  std::string by = "-";
  if (target.estimate) {
    sigma_m = target.estimate->sigma_m();
    by = target.estimate->robot;
  }
  return fmt::format("{:<8} {:>10} {:>9} {:>9} {:>10.2f} nat  {}", target.name,
                     cell(target.discovered_s, 1, "s"), cell(target.error_m, 2, "m"),
                     cell(sigma_m, 2, "m"), target.entropy_nats, by);
}

std::string robot_row(const std::string& name, const logs::RobotStatus& robot) {
  const std::string state = robot.state ? models::name_of(*robot.state) : "-";
  if (!robot.plan) {
    return fmt::format("{:<8} {:>8} {:>7}", name, state, "-");
  }
  const models::RobotPlan& plan = *robot.plan;
  const double slot_s = to_seconds(plan.deadline - plan.slot_start);
  const double used_s = to_seconds(plan.finish - plan.slot_start);
  return fmt::format("{:<8} {:>8} {:>7} {:>9} {:>9.2f} {:>9} {:>8.0f} %", name, state,
                     plan.round % 100'000, models::name_of(plan.source), plan.cost, plan.nodes,
                     slot_s > 0.0 ? 100.0 * used_s / slot_s : 0.0);
}

}  // namespace

std::vector<std::string> status_table(const models::Scenario& scenario,
                                      const logs::TrialMetrics& metrics, double elapsed_s) {
  std::vector<std::string> out;
  out.push_back(fmt::format("{} with {}   {:.0f} s of {:g} s", scenario.name,
                            models::search_name(scenario.planner), elapsed_s, scenario.duration_s));
  out.emplace_back();
  out.push_back(fmt::format("{:<8} {:>10} {:>9} {:>9} {:>14}  {}", "target", "found at", "error",
                            "sigma", "entropy", "best known by"));
  for (const logs::TargetStatus& target : metrics.targets()) {
    out.push_back(target_row(target));
  }
  out.emplace_back();
  out.push_back(fmt::format("{:<8} {:>8} {:>7} {:>9} {:>9} {:>9} {:>10}", "robot", "state", "round",
                            "plan", "cost nat", "nodes", "slot used"));
  for (const auto& [name, robot] : metrics.robots()) {
    out.push_back(robot_row(name, robot));
  }
  out.emplace_back();
  out.push_back(
      fmt::format("rounds {}   late {}   collisions {}   near misses {}   messages lost {}",
                  metrics.rounds(), metrics.rounds_late(), metrics.collisions(),
                  metrics.separation_violations(), metrics.messages_lost()));
  return out;
}

std::string status_line(const logs::TrialMetrics& metrics, double elapsed_s) {
  const std::optional<double> map_nats = metrics.map_entropy_nats();
  int found = 0;
  for (const logs::TargetStatus& target : metrics.targets()) {
    found += target.discovered_s ? 1 : 0;
  }
  return fmt::format(
      "{:6.1f} s   found {}/{}   rounds {}   late {}   collisions {}   messages lost {}{}",
      elapsed_s, found, metrics.targets().size(), metrics.rounds(), metrics.rounds_late(),
      metrics.collisions(), metrics.messages_lost(),
      map_nats ? fmt::format("   map {:.0f} nat", *map_nats) : "");
}

std::vector<std::string> summary_table(const models::Scenario& scenario,
                                       const logs::TrialSummary& summary) {
  std::vector<std::string> out;
  out.push_back(fmt::format("{} with {}, seed {}, {:.1f} s", summary.scenario, summary.algorithm,
                            summary.seed, summary.duration_s));
  out.push_back(
      fmt::format("{:<8} {:>14} {:>9} {:>14}", "target", "discovered at", "RMSE", "mean entropy"));
  for (std::size_t i = 0; i < scenario.targets.size(); ++i) {
    out.push_back(fmt::format(
        "{:<8} {:>14} {:>9} {:>10.2f} nat", scenario.targets[i].name,
        summary.discovery_time_s[i] ? cell(summary.discovery_time_s[i], 1, "s")
                                    : std::string("never"),
        cell(summary.rmse_per_target_m[i], 2, "m"), summary.entropy_per_target_nats[i]));
  }
  out.push_back(fmt::format("{:<8} {:>14} {:>9} {:>10.2f} nat", "mean",
                            fmt::format("{} of {}", summary.discovered, summary.targets),
                            cell(summary.rmse_m, 2, "m"), summary.entropy_nats));
  out.push_back(fmt::format(
      "rounds {}, late {}, fallbacks {}, plans missing {}; collisions {}, near misses {}, least "
      "separation {}; messages lost {}",
      summary.rounds, summary.rounds_late, summary.fallbacks, summary.plans_missing,
      summary.collisions, summary.separation_violations, cell(summary.min_separation_m, 2, "m"),
      summary.messages_lost));
  if (summary.map_entropy_nats) {
    out.push_back(fmt::format("map entropy at the end {:.0f} nat", *summary.map_entropy_nats));
  }
  return out;
}

}  // namespace vantage::tools

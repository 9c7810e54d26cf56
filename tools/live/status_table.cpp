#include "tools/live/status_table.hpp"

#include <fmt/format.h>

#include "logs/appearance/appearance.hpp"
#include "scenario/search_name.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

constexpr double kSure = 3.0;  // standard deviations; a larger error is marked as inconsistent

std::string cell(const std::optional<double>& value, int decimals, const char* unit) {
  return value ? fmt::format("{:.{}f} {}", *value, decimals, unit) : "-";
}

// Colours a word of a table. The word must be padded already, because colours change its length.
std::string word(const std::string& padded, std::optional<Emphasis> emphasis, bool in_colour) {
  return emphasis && in_colour ? coloured(padded, *emphasis) : padded;
}

// Returns the row of a target. A discovered target may have no estimate at present. Its error is
// known only if the true position is published.
std::string target_row(const logs::TargetStatus& target, bool in_colour) {
  std::optional<double> sigma_m;
  std::string by = target.discovered_s ? "none at present" : "not found yet";
  std::optional<Emphasis> emphasis = target.discovered_s ? Emphasis::kWarning : Emphasis::kQuiet;
  if (target.estimate) {
    sigma_m = target.estimate->sigma_m();
    by = target.estimate->robot;
    emphasis.reset();
  }
  const bool is_too_sure = target.error_m && sigma_m && *target.error_m > kSure * *sigma_m;
  return fmt::format(
      "{:<8} {:>11}  {}{}{:>9} {:>10.2f} nat", target.name, cell(target.discovered_s, 1, "s"),
      word(fmt::format("{:<13}", by), emphasis, in_colour),
      word(fmt::format("{:>9}", cell(target.error_m, 2, "m")),
           is_too_sure ? std::optional(Emphasis::kWarning) : std::nullopt, in_colour),
      cell(sigma_m, 2, "m"), target.entropy_nats);
}

std::optional<Emphasis> emphasis_of(models::FlightState state) {
  switch (state) {
    case models::FlightState::kFollow:
      return Emphasis::kGood;
    case models::FlightState::kHold:
    case models::FlightState::kLand:
      return Emphasis::kWarning;
    case models::FlightState::kKilled:
      return Emphasis::kBad;
    default:
      return std::nullopt;
  }
}

std::string robot_row(const std::string& name, const logs::RobotStatus& robot, bool in_colour) {
  const std::string state = word(fmt::format("{:>8}", robot.state ? name_of(*robot.state) : "-"),
                                 robot.state ? emphasis_of(*robot.state) : std::nullopt, in_colour);
  if (!robot.plan) {
    return fmt::format("{:<8} {} {:>7}", name, state, "-");
  }
  const models::RobotPlan& plan = *robot.plan;
  const double slot_s = to_seconds(plan.deadline - plan.slot_start);
  const double used_s = to_seconds(plan.finish - plan.slot_start);
  const bool is_searched = plan.source == models::PlanSource::kSearched;
  return fmt::format(
      "{:<8} {} {:>7} {} {:>9.2f} {:>9} {}", name, state, models::round_text(plan.round),
      word(fmt::format("{:>9}", name_of(plan.source)),
           is_searched ? std::nullopt : std::optional(Emphasis::kWarning), in_colour),
      plan.cost, plan.nodes,
      word(fmt::format("{:>8.0f} %", slot_s > 0.0 ? 100.0 * used_s / slot_s : 0.0),
           plan.late ? std::optional(Emphasis::kBad) : std::nullopt, in_colour));
}

// Returns "late 3", in colour if the number is not zero.
std::string count(const char* what, std::int64_t number, bool in_colour, Emphasis emphasis) {
  return word(fmt::format("{} {}", what, number),
              number > 0 ? std::optional(emphasis) : std::nullopt, in_colour);
}

}  // namespace

std::vector<std::string> status_table(const scenario::Scenario& scenario,
                                      const logs::TrialMetrics& metrics, double elapsed_s,
                                      bool in_colour) {
  const auto quiet = [&](const std::string& text) {
    return word(text, Emphasis::kQuiet, in_colour);
  };
  std::vector<std::string> out;
  out.push_back(fmt::format("{} with {}   {:.0f} s of {:g} s", scenario.name,
                            scenario::search_name(scenario.planner), elapsed_s,
                            scenario.duration_s));
  out.emplace_back();
  if (scenario.planner.objective == scenario::PlanObjective::kMapping) {
    out.push_back(fmt::format("{} {}", logs::appearance().measures.at("map_entropy").name,
                              cell(metrics.map_entropy_nats(), 0, "nat")));
  } else {
    out.push_back(quiet(fmt::format("{:<8} {:>11}  {:<13}{:>9}{:>9} {:>14}", "target",
                                    "first found", "best known by", "error", "sigma", "entropy")));
  }
  for (const logs::TargetStatus& target : metrics.targets()) {
    out.push_back(target_row(target, in_colour));
  }
  out.emplace_back();
  out.push_back(quiet(fmt::format("{:<8} {:>8} {:>7} {:>9} {:>9} {:>9} {:>10}", "robot", "state",
                                  "round", "plan", "cost nat", "nodes", "slot used")));
  for (const auto& [name, robot] : metrics.robots()) {
    out.push_back(robot_row(name, robot, in_colour));
  }
  out.emplace_back();
  out.push_back(fmt::format(
      "rounds {}   {}   {}   {}   {}", metrics.rounds(),
      count("late", metrics.rounds_late(), in_colour, Emphasis::kWarning),
      count("collisions", metrics.collisions(), in_colour, Emphasis::kBad),
      count("near misses", metrics.separation_violations(), in_colour, Emphasis::kWarning),
      count("messages lost", metrics.messages_lost(), in_colour, Emphasis::kWarning)));
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

std::vector<std::string> summary_table(const scenario::Scenario& scenario,
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
  const logs::Consistency& all = summary.per_robot.consistency;
  if (all.samples > 0) {
    out.push_back(fmt::format(
        "per robot: RMSE {}, entropy {:.2f} nat, NEES {:.2f} (median {:.2f}), {:.1f} % inside the "
        "95 % ellipse",
        cell(summary.per_robot.rmse_m, 2, "m"), summary.per_robot.entropy_nats, *all.mean_nees,
        *all.median_nees, 100.0 * *all.coverage_95));
    std::string by_age = "NEES of targets unseen for";
    for (std::size_t i = 0; i < logs::kAgeClasses; ++i) {
      const logs::Consistency& of_age = summary.per_robot.consistency_by_age[i];
      if (of_age.samples > 0) {
        by_age +=
            fmt::format("{} {} s {:.2f}", i == 0 ? "" : ",", logs::age_name(i), *of_age.mean_nees);
      }
    }
    out.push_back(by_age);
  }
  if (const logs::PoseMeans& poses = summary.poses; poses.samples > 0) {
    out.push_back(
        fmt::format("robots' poses without mocap: RMSE {}, largest error {}, heading RMSE {}, NEES "
                    "{:.2f} (ideal 2)",
                    cell(poses.rmse_m, 3, "m"), cell(poses.error_max_m, 2, "m"),
                    cell(poses.heading_rmse_rad, 3, "rad"), *poses.position_nees));
  }
  if (summary.map_entropy_nats) {
    out.push_back(fmt::format("map entropy at the end {:.0f} nat", *summary.map_entropy_nats));
  }
  return out;
}

}  // namespace vantage::tools

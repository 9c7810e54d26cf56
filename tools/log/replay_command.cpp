#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/process.hpp"
#include "scenario/reader/localizer_yaml.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_scenario.hpp"
#include "trial/replay/log_replay.hpp"

namespace vantage::tools {
namespace {

struct ReplayArguments {
  std::string log;
  std::vector<std::string> nodes;
  bool as_json = false;
};

using Json = nlohmann::ordered_json;

bool is_good(const trial::ReplayReport& report) { return report.outputs.is_exact(); }

Json to_json(const std::string& node, const trial::ReplayReport& report) {
  const trial::OutputComparison& outputs = report.outputs;
  Json json{{"node", node},
            {"exact", is_good(report)},
            {"logged", outputs.logged()},
            {"replayed", outputs.replayed()},
            {"different", outputs.different()},
            {"unexpected", outputs.unexpected()},
            {"not_replayed", report.not_replayed()},
            {"refused", report.refused},
            {"first_difference", nullptr}};
  if (const auto& first = outputs.first_difference()) {
    json["first_difference"] = {{"index", first->index},       {"utime", to_utime(first->time)},
                                {"member", first->member},     {"logged", first->logged},
                                {"replayed", first->replayed}, {"inputs", first->inputs}};
  }
  return json;
}

void print(const std::string& node, const trial::ReplayReport& report) {
  const trial::OutputComparison& outputs = report.outputs;
  print_line(fmt::format("{}: {} of {} outputs reproduced, {} different{}", node,
                         outputs.replayed(), outputs.logged(), outputs.different(),
                         is_good(report) ? ": exact" : ""));
  if (outputs.unexpected() > 0) {
    print_line(fmt::format("  {} outputs are not in the log", outputs.unexpected()));
  }
  if (report.not_replayed() > 0) {
    print_line(fmt::format("  {} outputs not replayed: one of their inputs is not in the log",
                           report.not_replayed()));
  }
  if (report.refused > 0) {
    print_line(fmt::format("  {} messages left out: they are not signed with the trial's keys",
                           report.refused));
  }
  if (report.lacks_keys && !is_good(report)) {
    print_line(
        "  messages that the trial rejected were replayed too: its keys are not on this computer");
  }
  if (outputs.first_difference()) {
    for (const std::string& line : describe(*outputs.first_difference())) {
      print_line("  " + line);
    }
  }
}

int run(ReplayArguments arguments) {
  const DefaultSignalScope comparing;
  const logs::IndexedLog log(arguments.log, progress_line("reading"));
  const scenario::Scenario scenario = scenario_of(log);
  if (arguments.nodes.empty()) {
    const auto localizer = scenario::localizer_of(scenario);
    for (const auto& robot : localizer.value_or(scenario::LocalizerSpec{}).robots) {
      arguments.nodes.push_back("localizer:" + robot.name);
    }
    for (const scenario::RobotSpec& robot : scenario.robots) {
      arguments.nodes.push_back("estimator:" + robot.name);
      arguments.nodes.push_back("planner:" + robot.name);
    }
  }
  bool all_good = true;
  Json all = Json::array();
  for (const std::string& node : arguments.nodes) {
    const trial::ReplayReport report = trial::replay_log(
        log, scenario, trial::parse_replay_target(node, scenario), progress_line(node));
    all_good &= is_good(report);
    if (arguments.as_json) {
      all.push_back(to_json(node, report));
    } else {
      print(node, report);
    }
  }
  if (arguments.as_json) {
    print_json(Json{{"log", arguments.log}, {"exact", all_good}, {"nodes", all}});
  }
  return all_good ? 0 : 1;
}

}  // namespace

void add_log_replay_command(CLI::App& log, Runner& chosen) {
  CLI::App* command = log.add_subcommand(
      "replay",
      "Run planners, estimators and localizers again on logged inputs, compare the outputs.");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("log", arguments->log, "LCM event log")->required();
  command->add_option(
      "--node", arguments->nodes,
      "process to replay: planner:ROBOT, estimator:ROBOT or localizer:ROBOT; default: all");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Every logged plan, belief and pose lists its input messages and the number of search "
      "nodes.\n"
      "The same code recomputes each output from its inputs in virtual time and compares every "
      "bit.\n"
      "Exit code 0: all equal; 1: outputs differ, or none could be replayed.\n"
      "Examples:\n"
      "  vantage log replay flight.lcmlog\n"
      "  vantage log replay flight.lcmlog --node planner:Q1 --json");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

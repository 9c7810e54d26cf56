#include "tools/commands/report.hpp"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "core/write_file.hpp"
#include "logs/picture/picture.hpp"
#include "scenario/search_name.hpp"
#include "tools/check/purpose_notes.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/live/screen.hpp"
#include "tools/live/status_table.hpp"

namespace vantage::tools {

void report_summary(const scenario::Scenario& scenario, const logs::TrialSummary& summary,
                    bool as_json) {
  clear_echo();
  if (as_json) {
    print_json(logs::to_json(summary));
    return;
  }
  for (const std::string& line : summary_table(scenario, summary)) {
    print_line(line);
  }
  if (const auto obstacle = discovery_obstacle(scenario); obstacle && summary.discovered == 0) {
    print_line(*obstacle);
  }
}

bool write_pictures(const std::string& svg_path, const scenario::Scenario& scenario,
                    const logs::Scene& scene, const logs::TrialSummary& summary) {
  try {
    write_file(svg_path, logs::draw_picture(scenario, scene, summary));
    const auto png_path = std::filesystem::path(svg_path).replace_extension(".png").string();
    const Result<std::string> png = logs::render_png(svg_path, png_path);
    if (!png.ok()) {
      print_line("vantage: " + png.error().message, stderr);
    }
    return true;
  } catch (const std::runtime_error& error) {
    print_line(std::string("vantage: ") + error.what(), stderr);
    return false;
  }
}

void add_scenario_option(CLI::App& command, std::string& scenario) {
  command.add_option("scenario", scenario, "scenario file, or a name from `vantage config list`")
      ->required();
}

void add_override_options(CLI::App& command, scenario::Overrides& overrides,
                          std::vector<std::string>* planners) {
  std::vector<std::string> words = scenario::search_names();
  words.emplace_back(scenario::kExternalSearch);
  command.add_option("--seed", overrides.seed, "random seed (default: the scenario's)")
      ->check(seed_number());
  command
      .add_option("--duration-s", overrides.duration_s,
                  "duration in seconds (default: the scenario's)")
      ->check(positive_number());
  const std::string what = "planning algorithm (default: the scenario's)";
  CLI::Option* planner =
      planners == nullptr ? command.add_option("--planner", overrides.planner, what)
                          : command
                                .add_option("--planner", *planners,
                                            what + "; several, such as arvi,greedy, are compared")
                                ->delimiter(',');
  planner->check(one_of(words));
  command
      .add_option("--communication-range-m", overrides.communication_range_m,
                  "communication range in metres (default: the scenario's); 0: none")
      ->check(number_between(-1.0, 1e6));
  command
      .add_option("--nodes", overrides.node_budget,
                  "search nodes per slot (default: the scenario's time or node budget)")
      ->check(positive_number());
}

}  // namespace vantage::tools

#include "experiments/sweep/report_page.hpp"

#include <fmt/format.h>

namespace vantage::experiments {

std::string command_of(const SweepIdentity& identity, int trials) {
  std::string command =
      fmt::format("vantage experiment {} --seed {}", identity.experiment, identity.seed);
  command += identity.is_smoke ? " --smoke" : fmt::format(" --trials {}", trials);
  if (identity.planning_share != 1.0) {
    command += fmt::format(" --planning-share {}", identity.planning_share);
  }
  return command;
}

std::string report_page(const SweepIdentity& identity, const std::string& what,
                        const SweepPlan& plan, const Summary& summary) {
  std::string page = fmt::format(
      "# {}\n\n{}.\n\n`{}`, version {}, settings {:.12}. Numbers with ± are means and half of "
      "their "
      "95 % interval.\n",
      identity.experiment, what, command_of(identity, plan.trials), identity.version,
      settings_hash(plan));
  if (identity.is_smoke) {
    page += "\n**Smoke run: two trials with short horizons. Do not use the numbers as results.**\n";
  }
  for (const std::string& figure : summary.figures) {
    page += fmt::format("\n![{0}]({0}.png)\n", figure);
  }
  if (!summary.compared.empty()) {
    page +=
        "\n## Comparison with the published values\n\n| | ours | published | deviation "
        "|\n|---|---|---|---|\n";
    for (const Compared& row : summary.compared) {
      page +=
          fmt::format("| {} | {} | {} | {} |\n", row.what, row.ours, row.printed, row.deviation);
    }
  }
  if (!summary.lines.empty()) {
    page += "\n## Summary\n\n";
    for (const std::string& line : summary.lines) {
      page += "- " + line + "\n";
    }
  }
  if (!summary.choices.empty()) {
    page += "\n## Assumptions and deviations from the source\n\n";
    for (const std::string& choice : summary.choices) {
      page += "- " + choice + "\n";
    }
  }
  page += "\n## Settings\n\n";
  for (const auto& [name, value] : plan.parameters) {
    page += fmt::format("- {}: {}\n", name, value);
  }
  return page;
}

}  // namespace vantage::experiments

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
      "# {}\n\n{}.\n\n`{}`, version {}, settings {:.12}. Numbers with ± are means with half of "
      "their "
      "95 % interval.\n",
      identity.experiment, what, command_of(identity, plan.trials), identity.version,
      settings_hash(plan));
  if (identity.is_smoke) {
    page += "\n**A smoke run: two trials of shortened horizons. Nothing here is a result.**\n";
  }
  for (const std::string& figure : summary.figures) {
    page += fmt::format("\n![{0}]({0}.png)\n", figure);
  }
  if (!summary.compared.empty()) {
    page += "\n## Ours beside the printed\n\n| | ours | printed | deviation |\n|---|---|---|---|\n";
    for (const Compared& row : summary.compared) {
      page +=
          fmt::format("| {} | {} | {} | {} |\n", row.what, row.ours, row.printed, row.deviation);
    }
  }
  if (!summary.lines.empty()) {
    page += "\n## In short\n\n";
    for (const std::string& line : summary.lines) {
      page += "- " + line + "\n";
    }
  }
  if (!summary.choices.empty()) {
    page += "\n## What the source leaves open, or is done otherwise\n\n";
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

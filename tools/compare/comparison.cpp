#include "tools/compare/comparison.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/check.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kNameWidth = 34;
constexpr std::size_t kColumnWidth = 20;
constexpr std::size_t kColumnsMax = 6;  ///< groups side by side; more groups follow below

/// Returns `text` aligned to the right of `width` columns. Precondition: `text` is UTF-8.
std::string padded(const std::string& text, std::size_t width) {
  const auto columns = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
  return std::string(columns < width ? width - columns : 1, ' ') + text;
}

std::string mean_and_interval(const experiments::Sample& sample, const char* format) {
  if (sample.size() == 0) {
    return "-";
  }
  const std::string mean = fmt::format(fmt::runtime(format), sample.mean());
  return sample.size() == 1 ? mean : fmt::format("{} ± {:.3f}", mean, sample.half_interval());
}

std::string row(const std::string& name, const std::vector<std::string>& cells) {
  std::string line = fmt::format("{:<{}}", name, kNameWidth);
  for (const std::string& cell : cells) {
    line += padded(cell, kColumnWidth);
  }
  return line;
}

/// Adds the rows of the groups in [begin, end), with differences to the first of all groups.
void add_block(const std::vector<TrialGroup>& groups, std::size_t begin, std::size_t end,
               std::vector<std::string>& lines) {
  const std::vector<ComparedValue>& names = groups.front().trials.front().quantities;
  const auto add_row = [&](const std::string& name, std::size_t first, const auto& cell) {
    std::vector<std::string> cells;
    for (std::size_t g = first; g < end; ++g) {
      cells.push_back(cell(groups[g]));
    }
    lines.push_back(row(name, cells));
  };
  add_row("", begin, [](const TrialGroup& group) { return group.name; });
  add_row("trials", begin,
          [](const TrialGroup& group) { return std::to_string(group.trials.size()); });
  for (std::size_t i = 0; i < names.size(); ++i) {
    add_row(names[i].name, begin, [&](const TrialGroup& group) {
      return mean_and_interval(sample_of(group, i), "{:.3f}");
    });
  }
  const std::size_t compared = std::max<std::size_t>(begin, 1);
  if (compared >= end) {
    return;
  }
  lines.emplace_back();
  add_row("difference to " + groups.front().name, compared,
          [](const TrialGroup& group) { return group.name; });
  add_row("seeds in both", compared, [&](const TrialGroup& group) {
    return std::to_string(paired_differences(group, groups.front(), 0).size());
  });
  for (std::size_t i = 0; i < names.size(); ++i) {
    add_row(names[i].name, compared, [&](const TrialGroup& group) {
      const experiments::Sample difference = paired_differences(group, groups.front(), i);
      const bool is_certain =
          difference.size() > 1 && std::abs(difference.mean()) > difference.half_interval();
      return mean_and_interval(difference, "{:+.3f}") + (is_certain ? " *" : "  ");
    });
  }
}

nlohmann::ordered_json json_of(const experiments::Sample& sample) {
  if (sample.size() == 0) {
    return nullptr;
  }
  nlohmann::ordered_json out{{"mean", sample.mean()}, {"n", sample.size()}};
  if (sample.size() > 1) {
    out["half_interval_95"] = sample.half_interval();
  }
  return out;
}

}  // namespace

std::vector<ComparedValue> quantities_of(const logs::TrialSummary& summary) {
  const logs::RobotMeans& robot = summary.per_robot;
  std::vector<ComparedValue> out = {{"RMSE of a robot, m", robot.rmse_m},
                                    {"RMSE of the team, m", summary.rmse_m},
                                    {"entropy of a robot's beliefs, nat", robot.entropy_nats},
                                    {"entropy of the team, nat", summary.entropy_nats},
                                    {"targets found", summary.discovered},
                                    {"time until found, s", robot.discovery_time_s},
                                    {"share of time without estimate", robot.undiscovered_share},
                                    {"NEES of a robot", robot.consistency.mean_nees},
                                    {"median NEES of a robot", robot.consistency.median_nees},
                                    {"share in the 95 % ellipse", robot.consistency.coverage_95}};
  for (std::size_t i = 0; i < logs::kAgeClasses; ++i) {
    out.push_back(
        {"NEES if unseen for " + logs::age_name(i) + " s", robot.consistency_by_age[i].mean_nees});
  }
  if (summary.poses.samples > 0) {
    out.push_back({"RMSE of own poses, m", summary.poses.rmse_m});
    out.push_back({"NEES of own poses", summary.poses.position_nees});
    out.push_back({"largest error of own poses, m", summary.poses.error_max_m});
  }
  out.push_back({"map entropy at the end, nat", summary.map_entropy_nats});
  out.push_back({"collisions", static_cast<double>(summary.collisions)});
  out.push_back({"least separation, m", summary.min_separation_m});
  out.push_back({"late rounds", static_cast<double>(summary.rounds_late)});
  out.push_back({"fallback plans", static_cast<double>(summary.fallbacks)});
  return out;
}

std::vector<ComparedValue> quantities_of(const logs::LogAnalysis& analysis) {
  std::vector<ComparedValue> out = quantities_of(analysis.summary);
  const auto set = [&](const auto& member) {
    return analysis.sets ? std::optional<double>(member(*analysis.sets)) : std::nullopt;
  };
  out.push_back({"OSPA of a robot, m", set([](const auto& sets) { return sets.ospa_m; })});
  out.push_back(
      {"swaps of a robot, 1/min", set([](const auto& sets) { return sets.swaps_per_min; })});
  return out;
}

experiments::Sample sample_of(const TrialGroup& group, std::size_t i) {
  experiments::Sample sample;
  for (const ComparedTrial& trial : group.trials) {
    if (trial.quantities[i].value) {
      sample.add(*trial.quantities[i].value);
    }
  }
  return sample;
}

experiments::Sample paired_differences(const TrialGroup& group, const TrialGroup& base,
                                       std::size_t i) {
  experiments::Sample sample;
  for (const ComparedTrial& trial : group.trials) {
    const auto same_seed =
        std::find_if(base.trials.begin(), base.trials.end(),
                     [&](const ComparedTrial& other) { return other.seed == trial.seed; });
    if (same_seed != base.trials.end() && trial.quantities[i].value &&
        same_seed->quantities[i].value) {
      sample.add(*trial.quantities[i].value - *same_seed->quantities[i].value);
    }
  }
  return sample;
}

std::vector<std::string> comparison_table(const std::vector<TrialGroup>& groups) {
  require(!groups.empty(), "comparison: needs a group of trials");
  std::vector<std::string> lines{"mean ± 95 % confidence interval (Student's t)"};
  for (std::size_t begin = 0; begin < groups.size(); begin += kColumnsMax) {
    if (begin > 0) {
      lines.emplace_back();
    }
    add_block(groups, begin, std::min(groups.size(), begin + kColumnsMax), lines);
  }
  if (groups.size() > 1) {
    lines.emplace_back("* the interval of the paired difference does not contain 0");
  }
  return lines;
}

nlohmann::ordered_json comparison_json(const std::vector<TrialGroup>& groups) {
  nlohmann::ordered_json out;
  for (const TrialGroup& group : groups) {
    nlohmann::ordered_json one{{"name", group.name}};
    for (const ComparedTrial& trial : group.trials) {
      one["seeds"].push_back(trial.seed);
    }
    const std::vector<ComparedValue>& names = group.trials.front().quantities;
    for (std::size_t i = 0; i < names.size(); ++i) {
      nlohmann::ordered_json& quantity = one["quantities"][names[i].name];
      quantity = {{"all", json_of(sample_of(group, i))},
                  {"difference", json_of(paired_differences(group, groups.front(), i))}};
      for (const ComparedTrial& trial : group.trials) {
        const std::optional<double>& value = trial.quantities[i].value;
        quantity["values"].push_back(value ? nlohmann::ordered_json(*value) : nullptr);
      }
    }
    out["groups"].push_back(std::move(one));
  }
  out["differences_to"] = groups.front().name;
  return out;
}

}  // namespace vantage::tools

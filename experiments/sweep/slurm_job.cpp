#include "experiments/sweep/slurm_job.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

namespace vantage::experiments {
namespace {

// Returns `text` quoted as one shell word.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) {
    word += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return word + "'";
}

}  // namespace

SlurmScripts slurm_scripts(const std::vector<std::string>& command, int shards) {
  std::string words = "#!/bin/sh\nexec";
  for (const std::string& word : command) {
    words += " " + quoted(word);
  }
  return {words + fmt::format(" --shard \"$SLURM_ARRAY_TASK_ID/{}\"\n", shards), words + "\n"};
}

std::vector<int> incomplete_shards(const SweepPlan& plan, int of,
                                   const std::map<Unit, UnitRows>& done) {
  std::vector<int> lacking;
  for (int number = 1; number <= of; ++number) {
    const std::vector<Unit> units = units_of(plan, {number, of});
    if (std::any_of(units.begin(), units.end(),
                    [&](const Unit& unit) { return !done.contains(unit); })) {
      lacking.push_back(number);
    }
  }
  return lacking;
}

std::string array_text(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) {
      ++last;
    }
    text += (i > 0 ? "," : "") + (last == i ? fmt::format("{}", numbers[i])
                                            : fmt::format("{}-{}", numbers[i], numbers[last]));
    i = last + 1;
  }
  return text;
}

std::string job_of(const std::string& answer) {
  std::istringstream lines(answer);
  for (std::string line; std::getline(lines, line);) {
    const std::string number = number_of(line);
    if (!number.empty() && number.find_first_not_of("0123456789") == std::string::npos) {
      return line;
    }
  }
  return "";
}

std::string number_of(const std::string& job) { return job.substr(0, job.find(';')); }

std::string cluster_of(const std::string& job) {
  const std::size_t semicolon = job.find(';');
  return semicolon == std::string::npos ? "" : job.substr(semicolon + 1);
}

std::vector<std::string> cluster_option(const std::string& job) {
  const std::string cluster = cluster_of(job);
  return cluster.empty() ? std::vector<std::string>() : std::vector{"--clusters=" + cluster};
}

std::string job_text(const std::string& job) {
  const std::string cluster = cluster_of(job);
  return number_of(job) + (cluster.empty() ? "" : " on cluster " + cluster);
}

std::map<std::string, std::string> states_of(const std::string& answer) {
  std::map<std::string, std::string> states;
  std::istringstream lines(answer);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t bar = line.find('|');
    if (bar != std::string::npos) {
      states[line.substr(0, bar)] = line.substr(bar + 1);
    }
  }
  return states;
}

bool is_live(const std::string& state) {
  static constexpr std::array<std::string_view, 11> kEnded = {
      "",          "COMPLETED", "FAILED",        "CANCELLED", "TIMEOUT", "NODE_FAIL",
      "PREEMPTED", "DEADLINE",  "OUT_OF_MEMORY", "BOOT_FAIL", "REVOKED"};
  return std::find(kEnded.begin(), kEnded.end(), state) == kEnded.end();
}

bool is_running_or_pending(const std::string& state) {
  return is_live(state) && state != "COMPLETING";
}

bool is_failure(const std::string& state) {
  return !is_live(state) && !state.empty() && state != "COMPLETED";
}

}  // namespace vantage::experiments

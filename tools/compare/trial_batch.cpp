#include "tools/compare/trial_batch.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "experiments/sweep/worker_pool.hpp"
#include "scenario/node_budget.hpp"
#include "trial/recipe.hpp"
#include "trial/robot_processes.hpp"
#include "trial/trial.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kSeedsMax = 100'000;

std::uint64_t parse_seed(std::string_view word, const std::string& text) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), seed);
  if (error != std::errc{} || end != word.data() + word.size() || word.empty()) {
    throw StartupError(fmt::format(
        "--seeds {}: must be numbers and ranges such as 1-10,20; '{}' is neither", text, word));
  }
  return seed;
}

scenario::Scenario scenario_for(const TrialBatch& batch, const std::string& planner,
                                std::uint64_t seed) {
  scenario::Overrides overrides = batch.overrides;
  overrides.seed = seed;
  overrides.planner = planner;
  scenario::Scenario scenario = scenario::load_scenario_with(batch.scenario_path, overrides);
  if (scenario.planner.node_budget <= 0) {
    overrides.node_budget = scenario::kDefaultNodeBudget;
    scenario = scenario::load_scenario_with(batch.scenario_path, overrides);
  }
  return scenario;
}

}  // namespace

std::vector<std::uint64_t> parse_seeds(const std::string& text) {
  std::vector<std::uint64_t> seeds;
  std::string_view rest = text;
  while (true) {
    const std::string_view part = rest.substr(0, rest.find(','));
    const std::size_t dash = part.find('-');
    const std::uint64_t first = parse_seed(part.substr(0, dash), text);
    const std::uint64_t last =
        dash == std::string_view::npos ? first : parse_seed(part.substr(dash + 1), text);
    if (last < first) {
      throw StartupError(fmt::format("--seeds {}: the range {} ends before it begins", text, part));
    }
    if (last - first >= kSeedsMax - seeds.size()) {
      throw StartupError(fmt::format("--seeds {}: more than {} seeds", text, kSeedsMax));
    }
    for (std::uint64_t seed = first;; ++seed) {
      seeds.push_back(seed);
      if (seed == last) {
        break;
      }
    }
    if (part.size() == rest.size()) {
      break;
    }
    rest.remove_prefix(part.size() + 1);
  }
  std::vector<std::uint64_t> sorted = seeds;
  std::sort(sorted.begin(), sorted.end());
  const auto repeated = std::adjacent_find(sorted.begin(), sorted.end());
  if (repeated != sorted.end()) {
    throw StartupError(fmt::format("--seeds {}: contains {} twice", text, *repeated));
  }
  return seeds;
}

BatchResult run_batch(const TrialBatch& batch, const std::function<bool()>& stop,
                      const std::function<void(int, int)>& on_trial) {
  std::vector<experiments::Unit> units;
  for (std::size_t trial = 0; trial < batch.seeds.size(); ++trial) {
    for (std::size_t planner = 0; planner < batch.planners.size(); ++planner) {
      units.push_back({planner, static_cast<int>(trial)});
      trial::require_own_processes(  // refused before any trial
          scenario_for(batch, batch.planners[planner], batch.seeds[trial]));
    }
  }
  if (!batch.log_folder.empty()) {
    std::filesystem::create_directories(batch.log_folder);
  }
  std::vector<std::vector<std::optional<ComparedTrial>>> trials(
      batch.planners.size(), std::vector<std::optional<ComparedTrial>>(batch.seeds.size()));
  BatchResult result;
  std::mutex mutex;
  int done = 0;
  const auto work = [&](const experiments::Unit& unit) {
    const std::string& planner = batch.planners[unit.setting];
    const std::uint64_t seed = batch.seeds[index(unit.trial)];
    const scenario::Scenario scenario = scenario_for(batch, planner, seed);
    trial::TrialOptions options;
    options.stop = stop;
    if (!batch.log_folder.empty()) {
      options.log_path =
          std::filesystem::path(batch.log_folder) / fmt::format("{}_{}.lcmlog", planner, seed);
    }
    const trial::TrialResult run = run_trial(scenario, trial::trial_recipes(scenario), options);
    const std::lock_guard lock(mutex);
    if (run.log_error) {
      result.log_errors.push_back(run.log_error->message);
    }
    if (run.was_stopped || run.log_error) {
      result.was_stopped = result.was_stopped || run.was_stopped;
    } else {
      trials[unit.setting][index(unit.trial)] = {seed, quantities_of(run.summary)};
      result.collisions += run.summary.collisions;
    }
    on_trial(++done, static_cast<int>(units.size()));
    return experiments::UnitRows{};
  };
  experiments::PoolOptions pool;
  pool.jobs = batch.jobs;
  pool.stop = stop;
  experiments::run_units(units, pool, work, [](const experiments::Unit&, experiments::UnitRows) {});
  result.was_stopped = result.was_stopped || stop();
  for (std::size_t planner = 0; planner < batch.planners.size(); ++planner) {
    TrialGroup group{batch.planners[planner], {}};
    for (std::optional<ComparedTrial>& trial : trials[planner]) {
      if (trial) {
        group.trials.push_back(std::move(*trial));
      }
    }
    result.groups.push_back(std::move(group));
  }
  return result;
}

}  // namespace vantage::tools

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "planner/search/catalogue.hpp"
#include "scenario/reader/overrides.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "trial/trial.hpp"

namespace vantage::trial {
namespace {

using planner::Algorithm;

int g_own_plans = 0;

/// A user's own search, not part of the library: a greedy search that counts its plans.
class CountedSearch final : public planner::Search {
 public:
  CountedSearch(const planner::SearchCapacity& capacity, const planner::AlgorithmOptions& options)
      : inner_(planner::algorithm_called("greedy").make(capacity, options)) {}
  const planner::SearchResult& plan(const planner::SearchProblem& problem,
                                    const Deadline& deadline) override {
    ++g_own_plans;
    return inner_->plan(problem, deadline);
  }
  [[nodiscard]] std::size_t peak_bytes() const override { return inner_->peak_bytes(); }

 private:
  std::unique_ptr<planner::Search> inner_;
};

Algorithm own_algorithm() {
  return {"counted",
          "greedy search that counts its plans",
          1.0,
          false,
          false,
          [](const planner::SearchCapacity& capacity, const planner::AlgorithmOptions& options) {
            return std::make_unique<CountedSearch>(capacity, options);
          }};
}

logs::TrialSummary flown_with(const std::string& search) {
  scenario::Overrides overrides;
  overrides.planner = search;
  overrides.duration_s = 12.0;
  overrides.node_budget = 200;
  const scenario::Scenario scenario =
      scenario::load_scenario_with(VANTAGE_SOURCE_DIR "/config/lab.yaml", overrides);
  return run_trial(scenario, trial_recipes(scenario)).summary;
}

TEST(AddAlgorithm, MakesACustomSearchAvailableInATrial) {
  EXPECT_THROW(flown_with("counted"), StartupError);
  planner::add_algorithm(own_algorithm());
  logs::TrialSummary own = flown_with("counted");
  EXPECT_EQ(own.algorithm, "counted");
  EXPECT_GE(g_own_plans, 9) << "three robots, four rounds; no beliefs in the first";
  own.algorithm = "greedy";
  EXPECT_EQ(logs::to_json(own).dump(), logs::to_json(flown_with("greedy")).dump());
  EXPECT_THROW(planner::add_algorithm(own_algorithm()), UsageError);
}

}  // namespace
}  // namespace vantage::trial

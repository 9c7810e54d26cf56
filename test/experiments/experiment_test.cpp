#include "experiments/experiment.hpp"

#include <set>

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(Experiments, HaveUniqueSettingNames) {
  for (const Experiment& experiment : all_experiments()) {
    const SweepPlan plan = experiment.make({}).plan;
    std::set<std::string> cells;
    for (const Setting& setting : plan.settings) {
      EXPECT_EQ(cells_of(setting.cells).size(), cells_of(plan.setting_columns).size());
      EXPECT_TRUE(cells.insert(setting.cells).second) << experiment.name << " " << setting.cells;
    }
    EXPECT_EQ(experiment.make({3, false}).plan.trials, 3);
  }
}

}  // namespace
}  // namespace vantage::experiments

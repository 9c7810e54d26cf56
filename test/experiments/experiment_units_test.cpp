#include <gtest/gtest.h>

#include "experiments/experiment.hpp"

namespace vantage::experiments {
namespace {

// Runs the units in another order, in a thread that has already run other units.
TEST(Experiments, UnitsDependOnTheirSeedOnly) {
  for (const Experiment& experiment : all_experiments()) {
    const Sweep sweep = experiment.make({0, true});
    ASSERT_EQ(sweep.plan.trials, 2) << experiment.name;
    const std::size_t last = sweep.plan.settings.size() - 1;
    const UnitRows one = sweep.run(0, 3);
    const UnitRows other = sweep.run(0, 4);
    sweep.run(last, 3);
    EXPECT_EQ(sweep.run(0, 3).tables, one.tables) << experiment.name;
    EXPECT_NE(other.tables, one.tables) << experiment.name;
    for (const auto& [table, rows] : one.tables) {
      ASSERT_TRUE(sweep.plan.tables.contains(table)) << experiment.name << " " << table;
      const std::size_t columns = cells_of(sweep.plan.tables.at(table)).size();
      for (const std::string& row : rows) {
        ASSERT_EQ(cells_of(row).size(), columns) << experiment.name << " " << table;
      }
    }
  }
}

}  // namespace
}  // namespace vantage::experiments

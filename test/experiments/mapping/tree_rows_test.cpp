#include "experiments/mapping/tree_rows.hpp"

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(TreeFiles, ContainTreeAndPlanBlocks) {
  SweepPlan plan;
  plan.settings = {{"known,astar"}};
  plan.tables = {{"motions", "part,depth,points_m"}, {"heat_map", "cost_to_go"}};
  std::map<Unit, UnitRows> done;
  done[{0, 0}].tables["motions"] = {"tree,1,0 0 1 0", "tree,2,1 0 2 1", "plan,1,0 0 1 0"};
  const auto files = tree_files(plan, tables_of(plan, done));
  EXPECT_EQ(files.at("tree_known_astar.txt"), "0 0 1\n1 0 1\n\n1 0 2\n2 1 2\n\n\n0 0 1\n1 0 1\n");
}

}  // namespace
}  // namespace vantage::experiments

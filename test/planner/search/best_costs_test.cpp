#include "test/bench/best_costs.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "test/bench/tracking_family.hpp"

namespace vantage::bench {
namespace {

// A temporary file with a list of best costs, one per test.
class BestCostsFile : public ::testing::Test {
 protected:
  BestCostsFile()
      : path_(::testing::TempDir() + "best_costs_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv") {
    std::filesystem::remove(path_);
  }
  ~BestCostsFile() override { std::filesystem::remove(path_); }
  std::string path_;
};

TEST_F(BestCostsFile, CostsNeverIncrease) {
  BestCosts first(path_);
  EXPECT_TRUE(first.offer("a", {-10.0, "beam", {1, 2}}));
  EXPECT_FALSE(first.offer("a", {-9.0, "arvi", {3, 4}}));
  first.save();
  // A second run that has not read the file of the first run must not increase a cost in the file.
  BestCosts second(path_);
  BestCosts third(path_);
  EXPECT_TRUE(second.offer("a", {-12.0, "rvi", {5, 6}}));
  second.save();
  EXPECT_TRUE(third.offer("a", {-11.0, "arvi", {7, 8}}));
  third.offer("b", {1.0, "arvi", {0}});
  third.save();
  const BestCosts last(path_);
  EXPECT_EQ(last.find("a")->cost, -12.0);
  EXPECT_EQ(last.find("a")->method, "rvi");
  EXPECT_EQ(last.find("a")->controls, (std::vector<int>{5, 6}));
  EXPECT_EQ(last.find("b")->cost, 1.0);
}

TEST_F(BestCostsFile, RefusesUnreadableFileWithoutChangingIt) {
  BestCosts costs(path_);
  costs.offer("a", {-10.0, "beam", {1}});
  std::ofstream(path_) << "problem,cost,method,controls\na,low,beam,1\n";
  EXPECT_THROW(costs.save(), StartupError);
  EXPECT_THROW(BestCosts{path_}, StartupError);
  std::string line;
  std::ifstream file(path_);
  std::getline(file, line);
  std::getline(file, line);
  EXPECT_EQ(line, "a,low,beam,1");
}

// The list in the repository: each cost equals the score of its controls.
TEST(BestCostsList, CostsEqualScoresOfControls) {
  const BestCosts best(VANTAGE_SOURCE_DIR "/test/bench/best_costs.csv");
  for (const tools::PlanningProblem& drawn : hundred_problems()) {
    const BestCosts::Entry* entry = best.find(drawn.name);
    ASSERT_NE(entry, nullptr) << drawn.name;
    // The plain recursion loses digits at a distance of 2 mm.
    EXPECT_NEAR(score_of(drawn.problem, entry->controls), entry->cost, 1e-4) << drawn.name;
  }
}

}  // namespace
}  // namespace vantage::bench

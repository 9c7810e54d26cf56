#include "test/drivers/safety/fault_report.hpp"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

namespace vantage::test {
namespace {

// To update the page, run build/dev/bin/fault_report > docs/reference/faults.md and check the
// difference.
TEST(FaultReport, EqualsTheCommittedPage) {
  std::ifstream file(VANTAGE_SOURCE_DIR "/docs/reference/faults.md");
  ASSERT_TRUE(file.is_open());
  std::stringstream committed;
  committed << file.rdbuf();
  EXPECT_EQ(committed.str(), fault_report());
}

}  // namespace
}  // namespace vantage::test

#include "experiments/mapping/mapping_rows.hpp"

#include <gtest/gtest.h>

namespace vantage::experiments {
namespace {

TEST(MapRows, EncodeFreeOccupiedAndUnknownCells) {
  models::OccupancyBelief map(models::GridGeometry::covering({{0.0, 0.0}, {0.6, 0.2}}, 0.2), 4.6);
  map.add_log_odds(0, -9.0);
  map.add_log_odds(2, 9.0);
  UnitRows rows;
  add_map_rows(rows, "end", map);
  EXPECT_EQ(rows.tables.at("maps"), std::vector<std::string>{"end,0,0iz"});
}

}  // namespace
}  // namespace vantage::experiments

#include "test/drivers/wire/wire_bench.hpp"

#include <cstdio>

#include <gtest/gtest.h>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {
namespace {

TEST(WireBench, FliesThreeVehiclesAlongTheirLanes) {
  WireBench bench(1);
  bench.fly_up(kBeginS);
  for (const Vehicle& vehicle : bench.vehicles()) {
    std::string reasons;
    for (const std::string& reason : bench.reasons_of(vehicle.name)) {
      reasons += reason + "; ";
    }
    EXPECT_EQ(vehicle.out.state, models::FlightState::kFollow) << vehicle.name << ": " << reasons;
  }
  EXPECT_TRUE(bench.violations().empty());
}

}  // namespace
}  // namespace vantage::test

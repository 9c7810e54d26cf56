#include <gtest/gtest.h>

#include "experiments/experiment.hpp"

namespace vantage::experiments {
namespace {

// Every row satisfies J = I − r C: value, information, energy price and energy.
TEST(Heterogeneous, ValueIsInformationMinusPricedEnergy) {
  const Sweep sweep = heterogeneous({0, true});
  for (std::size_t setting = 0; setting < sweep.plan.settings.size(); ++setting) {
    const double price_nats = std::stod(sweep.plan.settings[setting].cells);
    double energy_of_all = 0.0;
    for (std::uint64_t seed = 1001; seed <= 1010; ++seed) {
      const UnitRows rows = sweep.run(setting, seed);
      for (const std::string& row : rows.tables.at("trials")) {
        const std::vector<std::string> cells = cells_of(row);
        const double energy = std::stod(cells[3]) + std::stod(cells[4]);
        EXPECT_NEAR(std::stod(cells[1]), std::stod(cells[2]) - price_nats * energy, 1e-6) << row;
        energy_of_all += energy;
      }
    }
    EXPECT_GT(energy_of_all, 0.0) << "no robot moved";
  }
}

}  // namespace
}  // namespace vantage::experiments

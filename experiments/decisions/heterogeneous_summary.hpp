#pragma once

#include <array>

#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

struct HeterogeneousMethod {
  const char* name;
  const char* label;  ///< name in figures
};
inline constexpr std::array<HeterogeneousMethod, 3> kMethods = {
    {{"cd uav first", "CD, UAV first"}, {"cd ugvs first", "CD, UGVs first"}, {"dls", "DLS"}}};
/// Energy price of Fig. 3.9; only this setting writes the tables "ways" and "targets".
inline constexpr const char* kPicturedPrice = "0.20";

/// Result of one method in one trial: the columns of the table "trials" after the method's name.
struct HeterogeneousOutcome {
  double value = 0.0;        ///< J, nats
  double information = 0.0;  ///< I, nats
  double energy_ugvs = 0.0;  ///< energy, not multiplied by the price
  double energy_uav = 0.0;
  [[nodiscard]] double energy() const { return energy_ugvs + energy_uav; }
};

/// Returns the summary without Summary::choices. The picture shows the trial in which distributed
/// local search gains most over the better order of coordinate descent.
Summary summarise_heterogeneous(const SweepPlan& plan, const Tables& tables);

}  // namespace vantage::experiments

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// Returns a sweep at `extent` with the settings `cases`, in their order. cells() of a case returns
/// the texts of the case in `setting_columns`. run_unit(case, is_smoke, seed) computes the rows of
/// a unit.
template <class Case, class RunUnit>
Sweep sweep_over(const std::string& setting_columns, const std::vector<Case>& cases,
                 int usual_trials, const Extent& extent, RunUnit run_unit) {
  Sweep sweep;
  sweep.plan.setting_columns = setting_columns;
  for (const Case& of : cases) {
    sweep.plan.settings.push_back({of.cells()});
  }
  sweep.plan.trials = extent.trials_or(usual_trials);
  sweep.run = [cases, run_unit, is_smoke = extent.is_smoke](std::size_t setting,
                                                            std::uint64_t seed) {
    return run_unit(cases[setting], is_smoke, seed);
  };
  return sweep;
}

}  // namespace vantage::experiments

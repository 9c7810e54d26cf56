#pragma once

#include <functional>
#include <vector>

#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

struct PoolOptions {
  int jobs = 1;
  /// Called before each unit; if it returns true, no further unit begins. May be empty.
  std::function<bool()> stop;
  /// Called five times per second by the caller's thread while units run. `keep` does not run at
  /// the same time, so `tick` may end the process without leaving incomplete rows. May be empty.
  std::function<void()> tick;
};

/// Runs `work` on each of `units`, in the order of the list, on `jobs` threads. Each result is
/// passed to `keep`, one call at a time. Returns when all started units have ended. An exception of
/// `work` or `keep` ends the run and is rethrown.
void run_units(const std::vector<Unit>& units, const PoolOptions& options,
               const std::function<UnitRows(const Unit&)>& work,
               const std::function<void(const Unit&, UnitRows)>& keep);

}  // namespace vantage::experiments

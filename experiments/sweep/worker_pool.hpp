#pragma once

#include <functional>
#include <vector>

#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

struct PoolOptions {
  int jobs = 1;
  /// Asked before each unit; true: none is begun any more. May be empty.
  std::function<bool()> stop;
  /// Called five times a second while units run, by the caller's thread; `keep` is not called
  /// meanwhile, so that the process may end in it with every row whole. May be empty.
  std::function<void()> tick;
};

/// Runs `work` on each of `units`, on `jobs` threads, in the order of the list; what it returned
/// goes to `keep`, one call at a time. Returns once every unit that was begun has ended. An
/// exception of either ends it, and is thrown on.
void run_units(const std::vector<Unit>& units, const PoolOptions& options,
               const std::function<UnitRows(const Unit&)>& work,
               const std::function<void(const Unit&, UnitRows)>& keep);

}  // namespace vantage::experiments

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace vantage::tools {

/// How much of an experiment is run.
struct ExperimentOptions {
  int trials = 0;  ///< of each setting; 0: as the dissertation
  std::uint64_t seed = 1;
  bool smoke = false;  ///< two trials, the smallest settings: does it run at all
  /// Told the share that is done, in [0, 1]; may be empty.
  std::function<void(double)> progress;
};

/// What an experiment found.
struct ExperimentResult {
  std::map<std::string, std::string> files;  ///< CSV by name; what is in "times.csv" differs from
                                             ///< run to run, all else never does
  std::string figure;                        ///< gnuplot, to be run among the files
  std::vector<std::string> report;           ///< what to tell at the end
  std::map<std::string, double> settings;    ///< for the manifest
};

/// One experiment of the dissertation that a command reproduces.
struct Experiment {
  const char* name;
  const char* what;
  ExperimentResult (*run)(const ExperimentOptions& options);
};
const std::vector<Experiment>& all_experiments();

// The experiments themselves. Each row of a CSV is a function of (seed, trial) alone.

/// Fig. 3.6: oracle calls and proposals of distributed local search, naive, lazy, warm and both.
ExperimentResult run_dls_savings(const ExperimentOptions& options);
/// Fig. 3.7: J of distributed local search against coordinate descent in both orders.
ExperimentResult run_dls_objective(const ExperimentOptions& options);
/// Table 4.1 and Fig. 4.3: tracking under worst-case attacks, RAIN against coordinate descent.
ExperimentResult run_resilient_tracking(const ExperimentOptions& options);

}  // namespace vantage::tools

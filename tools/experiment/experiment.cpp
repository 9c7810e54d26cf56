#include "tools/experiment/experiment.hpp"

namespace vantage::tools {

const std::vector<Experiment>& all_experiments() {
  static const std::vector<Experiment> experiments = {
      {"dls-savings",
       "oracle calls and proposals that lazy search and a warm start save (Fig. 3.6)",
       run_dls_savings},
      {"dls-objective", "distributed local search against coordinate descent (Fig. 3.7)",
       run_dls_objective},
      {"resilient-tracking", "tracking under attack, RAIN against coordinate descent (Table 4.1)",
       run_resilient_tracking},
  };
  return experiments;
}

}  // namespace vantage::tools

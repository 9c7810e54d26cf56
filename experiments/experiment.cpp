#include "experiments/experiment.hpp"

namespace vantage::experiments {

const std::vector<Experiment>& all_experiments() {
  static const std::vector<Experiment> experiments = {
      {"active-mapping", "Mapping landmarks with A*, ARVI and AEGIS (Fig. 2.2 to 2.5)",
       active_mapping},
      {"tracking-communication", "Tracking error versus communication range (Fig. 3.3 a–c)",
       tracking_communication},
      {"tracking-time", "Tracking error versus planning time (Fig. 3.3 d–f)", tracking_time},
      {"tracking-noise", "Tracking error versus sensor noise (Fig. 3.3 g–i)", tracking_noise},
      {"tracking-clutter", "Tracking by detections without ids, with false alarms and misses",
       tracking_clutter},
      {"hardware", "The lab's trial of five rovers and three quadrotors (Fig. 3.4)", hardware},
      {"dls-savings",
       "Oracle calls and proposals that lazy search and a warm start save (Fig. 3.6)", dls_savings},
      {"dls-objective", "Distributed local search compared with coordinate descent (Fig. 3.7)",
       dls_objective},
      {"heterogeneous", "Two UGVs and a UAV: information gain versus energy (Fig. 3.8, 3.9)",
       heterogeneous},
      {"resilient-tracking",
       "Tracking under attack: RAIN compared with coordinate descent (Table 4.1, Fig. 4.3)",
       resilient_tracking},
      {"resilient-tracking-choices",
       "resilient-tracking with three modelling choices varied: eight combinations (Table 4.1)",
       resilient_tracking_choices},
      {"resilient-mapping",
       "Mapping under attack: RAIN compared with coordinate descent (Fig. 4.4, 4.5)",
       resilient_mapping},
      {"surveillance",
       "Surveillance of a camp under attack: RAIN compared with coordinate descent (Fig. 4.7)",
       surveillance},
      {"resilient-hardware", "Two robots, two targets, one sensor always jammed (Fig. 4.9)",
       resilient_hardware},
      {"search-or-sampling",
       "Searches compared with a sampling tree, at equal numbers of CPU instructions",
       search_or_sampling},
  };
  return experiments;
}

}  // namespace vantage::experiments

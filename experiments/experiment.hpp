#pragma once

#include <vector>

#include "experiments/sweep/sweep.hpp"

namespace vantage::experiments {

/// One experiment of the dissertation that a command reproduces.
struct Experiment {
  const char* name;
  const char* what;
  Sweep (*make)(const Extent& extent);
};
const std::vector<Experiment>& all_experiments();

/// Fig. 2.2 to 2.5: A*, ARVI and AEGIS from one hundred random start poses.
Sweep active_mapping(const Extent& extent);
/// Fig. 3.3 a–c: tracking error as a function of the communication range.
Sweep tracking_communication(const Extent& extent);
/// Fig. 3.3 d–f: tracking error as a function of the planning time.
Sweep tracking_time(const Extent& extent);
/// Fig. 3.3 g–i: tracking error as a function of the measurement noise.
Sweep tracking_noise(const Extent& extent);
/// Not in the dissertation: tracking with detections without ids and with false alarms.
Sweep tracking_clutter(const Extent& extent);
/// Fig. 3.4: the lab trial, simulated, compared with three planners without look-ahead.
Sweep hardware(const Extent& extent);
/// Fig. 3.6: oracle calls and proposals of distributed local search, naive, lazy, warm-started, or
/// lazy and warm-started.
Sweep dls_savings(const Extent& extent);
/// Fig. 3.7: J of distributed local search and of coordinate descent in both orders.
Sweep dls_objective(const Extent& extent);
/// Fig. 3.8, 3.9: two UGVs and a UAV in mud and wind; information as a function of energy.
Sweep heterogeneous(const Extent& extent);
/// Table 4.1 and Fig. 4.3: tracking under worst-case attacks with RAIN and coordinate descent.
Sweep resilient_tracking(const Extent& extent);
/// Three rows of Table 4.1 for eight combinations of choices that the dissertation leaves open.
Sweep resilient_tracking_choices(const Extent& extent);
/// Fig. 4.4 and 4.5: mapping under attack, RAIN compared with coordinate descent.
Sweep resilient_mapping(const Extent& extent);
/// Fig. 4.7: surveillance of a camp under attack, replanned every 1 to 10 steps.
Sweep surveillance(const Extent& extent);
/// Fig. 4.9, simulated: two robots and two targets, with one robot jammed at all times.
Sweep resilient_hardware(const Extent& extent);

/// Not in the dissertation: plans of searches and of the sampling tree with equal numbers of CPU
/// instructions.
Sweep search_or_sampling(const Extent& extent);

}  // namespace vantage::experiments

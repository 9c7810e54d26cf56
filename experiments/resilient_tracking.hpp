#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "experiments/tracked_targets.hpp"
#include "planner/decision/attack.hpp"

namespace vantage::experiments {

/// What a bearing's variance grows with, up to σ_b²: the text can be read as either.
enum class BearingNoise {
  kByRange,    ///< as the range's: at the largest range σ_b²
  kByBearing,  ///< linearly in |bearing|: at the edge of view σ_b² (bearing_noise.hpp)
};

/// One row of Table 4.1, and how it is run.
struct TrackingSetting {
  int robots = 10;
  int targets = 10;
  int attacks = 2;  ///< α: of the attacker, and what a resilient team plans for
  planner::Attacker attacker = planner::Attacker::kGreedy;
  int task_steps = 500;
  int plan_steps = 25;                    ///< T_PLAN = T_REPLAN
  std::int64_t nodes_per_plan = 100'000;  ///< of one robot's search
  // What the text leaves open.
  double start_side_m = 64.0;  ///< robots and targets start in a square of this side in the middle
  double prior_position_sigma_m = 1.0;
  double prior_velocity_sigma_mps = 0.02;  ///< they start at rest: what one step adds, √(q τ)
  double detection_probability = 0.05;     ///< see TargetSetting
  /// Plans count no look from nearer than this. A bearing from r tells 1/r² about a target exactly
  /// where it is expected, but it is there only to the belief's decimetres: plans would stay for
  /// information that no look then brings.
  double plan_range_min_m = 3.0;
  BearingNoise bearing_noise = BearingNoise::kByRange;  ///< of the sensor and of the plans alike
  bool beliefs_stay_inside = true;                      ///< see TargetSetting
};

/// What a sweep tells of a setting that all its units share.
std::map<std::string, std::string> parameters_of(const TrackingSetting& setting);

/// What a run was like after each step.
struct TrackingRun {
  std::vector<double> rmse_m;        ///< √ mean over targets of the squared position error
  std::vector<double> entropy_nats;  ///< mean over targets
  std::vector<std::vector<TargetStep>> targets;  ///< [step][target]
};

/// Tracking in a square of 64 m while the attacker takes away the sensors of α robots, chosen anew
/// for each planning period; robots that measure share everything. Resilient: RAIN; else coordinate
/// descent. Targets, their priors and the robots' starts depend on `seed` alone, not on how the
/// team plans. Source: dissertation 4 F.1.
TrackingRun track_under_attack(const TrackingSetting& setting, bool is_resilient,
                               std::uint64_t seed);

}  // namespace vantage::experiments

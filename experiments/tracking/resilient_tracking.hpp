#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "experiments/tracking/tracked_targets.hpp"
#include "planner/decision/attack.hpp"

namespace vantage::experiments {

/// Growth of the bearing's variance, up to σ_b²; the text of the dissertation allows both
/// interpretations.
enum class BearingNoise {
  kByRange,    ///< linear in range: σ_b² at the largest range
  kByBearing,  ///< linear in |bearing|: σ_b² at the edge of view (bearing_noise.hpp)
};

/// One row of Table 4.1 and the parameters of its runs.
struct TrackingSetting {
  int robots = 10;
  /// The robots start in the square of the targets. The dissertation does not state the square, the
  /// priors and the detection probability.
  TargetSetting targets = {};
  int attacks = 2;  ///< α: number of attacks, for which a resilient team plans
  planner::Attacker attacker = planner::Attacker::kGreedy;
  int task_steps = 500;
  int plan_steps = 25;                                  ///< T_PLAN = T_REPLAN
  std::int64_t nodes_per_plan = 100'000;                ///< search nodes per robot and plan
  BearingNoise bearing_noise = BearingNoise::kByRange;  ///< used by the sensor and by the plans
};

/// Returns the parameters of a setting that all units of a sweep share.
std::map<std::string, std::string> parameters_of(const TrackingSetting& setting);

/// Record of a run after each step.
struct TrackingRun {
  std::vector<double> rmse_m;        ///< √ mean over targets of the squared position error
  std::vector<double> entropy_nats;  ///< mean entropy over targets
  std::vector<std::vector<TargetStep>> targets;  ///< indexed by [step][target]
};

/// Simulates tracking in a square of 64 m under attacks on the sensors of α robots, chosen again in
/// each planning period. Robots that are not attacked share all observations. A resilient team
/// plans by RAIN, other teams by coordinate descent. Targets, their priors and the robots' starts
/// depend only on `seed`, so they are the same for both methods.
/// Source: dissertation, section 4.F.1.
TrackingRun track_under_attack(const TrackingSetting& setting, bool is_resilient,
                               std::uint64_t seed);

}  // namespace vantage::experiments

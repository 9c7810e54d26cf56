#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "logs/file/log_index.hpp"
#include "logs/metrics/set_means.hpp"
#include "logs/metrics/trial_summary.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// How a measured duration is spread.
struct Spread {
  std::int64_t count = 0;
  double mean_s = 0.0;
  double median_s = 0.0;
  double p95_s = 0.0;
  double worst_s = 0.0;  ///< greatest
  double least_s = 0.0;
};
/// Of all zeros for no values.
Spread spread_of(std::vector<double> values_s);

/// A planner against its deadlines.
struct DeadlineRecord {
  std::int64_t plans = 0;
  std::int64_t late = 0;
  std::int64_t fallbacks = 0;  ///< did not come from their own slot's search
  Spread margin;               ///< deadline − finish; negative: late
  Spread search;               ///< slot start → finish
};

/// A part of the way through the stack as a process measured it, over the whole trial until its
/// last HEALTH.
struct Hop {
  std::string name;  ///< "frame_setpoint": from the one until the other
  std::int64_t p50_us = 0;
  std::int64_t p99_us = 0;
  std::int64_t max_us = 0;
};
/// From a process's counters NAME_p50_us, NAME_p99_us and NAME_max_us, in their order.
std::vector<Hop> hops_of(const models::ProcessHealth& health);

/// One instant of the trial's course. Seconds since the log's begin.
struct CoursePoint {
  double at_s = 0.0;
  std::optional<double> rmse_m;  ///< of the targets known, by the team's estimates
  double entropy_nats = 0.0;     ///< mean over all targets
  int discovered = 0;
};
struct PlanPoint {
  double at_s = 0.0;
  std::string robot;
  double margin_s = 0.0;
  std::optional<double> gap_nat;  ///< cost − lower bound, where both are known
};

struct LogAnalysis {
  TrialSummary summary;
  std::optional<SetMeans> sets;  ///< none without truth
  /// Ways through the stack, each from the first instant named to the last:
  /// "capture → arrival" and "capture → log" (VICON), "look → belief" (newest measurement of a
  /// belief, until that was logged), "belief → plan" and "look → plan" (until the plan's finish).
  std::map<std::string, Spread> latencies;
  std::map<std::string, std::vector<Hop>> hops;     ///< by process
  std::map<std::string, DeadlineRecord> deadlines;  ///< by robot
  std::map<std::string, std::int64_t> lost;         ///< messages missing in the log, by channel
  std::int64_t times_outlying = 0;  ///< events left out for their times (UsualTimes)
  std::vector<CoursePoint> course;  ///< one a judged estimator step
  std::vector<PlanPoint> plans;
};

/// Judges a log as a trial: RMSE, OSPA, entropy, discovery (against TRUTH, where there is one),
/// deadlines, loss and latencies. One pass.
LogAnalysis analyse_log(const IndexedLog& log, const scenario::Scenario& scenario,
                        const std::function<void(double)>& progress = {});

/// Everything but the course.
nlohmann::ordered_json to_json(const LogAnalysis& analysis);

}  // namespace vantage::logs

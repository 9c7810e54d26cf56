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

/// Distribution of a measured duration.
struct Spread {
  std::int64_t count = 0;
  double mean_s = 0.0;
  double median_s = 0.0;
  double p95_s = 0.0;
  double worst_s = 0.0;  ///< s; maximum
  double least_s = 0.0;
};
/// Returns the distribution of `values_s`; zeros if there are no values.
Spread spread_of(std::vector<double> values_s);

/// Timing of one robot's planner relative to its deadlines.
struct DeadlineRecord {
  std::int64_t plans = 0;
  std::int64_t late = 0;
  /// number of plans that were not found by a search in the robot's own slot
  std::int64_t fallbacks = 0;
  Spread margin;  ///< s; deadline minus the time when a plan was finished
  Spread search;  ///< s; from the start of the slot to the end of the search
};

/// Latency between two events of the processing chain, as measured by a process from the start of
/// the trial to its last HEALTH message.
struct Hop {
  std::string name;  ///< first and last event: "frame_setpoint"
  std::int64_t p50_us = 0;
  std::int64_t p99_us = 0;
  std::int64_t max_us = 0;
};
/// Returns the hops in the process's counters NAME_p50_us, NAME_p99_us and NAME_max_us, in order.
std::vector<Hop> hops_of(const models::ProcessHealth& health);

/// Values at one instant of the trial. Times are seconds since the start of the log.
struct CoursePoint {
  double at_s = 0.0;
  std::optional<double> rmse_m;  ///< m; RMSE of the team's estimates of known targets
  double entropy_nats = 0.0;     ///< nats; mean over all targets
  int discovered = 0;
};
struct PlanPoint {
  double at_s = 0.0;
  std::string robot;
  double margin_s = 0.0;
  std::optional<double> gap_nat;  ///< cost − lower bound, if both are known
};

struct LogAnalysis {
  TrialSummary summary;
  std::optional<SetMeans>
      sets;  ///< errors of the targets as an unlabelled set; nullopt without truth
  /// Latencies from the first named event to the last: "capture → arrival" and "capture → log"
  /// (VICON); "look → belief" (from the newest measurement in a belief until the belief was
  /// logged); "belief → plan" and "look → plan" (until the plan was finished).
  std::map<std::string, Spread> latencies;
  std::map<std::string, std::vector<Hop>> hops;     ///< hops of each process
  std::map<std::string, DeadlineRecord> deadlines;  ///< record of each robot
  std::map<std::string, std::int64_t> lost;         ///< messages missing in the log, by channel
  std::vector<std::string> contested;  ///< channels on which two processes published at once
  std::int64_t times_outlying = 0;     ///< ignored events with outlying times (UsualTimes)
  std::vector<CoursePoint> course;     ///< one point per evaluated estimator step
  std::vector<PlanPoint> plans;
};

/// Evaluates a log as a trial: RMSE, OSPA, entropy and discovery (compared with TRUTH if present),
/// deadlines, loss and latencies. Reads the log once.
LogAnalysis analyse_log(const IndexedLog& log, const scenario::Scenario& scenario,
                        const std::function<void(double)>& progress = {});

/// Returns all results except the course.
nlohmann::ordered_json to_json(const LogAnalysis& analysis);

}  // namespace vantage::logs

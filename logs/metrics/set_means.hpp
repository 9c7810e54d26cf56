#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "logs/metrics/ospa.hpp"
#include "logs/metrics/truth_history.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// Errors of the targets of a trial as an unlabelled set: means over each robot's beliefs, then
/// over the robots.
struct SetMeans {
  double ospa_m = 0.0;         ///< OSPA of order 2 with cutoff kOspaCutoff_m, of ground positions
  double swaps_per_min = 0.0;  ///< swaps per minute of one robot
  double matched_rmse_m = 0.0;
};
inline constexpr double kOspaCutoff_m = 1.0;

/// Accumulator of SetMeans. Messages must arrive in the order of a log. A belief is evaluated once
/// truth of the same or a later instant has arrived.
class SetSums {
 public:
  explicit SetSums(int targets) : targets_(targets) {}

  void on_truth(const models::TruthFrame& frame);
  void on_belief(const models::RobotBelief& belief);
  /// Returns the means; nullopt if truth was missing for all beliefs.
  [[nodiscard]] std::optional<SetMeans> means() const;

 private:
  struct Robot {
    OspaJudge judge{kOspaCutoff_m};
    std::int64_t beliefs = 0;
    double ospa_m = 0.0;
    double matched_rmse_m = 0.0;
    Time first{};
    Time last{};
  };
  struct Pending {
    std::string robot;
    Time time{};
    std::vector<Labelled> estimates;
  };
  void judge(const Pending& belief);

  int targets_;
  TruthHistory truth_;
  std::deque<Pending> pending_;
  std::map<std::string, Robot> robots_;
};

}  // namespace vantage::logs

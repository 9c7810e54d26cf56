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

/// The targets of a trial as a set, whatever they are called: means over each robot's beliefs, then
/// over the robots.
struct SetMeans {
  double ospa_m = 0.0;         ///< order 2, cutoff kOspaCutoff_m, of ground positions
  double swaps_per_min = 0.0;  ///< of one robot
  double matched_rmse_m = 0.0;
};
inline constexpr double kOspaCutoff_m = 1.0;

/// Gathers SetMeans. Messages come in the order of a log; a belief is judged once the truth of a
/// later instant is there.
class SetSums {
 public:
  explicit SetSums(int targets) : targets_(targets) {}

  void on_truth(const models::TruthFrame& frame);
  void on_belief(const models::RobotBelief& belief);
  /// nullopt when there was no belief with truth around it.
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

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// What a log grows by for each robot, at most: the lab's 3 robots and 5 targets write 23 kB/s
/// each, a crowd of 50 robots and 100 targets 57 kB/s.
inline constexpr double kLogBytesPerRobotS = 100e3;
/// Beyond the trial, for landings.
inline constexpr double kLogSpareS = 60.0;

/// The most that the whole trial's log takes.
std::uint64_t log_bytes_needed(const scenario::Scenario& scenario);
/// Whether a trial's log finds room, and what is free and needed, as one sentence.
struct LogRoom {
  bool is_enough = true;
  std::string words;
};
LogRoom room_for_log(const scenario::Scenario& scenario, const std::string& path,
                     std::optional<std::uint64_t> free_bytes);

/// Notices while flying that a log is not written, or soon will not be. Pure.
class LogWatch {
 public:
  static constexpr double kUnwrittenS = 3.0;    ///< something is published each second
  static constexpr double kNearlyFullS = 60.0;  ///< of flight that still fit

  /// @param bytes_per_s  that the log grows by at most
  explicit LogWatch(double bytes_per_s) : bytes_per_s_(bytes_per_s) {}

  struct Look {
    std::uint64_t size_bytes = 0;
    std::optional<std::uint64_t> free_bytes;
    bool is_refused = false;  ///< the recorder says that the disk does not take it
  };
  /// What is to be told at once; nullopt when nothing has changed.
  std::optional<std::string> look(const Look& look, Time now);
  [[nodiscard]] bool is_written() const { return state_ != State::kUnwritten; }
  /// What to say of it on HEALTH_LOG.
  [[nodiscard]] models::ProcessHealth health(Time now) const;

 private:
  enum class State { kWritten, kNearlyFull, kUnwritten };
  [[nodiscard]] State judge(Time now) const;

  double bytes_per_s_;
  Look last_;
  std::optional<Time> grown_at_;
  State state_ = State::kWritten;
  std::int64_t times_unwritten_ = 0;
  std::int64_t looks_ = 0;
};

/// The name of the log on HEALTH_<name>.
inline constexpr const char* kLogHealth = "LOG";

}  // namespace vantage::logs

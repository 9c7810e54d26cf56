#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs {

/// Upper bound of the growth of a log per robot, B/s. The lab with 3 robots and 5 targets writes 23
/// kB/s per robot, a team of 50 robots and 100 targets 57 kB/s.
inline constexpr double kLogBytesPerRobotS = 100e3;
/// Time added to the trial for landings, s.
inline constexpr double kLogSpareS = 60.0;

/// Returns the maximum size of the log of a complete trial.
std::uint64_t log_bytes_needed(const scenario::Scenario& scenario);
/// Result of comparing free and needed space for a log, with a sentence that states both.
struct LogSpaceCheck {
  bool is_enough = true;
  std::string summary;
};
LogSpaceCheck check_log_space(const scenario::Scenario& scenario, const std::string& path,
                              std::optional<std::uint64_t> free_bytes);

/// Monitor that detects during flight that a log is not being written, or soon will not be. It has
/// no side effects.
class LogWatch {
 public:
  /// s; a log that has not grown for this time counts as not written, because messages arrive every
  /// second.
  static constexpr double kUnwrittenS = 3.0;
  /// s; a disk with free space for less flight time than this is nearly full.
  static constexpr double kNearlyFullS = 60.0;

  /// @param bytes_per_s  maximum growth of the log
  explicit LogWatch(double bytes_per_s) : bytes_per_s_(bytes_per_s) {}

  struct Observation {
    std::uint64_t size_bytes = 0;
    std::optional<std::uint64_t> free_bytes;
    bool is_refused = false;  ///< the recorder reports that the disk refuses data
  };
  /// Returns a message to be shown immediately; nullopt if nothing has changed.
  std::optional<std::string> update(const Observation& observation, Time now);
  [[nodiscard]] bool is_written() const { return state_ != State::kUnwritten; }
  /// Returns the content of HEALTH_LOG.
  [[nodiscard]] models::ProcessHealth health(Time now) const;

 private:
  enum class State { kWritten, kNearlyFull, kUnwritten };
  [[nodiscard]] State judge(Time now) const;

  double bytes_per_s_;
  Observation last_;
  std::optional<Time> grown_at_;
  State state_ = State::kWritten;
  std::int64_t times_unwritten_ = 0;
  std::int64_t observations_ = 0;
};

/// Process name of the log in HEALTH_<name>.
inline constexpr const char* kLogHealth = "LOG";

}  // namespace vantage::logs

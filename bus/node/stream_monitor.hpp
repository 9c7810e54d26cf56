#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Classification of one message of a stream.
enum class [[nodiscard]] Arrival{
    kFresh,       kDuplicate, kReordered,
    kOldRun,       ///< from a replaced run, or from a run that competes with a live one
    kTooFarAhead,  ///< the message's sequence number is not accepted
};

/// Receiver's time, and the lease of the channel.
struct StreamRules {
  std::optional<Time> now;  ///< receiver's clock; nullopt if there is no clock (a log)
  /// Time after a run's last message for which no other run can replace the run. Without a lease or
  /// a clock, another run replaces the current run immediately.
  Duration lease{};
};

struct StreamCounts {
  std::int64_t fresh = 0;
  std::int64_t lost = 0;  ///< sequence numbers that were skipped and have not arrived later
  std::int64_t duplicates = 0;
  std::int64_t reordered = 0;  ///< arrived after a newer message; subtracted from `lost`
  std::int64_t old_runs = 0;   ///< messages with Arrival::kOldRun
  std::int64_t too_far_ahead = 0;
  std::int64_t runs = 0;  ///< number of distinct runs received

  /// Adds the counts; each sum saturates.
  void add(const StreamCounts& more);
};

/// Checker of the run ids and sequence numbers on one channel, which LCM does not check.
///
/// A new run id replaces the current run if its content is not older. From then on the old run is
/// refused permanently. Sequence numbers start at 0. Messages of the first run before the first
/// received message are not counted as lost, because the receiver may have started later. A run
/// that replaces another is expected to start at 0. The newest 256 missing numbers are stored. If
/// the number of a late message is no longer stored, the message is counted as a duplicate, and
/// also as lost.
///
/// A number more than kStepMax beyond the newest is refused, so that one forged number cannot
/// silence a sender. Such a number is accepted after kAcceptSteps consecutive refused numbers and,
/// with a clock, only if no message of the run was accepted for kAcceptSilence. A smaller step may
/// skip more numbers than are stored. If a skipped number that is not stored then arrives with a
/// newer time, the gap was forged, so the message is accepted.
class StreamMonitor {
 public:
  static constexpr std::int64_t kStepMax = 10'000;
  static constexpr int kAcceptSteps = 10;
  static constexpr Duration kAcceptSilence = std::chrono::seconds(2);
  /// Largest lead of a time stamp over the receiver's clock. When runs are compared by time, larger
  /// leads are reduced to this limit.
  static constexpr Duration kFutureMax = std::chrono::seconds(2);

  /// Classifies a message. Precondition: stamp.sequence ≥ 0 (from_wire ensures it). Cost: constant,
  /// bounded memory.
  Arrival judge(const models::Stamp& stamp, const StreamRules& rules = {});
  [[nodiscard]] const StreamCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] bool may_begin(const models::Stamp& stamp, const StreamRules& rules) const;
  void begin_run(const models::Stamp& stamp);
  void advance_to(const models::Stamp& stamp, const StreamRules& rules);
  void discard_forged_gap();
  /// True if a number more than kStepMax beyond the newest is accepted.
  bool accepts_step(std::int64_t sequence, const StreamRules& rules);

  static constexpr std::size_t kRetiredRunsKept = 16;
  static constexpr std::size_t kMissingKept = 256;
  bool has_received_ = false;
  std::int64_t run_id_ = 0;
  std::int64_t first_sequence_ = 0;
  std::int64_t newest_sequence_ = -1;
  Time newest_time_{};
  std::optional<Time> received_at_;  ///< receiver's time at the run's last fresh message
  std::int64_t gap_begin_ = -1;  ///< newest number before a gap that is longer than kMissingKept
  std::int64_t gap_lost_ = 0;
  std::int64_t refused_sequence_ = 0;  ///< newest number that was too far ahead
  int refused_steps_ = 0;              ///< number of consecutive refused numbers
  std::vector<std::int64_t> retired_runs_;
  std::vector<std::int64_t> missing_;
  StreamCounts counts_;
};

/// Checker of a channel on which several processes may publish. Each run is a separate stream, and
/// runs do not replace each other. So a second operator console does not silence the first.
///
/// At most 32 runs are stored. A new run replaces the least recently received one.
class SharedStreamMonitor {
 public:
  /// Classifies a message. Precondition: stamp.sequence ≥ 0. Cost: bounded time and memory.
  Arrival judge(const models::Stamp& stamp, const StreamRules& rules = {});
  /// Returns the sums over all runs received so far.
  [[nodiscard]] StreamCounts counts() const;

 private:
  static constexpr std::size_t kRunsKept = 32;
  struct Run {
    std::int64_t run_id = 0;
    std::int64_t judged_last = 0;  ///< value of judged_ at the run's last message
    StreamMonitor stream;
  };
  std::vector<Run> runs_;
  std::int64_t judged_ = 0;
  StreamCounts forgotten_;  ///< counts of the runs that were replaced
};

}  // namespace vantage::bus

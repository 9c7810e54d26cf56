#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// What became of a message of one stream.
enum class [[nodiscard]] Arrival{
    kFresh,       kDuplicate, kReordered,
    kOldRun,       ///< of a run that has been replaced, or beside one that is alive
    kTooFarAhead,  ///< its number is not believed
};

/// What the listener knows of time, and how long a run holds the channel.
struct StreamRules {
  std::optional<Time> now;  ///< by the listener's own clock; nullopt when it has none (a log)
  /// While a run was heard within this, no other replaces it. 0, or no clock: another replaces it
  /// at once.
  Duration lease{};
};

struct StreamCounts {
  std::int64_t fresh = 0;
  std::int64_t lost = 0;  ///< sequence numbers skipped and never seen since
  std::int64_t duplicates = 0;
  std::int64_t reordered = 0;  ///< arrived after a newer one; taken off `lost` again
  std::int64_t old_runs = 0;   ///< from a run that a newer run has replaced, or may not replace
  std::int64_t too_far_ahead = 0;
  std::int64_t runs = 0;  ///< distinct runs heard

  /// Adds, but never beyond what fits.
  void add(const StreamCounts& more);
};

/// Judges the messages of one channel by run id and sequence number; LCM does none of it.
///
/// A run id not heard before replaces the current run when its content is not older; from then on
/// the old run is refused for good. Sequence numbers start at 0: what came before the first one
/// heard of the first run is not counted as lost (the listener may have started later), but a run
/// that replaces another is expected from 0. Of a gap, the newest 256 numbers are remembered; what
/// arrives later than that counts as a duplicate and stays counted as lost.
///
/// A number more than kStepMax beyond the newest is refused, so that one forged number silences
/// nobody; it is believed when kBelieveSteps in a row go on from it and (with a clock) nothing else
/// was heard of the run for kBelieveSilence. After a shorter gap that is still longer than what is
/// remembered, a number before it with a newer time is believed: the gap was forged.
class StreamMonitor {
 public:
  static constexpr std::int64_t kStepMax = 10'000;
  static constexpr int kBelieveSteps = 10;
  static constexpr Duration kBelieveSilence = std::chrono::seconds(2);
  /// Of a stamp in the future, no more than this counts when runs are compared by their times.
  static constexpr Duration kFutureMax = std::chrono::seconds(2);

  /// Precondition: stamp.sequence ≥ 0 (from_wire sees to it). Cost: constant, bounded memory.
  Arrival judge(const models::Stamp& stamp, const StreamRules& rules = {});
  [[nodiscard]] const StreamCounts& counts() const { return counts_; }

 private:
  [[nodiscard]] bool may_begin(const models::Stamp& stamp, const StreamRules& rules) const;
  void begin_run(const models::Stamp& stamp);
  void advance_to(const models::Stamp& stamp, const StreamRules& rules);
  void go_back_before_gap();
  /// Whether a number beyond kStepMax is believed.
  bool believes_step(std::int64_t sequence, const StreamRules& rules);

  static constexpr std::size_t kRetiredRunsKept = 16;
  static constexpr std::size_t kMissingKept = 256;
  bool heard_any_ = false;
  std::int64_t run_id_ = 0;
  std::int64_t first_sequence_ = 0;
  std::int64_t newest_sequence_ = -1;
  Time newest_time_{};
  std::optional<Time> heard_;    ///< when the run last was fresh, by the listener's clock
  std::int64_t gap_begin_ = -1;  ///< newest number before a gap longer than what is remembered
  std::int64_t gap_lost_ = 0;
  std::int64_t refused_sequence_ = 0;  ///< newest number that was too far ahead
  int refused_steps_ = 0;              ///< such in a row that went on from one another
  std::vector<std::int64_t> retired_runs_;
  std::vector<std::int64_t> missing_;
  StreamCounts counts_;
};

/// Judges a channel on which several processes may publish: each run is a stream of its own, and
/// none replaces another. So an operator's second console does not silence the first.
///
/// At most 32 runs are remembered; the one silent for the most messages gives way.
class SharedStreamMonitor {
 public:
  /// Precondition: stamp.sequence ≥ 0. Cost: bounded time and memory.
  Arrival judge(const models::Stamp& stamp, const StreamRules& rules = {});
  /// Sums over every run ever heard.
  [[nodiscard]] StreamCounts counts() const;

 private:
  static constexpr std::size_t kRunsKept = 32;
  struct Run {
    std::int64_t run_id = 0;
    std::int64_t judged_last = 0;  ///< value of judged_ then
    StreamMonitor stream;
  };
  std::vector<Run> runs_;
  std::int64_t judged_ = 0;
  StreamCounts forgotten_;  ///< of runs that gave way
};

}  // namespace vantage::bus

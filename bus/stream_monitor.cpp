#include "bus/stream_monitor.hpp"

#include <algorithm>
#include <limits>

namespace vantage::bus {
namespace {

/// A hostile sequence number may claim that 2⁶³ messages were lost, more than once.
void add_saturating(std::int64_t& sum, std::int64_t more) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  sum = more > kMax - sum ? kMax : sum + more;
}

void add(StreamCounts& sum, const StreamCounts& more) {
  add_saturating(sum.fresh, more.fresh);
  add_saturating(sum.lost, more.lost);
  add_saturating(sum.duplicates, more.duplicates);
  add_saturating(sum.reordered, more.reordered);
  add_saturating(sum.old_runs, more.old_runs);
  add_saturating(sum.runs, more.runs);
}

}  // namespace

void StreamMonitor::advance_to(const models::Stamp& stamp) {
  const std::int64_t skipped =
      stamp.sequence - (newest_sequence_ + 1);  // in this order: no overflow
  add_saturating(counts_.lost, skipped);
  const auto kept = static_cast<std::int64_t>(kMissingKept);
  for (std::int64_t missing = stamp.sequence - std::min(skipped, kept); missing < stamp.sequence;
       ++missing) {
    missing_.push_back(missing);
  }
  if (missing_.size() > kMissingKept) {
    missing_.erase(missing_.begin(), missing_.end() - static_cast<std::ptrdiff_t>(kMissingKept));
  }
  newest_sequence_ = stamp.sequence;
  newest_time_ = std::max(newest_time_, stamp.time);
  ++counts_.fresh;
}

void StreamMonitor::begin_run(const models::Stamp& stamp) {
  if (heard_any_) {
    retired_runs_.push_back(run_id_);
    if (retired_runs_.size() > kRetiredRunsKept) {
      retired_runs_.erase(retired_runs_.begin());
    }
  }
  // Of the first run heard, what came before is none of our business; a later one starts at 0.
  first_sequence_ = heard_any_ ? 0 : stamp.sequence;
  newest_sequence_ = first_sequence_ - 1;
  missing_.clear();
  heard_any_ = true;
  run_id_ = stamp.run_id;
  newest_time_ = stamp.time;
  ++counts_.runs;
}

Arrival StreamMonitor::judge(const models::Stamp& stamp) {
  if (!heard_any_ || stamp.run_id != run_id_) {
    const bool is_retired =
        std::find(retired_runs_.begin(), retired_runs_.end(), stamp.run_id) != retired_runs_.end();
    if (heard_any_ && (is_retired || stamp.time < newest_time_)) {
      ++counts_.old_runs;
      return Arrival::kOldRun;
    }
    begin_run(stamp);
  }
  if (stamp.sequence > newest_sequence_) {
    advance_to(stamp);
    return Arrival::kFresh;
  }
  const auto missing = std::find(missing_.begin(), missing_.end(), stamp.sequence);
  const bool was_before_first = stamp.sequence < first_sequence_;
  if (missing == missing_.end() && !was_before_first) {
    ++counts_.duplicates;
    return Arrival::kDuplicate;
  }
  if (missing != missing_.end()) {
    missing_.erase(missing);
    --counts_.lost;
  }
  ++counts_.reordered;
  return Arrival::kReordered;
}

Arrival SharedStreamMonitor::judge(const models::Stamp& stamp) {
  ++judged_;
  auto run = std::find_if(runs_.begin(), runs_.end(),
                          [&](const Run& known) { return known.run_id == stamp.run_id; });
  if (run == runs_.end()) {
    if (runs_.size() == kRunsKept) {
      const auto silent = std::min_element(
          runs_.begin(), runs_.end(),
          [](const Run& a, const Run& b) { return a.judged_last < b.judged_last; });
      add(forgotten_, silent->stream.counts());
      runs_.erase(silent);
    }
    run = runs_.insert(runs_.end(), Run{stamp.run_id, 0, {}});
  }
  run->judged_last = judged_;
  return run->stream.judge(stamp);
}

StreamCounts SharedStreamMonitor::counts() const {
  StreamCounts total = forgotten_;
  for (const Run& run : runs_) {
    add(total, run.stream.counts());
  }
  return total;
}

}  // namespace vantage::bus

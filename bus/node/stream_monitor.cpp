#include "bus/node/stream_monitor.hpp"

#include <algorithm>
#include <limits>

namespace vantage::bus {
namespace {

/// Adds without overflow, because a forged sequence number can claim 2⁶³ lost messages repeatedly.
void add_saturating(std::int64_t& sum, std::int64_t more) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  sum = more > kMax - sum ? kMax : sum + more;
}

}  // namespace

void StreamCounts::add(const StreamCounts& more) {
  add_saturating(fresh, more.fresh);
  add_saturating(lost, more.lost);
  add_saturating(duplicates, more.duplicates);
  add_saturating(reordered, more.reordered);
  add_saturating(old_runs, more.old_runs);
  add_saturating(too_far_ahead, more.too_far_ahead);
  add_saturating(runs, more.runs);
}

void StreamMonitor::advance_to(const models::Stamp& stamp, const StreamRules& rules) {
  // this order of operations avoids overflow
  const std::int64_t skipped = stamp.sequence - (newest_sequence_ + 1);
  add_saturating(counts_.lost, skipped);
  const auto kept = static_cast<std::int64_t>(kMissingKept);
  if (skipped > kept) {
    gap_begin_ = newest_sequence_;
    gap_lost_ = skipped;
  }
  for (std::int64_t missing = stamp.sequence - std::min(skipped, kept); missing < stamp.sequence;
       ++missing) {
    missing_.push_back(missing);
  }
  if (missing_.size() > kMissingKept) {
    missing_.erase(missing_.begin(), missing_.end() - static_cast<std::ptrdiff_t>(kMissingKept));
  }
  newest_sequence_ = stamp.sequence;
  const Time accepted_time = rules.now ? std::min(stamp.time, *rules.now + kFutureMax) : stamp.time;
  newest_time_ = std::max(newest_time_, accepted_time);
  received_at_ = rules.now;
  refused_steps_ = 0;
  ++counts_.fresh;
}

void StreamMonitor::discard_forged_gap() {
  counts_.lost -= std::min(counts_.lost, gap_lost_);
  newest_sequence_ = gap_begin_;
  gap_begin_ = -1;
  missing_.clear();
}

bool StreamMonitor::accepts_step(std::int64_t sequence, const StreamRules& rules) {
  const bool is_continuation = refused_steps_ > 0 && sequence > refused_sequence_ &&
                               sequence - refused_sequence_ <= kStepMax;
  refused_steps_ = is_continuation ? refused_steps_ + 1 : 1;
  refused_sequence_ = sequence;
  const bool is_silent =
      !rules.now || !received_at_ || *rules.now - *received_at_ >= kAcceptSilence;
  return refused_steps_ >= kAcceptSteps && is_silent;
}

bool StreamMonitor::may_begin(const models::Stamp& stamp, const StreamRules& rules) const {
  if (!has_received_) {
    return true;
  }
  if (rules.lease > Duration{} && rules.now && received_at_) {
    return *rules.now - *received_at_ >= rules.lease;
  }
  const bool is_retired =
      std::find(retired_runs_.begin(), retired_runs_.end(), stamp.run_id) != retired_runs_.end();
  return !is_retired && stamp.time >= newest_time_;
}

void StreamMonitor::begin_run(const models::Stamp& stamp) {
  if (has_received_) {
    retired_runs_.push_back(run_id_);
    if (retired_runs_.size() > kRetiredRunsKept) {
      retired_runs_.erase(retired_runs_.begin());
    }
  }
  // For the first run and for a returning run, messages before the first received message are not
  // counted as lost. Any other run is assumed to start at 0, unless its first number is implausibly
  // large.
  const bool was_retired = std::erase(retired_runs_, stamp.run_id) > 0;
  const bool is_late = !has_received_ || was_retired || stamp.sequence >= kStepMax;
  first_sequence_ = is_late ? stamp.sequence : 0;
  newest_sequence_ = first_sequence_ - 1;
  missing_.clear();
  gap_begin_ = -1;
  refused_steps_ = 0;
  has_received_ = true;
  run_id_ = stamp.run_id;
  newest_time_ = Time::min();
  ++counts_.runs;
}

Arrival StreamMonitor::judge(const models::Stamp& stamp, const StreamRules& rules) {
  if (!has_received_ || stamp.run_id != run_id_) {
    if (!may_begin(stamp, rules)) {
      ++counts_.old_runs;
      return Arrival::kOldRun;
    }
    begin_run(stamp);
  }
  if (stamp.sequence > newest_sequence_) {
    if (stamp.sequence - newest_sequence_ > kStepMax && !accepts_step(stamp.sequence, rules)) {
      ++counts_.too_far_ahead;
      return Arrival::kTooFarAhead;
    }
    advance_to(stamp, rules);
    return Arrival::kFresh;
  }
  const auto missing = std::find(missing_.begin(), missing_.end(), stamp.sequence);
  const bool was_before_first = stamp.sequence < first_sequence_;
  const bool is_gap_forged = stamp.sequence > gap_begin_ && gap_begin_ >= 0 &&
                             missing == missing_.end() && stamp.time > newest_time_;
  if (is_gap_forged) {
    discard_forged_gap();
    advance_to(stamp, rules);
    return Arrival::kFresh;
  }
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

Arrival SharedStreamMonitor::judge(const models::Stamp& stamp, const StreamRules& rules) {
  ++judged_;
  auto run = std::find_if(runs_.begin(), runs_.end(),
                          [&](const Run& known) { return known.run_id == stamp.run_id; });
  if (run == runs_.end()) {
    if (runs_.size() == kRunsKept) {
      const auto silent = std::min_element(
          runs_.begin(), runs_.end(),
          [](const Run& a, const Run& b) { return a.judged_last < b.judged_last; });
      forgotten_.add(silent->stream.counts());
      runs_.erase(silent);
    }
    run = runs_.insert(runs_.end(), Run{stamp.run_id, 0, {}});
  }
  run->judged_last = judged_;
  return run->stream.judge(stamp, rules);
}

StreamCounts SharedStreamMonitor::counts() const {
  StreamCounts total = forgotten_;
  for (const Run& run : runs_) {
    total.add(run.stream.counts());
  }
  return total;
}

}  // namespace vantage::bus

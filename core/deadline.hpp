#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace vantage {

/// Returns the time of the monotonic clock, ns. For deadlines, ages and loop statistics; not for
/// message content.
std::int64_t monotonic_ns();

/// Limit of a computation: an instant of the monotonic clock, a number of nodes, or the earlier of
/// the two.
///
/// With a node budget alone the computation is a pure function of its inputs. A computation that
/// the clock stopped after N nodes stops at the same point under Deadline::nodes(N). This requires
/// that the computation calls expired() at the same points and processes at least one node between
/// two calls. Exact replay of a flight depends on this property.
class Deadline {
 public:
  /// Expires when `budget_nodes` nodes have been processed, independent of the clock.
  static Deadline nodes(std::int64_t budget_nodes) { return {budget_nodes, kNever}; }
  /// Expires when monotonic_ns() reaches `instant_ns`.
  static Deadline at(std::int64_t instant_ns) { return {kNever, instant_ns}; }
  /// Expires at the budget or at the instant, whichever comes first.
  static Deadline either(std::int64_t budget_nodes, std::int64_t instant_ns) {
    return {budget_nodes, instant_ns};
  }
  static Deadline never() { return {kNever, kNever}; }
  /// Returns this deadline with cancellation: it also expires when `is_cancelled` returns true, for
  /// example when a user aborts. `is_cancelled` is called whenever the clock is read. The function
  /// must be cheap; after the first true result, all further results must be true.
  [[nodiscard]] Deadline with_cancellation(bool (*is_cancelled)()) const {
    Deadline out = *this;
    out.is_cancelled_ = is_cancelled;
    return out;
  }

  /// Returns a deadline with the same node budget and a third of the remaining time, for a
  /// computation that is followed by other computations. Reads the clock once, unless there is only
  /// a node budget.
  [[nodiscard]] Deadline third() const {
    Deadline out = *this;
    if (instant_ns_ != kNever) {
      const std::int64_t now_ns = monotonic_ns();
      out.instant_ns_ = std::min(instant_ns_, now_ns + (instant_ns_ - now_ns) / 3);
    }
    return out;
  }

  /// True if the computation must stop. Reads the clock once (about 30 ns) unless there is only a
  /// node budget.
  [[nodiscard]] bool expired(std::int64_t nodes_done) const {
    return nodes_done >= budget_nodes_ ||
           (instant_ns_ != kNever && monotonic_ns() >= instant_ns_) ||
           (is_cancelled_ != nullptr && is_cancelled_());
  }

  [[nodiscard]] std::int64_t instant_ns() const { return instant_ns_; }
  [[nodiscard]] std::int64_t budget_nodes() const { return budget_nodes_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  Deadline(std::int64_t budget_nodes, std::int64_t instant_ns)
      : budget_nodes_(budget_nodes), instant_ns_(instant_ns) {}

  std::int64_t budget_nodes_;
  std::int64_t instant_ns_;
  bool (*is_cancelled_)() = nullptr;
};

}  // namespace vantage

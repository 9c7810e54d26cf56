#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/liveness.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Behaviour of one process on the bus. A node subscribes in its constructor, is called at times
/// that it chooses, and publishes. In flight each node has its own process (run_node). In virtual
/// time many nodes share a thread and a VirtualClock. A node cannot detect whether it runs in
/// flight or in virtual time.
class Node {
 public:
  Node() = default;
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  Node(Node&&) = delete;
  Node& operator=(Node&&) = delete;

  /// Returns the name used on HEALTH_<name>, for example "ESTIMATOR_Q1".
  [[nodiscard]] virtual std::string name() const = 0;
  /// Returns the time of the next call of tick(). After tick(t), the returned time must be later
  /// than t.
  [[nodiscard]] virtual Time next_tick() const = 0;
  /// Does the periodic work. `now` ≥ next_tick(); the delay depends on the machine.
  virtual void tick(Time now) = 0;
  /// Returns a descriptor; when it is readable, tick() is called even before next_tick(). −1: none.
  /// With a descriptor, bus messages are only handled when the descriptor is readable or at
  /// next_tick(). Used by nodes that process the data of a device.
  [[nodiscard]] virtual int wakes_on() const { return -1; }
  /// Reports how long the node's thread waited for a processor in the last second, s. Called before
  /// a tick in real time if the kernel counts this time; never in virtual time.
  virtual void on_processor_wait(double /*wait_s*/) {}
  /// Returns the number of dropped and missed items, by name.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const { return {}; }
  [[nodiscard]] virtual std::int64_t deadlines_missed() const { return 0; }

  // Shutdown. A vehicle's node needs time to end; most other nodes end immediately.
  /// Called when the process receives a stop request. `requests`: number received so far; more than
  /// one means that the stop is urgent.
  virtual void on_stop_request(int /*requests*/, Time /*now*/) {}
  /// Called in each loop after a stop request; returns true once the process may end.
  virtual bool may_end(Time /*now*/) { return true; }
  /// Called after may_end(). Returns one sentence that states what could not be completed before
  /// the end, or an empty text.
  [[nodiscard]] virtual std::string end_fault() const { return ""; }
  /// Returns whether the node's vehicle may be flying or moving.
  [[nodiscard]] virtual InFlight in_flight(Time /*now*/) const { return InFlight::kUnknown; }
};

/// Returns the resources that a process uses, by name (bus/node/process_usage).
using Usage = std::function<std::vector<models::NamedCount>()>;

/// Returns the time that the calling thread has waited for a processor since its start, µs; nullopt
/// if the kernel does not count this time (ThreadWait).
using WaitCounter = std::function<std::optional<std::int64_t>()>;

/// Publisher of HEALTH_<name>: every second, and when a counter that indicates a fault has changed
/// (at most ten times per second). The caller passes the duration of each loop. The state is
/// "degraded" if anything was dropped or missed since the last regular report.
class HealthReporter {
 public:
  /// @param usage returns additional counters of the resources used; may be empty
  HealthReporter(Bus& bus, const Node& node, Usage usage = {});
  void on_loop(Time now, double loop_s);
  /// Publishes a report immediately.
  void publish(Time now, models::ProcessState state);

 private:
  /// Returns the sum of all counters that should stay 0. It changes when anything was dropped or
  /// missed.
  [[nodiscard]] std::int64_t fault_sum() const;

  Bus& bus_;
  const Node& node_;
  Usage usage_;
  Time next_{};                          ///< time of the next report
  Time next_on_change_{};                ///< earliest time of the next report on a change
  std::int64_t fault_sum_reported_ = 0;  ///< fault_sum() in the newest report
  std::int64_t fault_sum_last_second_ = 0;
  std::int64_t loops_ = 0;
  double loop_worst_s_ = 0.0;
};

/// Runs `node` on `bus` in real time until the log that the bus reads has ended, or until
/// stop_requests() is not 0 and the node may end. Then publishes a last HEALTH. Bus messages are
/// handled while waiting for next_tick() (see also Node::wakes_on()). stop_requests() returns the
/// number of stop requests so far, and is called at least every 50 ms. Exceptions of handlers and
/// of the node are passed on to the caller.
/// @param life receives a sign of life in each loop; may be null
/// @param wait  read every 50 ms for Node::on_processor_wait(); may be empty
void run_node(Bus& bus, Node& node, const Clock& clock, const std::function<int()>& stop_requests,
              const Usage& usage = {}, LivenessSender* life = nullptr,
              const WaitCounter& wait = {});

}  // namespace vantage::bus

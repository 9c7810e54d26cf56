#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "core/life_line.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// One process's worth of behaviour: it subscribes in its constructor, wakes at times of its own
/// choosing, publishes. In flight each node has a process (run_node); in a trial in virtual time
/// many nodes share a thread and a VirtualClock. A node cannot tell the difference.
class Node {
 public:
  Node() = default;
  virtual ~Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  Node(Node&&) = delete;
  Node& operator=(Node&&) = delete;

  /// Its name on HEALTH_<name>, for example "ESTIMATOR_Q1".
  [[nodiscard]] virtual std::string name() const = 0;
  /// When tick() wants to be called next; after a tick at t it must be later than t.
  [[nodiscard]] virtual Time next_tick() const = 0;
  /// `now` ≥ next_tick(), by how much depends on the machine.
  virtual void tick(Time now) = 0;
  /// A descriptor that, once readable, makes tick() due before next_tick(); −1: none. With one,
  /// messages from the bus are handled when it is readable or next_tick() has come, so it is for
  /// nodes that work on what a device says.
  [[nodiscard]] virtual int wakes_on() const { return -1; }
  /// Reports how long the node's thread waited for a processor in the last second, s. Called before
  /// a tick in real time, where the kernel counts it; never in virtual time.
  virtual void on_processor_wait(double /*wait_s*/) {}
  /// Everything it dropped or missed, by name.
  [[nodiscard]] virtual std::vector<models::NamedCount> counters() const { return {}; }
  [[nodiscard]] virtual std::int64_t deadlines_missed() const { return 0; }

  // The end. A node of a vehicle needs time for it; most end at once.
  /// The process was asked to end, `requests` times so far; more than once: in a hurry.
  virtual void on_stop_request(int /*requests*/, Time /*now*/) {}
  /// Asked in each loop after a stop request: true once the process may end.
  virtual bool may_end(Time /*now*/) { return true; }
  /// Returns, after may_end(), what could not be done before the end, in one sentence; or nothing.
  [[nodiscard]] virtual std::string end_fault() const { return ""; }
  /// Whether the node's vehicle may be in the air or move.
  [[nodiscard]] virtual InFlight in_flight(Time /*now*/) const { return InFlight::kUnknown; }
};

/// What a process takes of its machine, by name (bus/node/process_usage).
using Usage = std::function<std::vector<models::NamedCount>()>;

/// Returns the time that the calling thread has waited for a processor since its start, µs, if it
/// is counted (ThreadWait).
using WaitCounter = std::function<std::optional<std::int64_t>()>;

/// Publishes HEALTH_<name> each second and when a counter other than those of plain traffic
/// changed (at most ten times a second). The caller says how long each loop took. The state is
/// "degraded" while something was dropped or missed since the report of the last full second.
class HealthReporter {
 public:
  /// @param usage  more counters, of the machine rather than the node; may be empty
  HealthReporter(Bus& bus, const Node& node, Usage usage = {});
  void on_loop(Time now, double loop_s);
  /// Reports now, whatever the time.
  void publish(Time now, models::ProcessState state);

 private:
  /// Sum of everything that should be 0; it changes when something was dropped or missed.
  [[nodiscard]] std::int64_t trouble() const;

  Bus& bus_;
  const Node& node_;
  Usage usage_;
  Time next_{};                        ///< report due
  Time next_on_change_{};              ///< not before this
  std::int64_t trouble_reported_ = 0;  ///< by the newest report
  std::int64_t trouble_last_second_ = 0;
  std::int64_t loops_ = 0;
  double loop_worst_s_ = 0.0;
};

/// Runs `node` on `bus` in real time until its log is at its end, or until stop_requests() is not 0
/// and the node may end; then publishes a last HEALTH. Messages are handled while it waits for
/// next_tick() (see also Node::wakes_on()). stop_requests(), the number of requests so far, is
/// called at least every 50 ms. What a handler or the node throws comes out here.
/// @param life  written to in each loop; may be null
/// @param wait  is read every 50 ms for Node::on_processor_wait(); may be empty
void run_node(Bus& bus, Node& node, const Clock& clock, const std::function<int()>& stop_requests,
              const Usage& usage = {}, LifeSign* life = nullptr, const WaitCounter& wait = {});

}  // namespace vantage::bus

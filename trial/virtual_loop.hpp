#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "bus/transport/transport.hpp"
#include "core/time.hpp"
#include "trial/recipe.hpp"
#include "trial/simulated_network.hpp"

namespace vantage::trial {

/// Event loop for many nodes in one thread and virtual time. Between two instants every message is
/// delivered to all subscribers, in the order in which they were connected. At each instant the due
/// nodes are executed in the order of add_node(). The messages of each node are delivered before
/// the next node is executed. So a run depends only on the nodes and their seeds.
class VirtualTimeLoop {
 public:
  explicit VirtualTimeLoop(Time start) : clock_(start) {}
  /// As above, with the network of `scenario` between the robots: its budget and its simulated
  /// faults. `scenario` must outlive the loop.
  VirtualTimeLoop(Time start, const scenario::Scenario& scenario);

  [[nodiscard]] const bus::Clock& clock() const { return clock_; }
  /// Returns an endpoint for raw bytes. Its caller must call handle(). It receives all messages
  /// published after this call.
  std::unique_ptr<bus::Transport> connect() { return hub_.connect(); }
  /// Adds a bus of a process on `host` (NodeRecipe::host). This loop calls its handle().
  bus::Bus& add_bus(std::int64_t run_id, const std::string& host = "");
  /// Creates a node, which this loop executes from now on, including its HEALTH reports.
  void add_node(const NodeRecipe& recipe, std::int64_t run_id);
  /// Sets an action that is called after each delivery, for example to empty the queue of a
  /// recorder.
  void on_delivered(std::function<void()> action) { on_delivered_ = std::move(action); }

  /// Processes every instant before `end`, then sets the clock to `end`.
  /// @throws std::logic_error when a node's next tick does not advance.
  void run_until(Time end);
  /// Delivers messages until all queues are empty.
  void deliver();
  /// Returns the number of messages lost: gaps in the streams of all buses, and messages dropped by
  /// full queues.
  [[nodiscard]] std::int64_t messages_lost() const;
  /// Returns the simulated network; null: all messages arrive.
  [[nodiscard]] const SimulatedNetwork* network() const { return network_.get(); }

 private:
  struct Participant {
    std::unique_ptr<bus::Transport> transport;
    std::unique_ptr<bus::Bus> bus;
    std::unique_ptr<bus::Node> node;  ///< null for a bus without a node
    std::unique_ptr<bus::HealthReporter> health;
  };
  /// Returns the index ≥ `from` of the first participant with a message in its queue;
  /// participants_.size() if there is none.
  [[nodiscard]] std::size_t next_waiting(std::size_t from) const;

  bus::VirtualClock clock_;
  std::unique_ptr<SimulatedNetwork> network_;    ///< outlives hub_
  const scenario::Scenario* limited_ = nullptr;  ///< scenario with a budget; null: no budget
  bus::InProcessHub hub_;
  std::vector<std::uint8_t> waiting_;  ///< per participant: 1 if its queue has a message
  std::size_t waiting_count_ = 0;
  std::vector<Participant> participants_;
  std::function<void()> on_delivered_ = [] {};
};

}  // namespace vantage::trial

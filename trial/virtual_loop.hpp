#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "bus/transport/transport.hpp"
#include "core/time.hpp"
#include "trial/recipe.hpp"

namespace vantage::trial {

/// Many nodes, one thread, time that jumps. Between two instants every message is delivered to
/// every listener, in the order of connecting; at each instant the nodes that are due act in the
/// order of adding, each one's messages being delivered before the next acts. So a run is a pure
/// function of the nodes and their seeds.
class VirtualTimeLoop {
 public:
  explicit VirtualTimeLoop(Time start) : clock_(start) {}

  [[nodiscard]] const bus::Clock& clock() const { return clock_; }
  /// An endpoint that its owner handles, for raw bytes; it hears what is published from now on.
  std::unique_ptr<bus::Transport> connect() { return hub_.connect(); }
  /// A bus that this loop handles.
  bus::Bus& add_bus(std::int64_t run_id);
  /// Makes a node and runs it from now on, its HEALTH reports included.
  void add_node(const NodeRecipe& recipe, std::int64_t run_id);
  /// Something else to do after each delivery, as draining a recorder.
  void on_delivered(std::function<void()> action) { on_delivered_ = std::move(action); }

  /// Acts on every instant before `end`, then stands at `end`.
  /// @throws std::logic_error when a node's next tick does not move on.
  void run_until(Time end);
  /// Delivers until nothing is left.
  void deliver();
  /// Gaps in the streams heard by any bus, and messages that a full queue dropped.
  [[nodiscard]] std::int64_t messages_lost() const;

 private:
  struct Participant {
    std::unique_ptr<bus::Transport> transport;
    std::unique_ptr<bus::Bus> bus;
    std::unique_ptr<bus::Node> node;  ///< may be none
    std::unique_ptr<bus::HealthReporter> health;
  };
  /// The first participant, from `from` on, that something waits for; none: participants_.size().
  [[nodiscard]] std::size_t next_waiting(std::size_t from) const;

  bus::VirtualClock clock_;
  bus::InProcessHub hub_;
  std::vector<std::uint8_t> waiting_;  ///< per participant: something is in its queue
  std::size_t waiting_count_ = 0;
  std::vector<Participant> participants_;
  std::function<void()> on_delivered_ = [] {};
};

}  // namespace vantage::trial

#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/node.hpp"
#include "bus/transport/transport.hpp"
#include "trial/recipe.hpp"

namespace vantage::tools {

/// One node with its bus and its thread. The owner's thread may use the node before start() and
/// after join(); between these calls only the node's own thread may use it.
class NodeThread {
 public:
  NodeThread(bus::InProcessHub& hub, const bus::Clock& clock, const trial::NodeRecipe& recipe);
  ~NodeThread() { join(); }
  NodeThread(const NodeThread&) = delete;
  NodeThread& operator=(const NodeThread&) = delete;
  NodeThread(NodeThread&&) = delete;
  NodeThread& operator=(NodeThread&&) = delete;

  /// Runs the node until `stop` returns true. If the node throws, its thread calls `on_failure`.
  void start(std::function<bool()> stop, std::function<void()> on_failure);
  /// Waits for the thread. Precondition: stop() returns true, or start() was never called.
  void join();
  /// Returns, after join(), the node's name and exception; empty if it threw none.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Returns, after join(), the number of lost messages: gaps in the sequence numbers and messages
  /// dropped from a full queue.
  [[nodiscard]] std::int64_t messages_lost() const;

 private:
  std::string name_;
  const bus::Clock& clock_;
  std::unique_ptr<bus::Transport> transport_;
  bus::Bus bus_;
  std::unique_ptr<bus::Node> node_;
  std::string failure_;
  std::thread thread_;
};

}  // namespace vantage::tools

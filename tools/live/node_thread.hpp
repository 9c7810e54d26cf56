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

/// One node, its bus and its thread. Made and asked by the owner's thread before start() and after
/// join(); in between everything belongs to the node's thread.
class NodeThread {
 public:
  NodeThread(bus::InProcessHub& hub, const bus::Clock& clock, const trial::NodeRecipe& recipe);
  ~NodeThread() { join(); }
  NodeThread(const NodeThread&) = delete;
  NodeThread& operator=(const NodeThread&) = delete;
  NodeThread(NodeThread&&) = delete;
  NodeThread& operator=(NodeThread&&) = delete;

  /// Runs the node until `stop`; `on_failure` is called, on the thread, when it throws.
  void start(std::function<bool()> stop, std::function<void()> on_failure);
  /// Precondition: stop() says true by now, or start() was never called.
  void join();
  /// After join(): what the node threw, with its name; empty when it did not.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// After join(): gaps heard and messages dropped from a full queue.
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

#include "tools/live/node_thread.hpp"

#include <exception>
#include <utility>

namespace vantage::tools {

NodeThread::NodeThread(bus::InProcessHub& hub, const bus::Clock& clock,
                       const trial::NodeRecipe& recipe)
    : name_(recipe.name),
      clock_(clock),
      transport_(hub.connect()),
      bus_(*transport_, bus::random_run_id()),
      node_(recipe.make(bus_, clock)) {}

void NodeThread::start(std::function<bool()> stop, std::function<void()> on_failure) {
  thread_ = std::thread([this, stop = std::move(stop), on_failure = std::move(on_failure)] {
    try {
      bus::run_node(bus_, *node_, clock_, stop);
    } catch (const std::exception& error) {
      failure_ = name_ + ": " + error.what();
      on_failure();
    }
  });
}

void NodeThread::join() {
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::int64_t NodeThread::messages_lost() const {
  return bus_.messages_lost() + transport_->stats().queue_overflows;
}

}  // namespace vantage::tools

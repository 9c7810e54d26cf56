#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "bus/clock.hpp"
#include "bus/transport.hpp"
#include "logs/record/log_writer.hpp"

namespace vantage::tools {

/// Writes everything that one endpoint hears to an LCM log, stamped with the stack's clock.
/// Connect it before anyone publishes: then the log's first event is the first message.
class Recorder {
 public:
  /// @throws StartupError when `path` cannot be written.
  Recorder(std::unique_ptr<bus::Transport> endpoint, const bus::Clock& clock,
           const std::string& path);
  /// Waits up to `timeout`, then writes what has arrived; how many messages.
  int handle(std::chrono::microseconds timeout) { return endpoint_->handle(timeout); }
  [[nodiscard]] std::int64_t events() const { return log_.events(); }
  /// Messages that never got into the log.
  [[nodiscard]] std::int64_t messages_lost() const {
    return log_.events_lost() + endpoint_->stats().queue_overflows;
  }

 private:
  logs::LogWriter log_;
  std::unique_ptr<bus::Transport> endpoint_;
};

}  // namespace vantage::tools

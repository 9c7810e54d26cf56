#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "bus/node/clock.hpp"
#include "bus/transport/transport.hpp"
#include "logs/file/seekable_log.hpp"
#include "logs/types/type_library.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/history.hpp"
#include "tools/view/web_server.hpp"

namespace vantage::tools {

/// Server that shows the messages of a bus until it is destroyed. One thread receives; the threads
/// of the web server serve viewers. Viewers that connect later get up to 8 MiB of history. `types`:
/// message types for raw messages.
class LiveView {
 public:
  /// @throws StartupError if the address cannot be used.
  LiveView(std::unique_ptr<bus::Transport> transport, const WebOptions& options,
           logs::TypeLibrary types = {});
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;
  LiveView(LiveView&&) = delete;
  LiveView& operator=(LiveView&&) = delete;

  [[nodiscard]] const WebServer& server() const { return server_; }
  [[nodiscard]] const Broker& broker() const { return broker_; }
  /// Returns the error that ended the reception; empty while the server receives.
  [[nodiscard]] std::string failure() const;

 private:
  void listen();

  std::unique_ptr<bus::Transport> transport_;
  logs::TypeLibrary types_;
  bus::SystemClock clock_;
  Broker broker_;
  History history_;
  WebServer server_;
  std::atomic<bool> is_over_ = false;
  mutable std::mutex mutex_;  ///< guards failure_
  std::string failure_;
  std::thread thread_;
};

/// Serves a log until `stop` returns true. Calls `ready` with the server, then begins at
/// first_picture(), paused unless `is_playing`. If the first pass over the log is not complete, the
/// pass continues in another thread, and viewers see its progress.
/// @throws StartupError if the address cannot be used.
void serve_log(logs::SeekableLog& log, const logs::TypeLibrary& types, const WebOptions& options,
               bool is_playing, const std::function<void(const WebServer&)>& ready,
               const std::function<bool()>& stop);

}  // namespace vantage::tools

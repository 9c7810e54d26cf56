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

/// Serves what is on a bus until it is destroyed: one thread listens, the web server's do the rest.
/// Viewers who come late are handed what there was before, up to 8 MiB of it. `types`: what else
/// may be read than the house's messages.
class LiveView {
 public:
  /// @throws StartupError when the address cannot be had.
  LiveView(std::unique_ptr<bus::Transport> transport, const WebOptions& options,
           logs::TypeLibrary types = {});
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;
  LiveView(LiveView&&) = delete;
  LiveView& operator=(LiveView&&) = delete;

  [[nodiscard]] const WebServer& server() const { return server_; }
  [[nodiscard]] const Broker& broker() const { return broker_; }
  /// Why it does not listen any more; empty while it does.
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
  mutable std::mutex mutex_;  ///< of failure_
  std::string failure_;
  std::thread thread_;
};

/// Serves a log from its first picture on, paused unless `is_playing`, until `stop` says so;
/// `ready` is told the server first. Where the first pass over the log is not over it goes on
/// meanwhile, and viewers are told how far it is.
/// @throws StartupError when the address cannot be had.
void serve_log(logs::SeekableLog& log, const logs::TypeLibrary& types, const WebOptions& options,
               bool is_playing, const std::function<void(const WebServer&)>& ready,
               const std::function<bool()>& stop);

}  // namespace vantage::tools

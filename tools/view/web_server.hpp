#pragma once

#include <functional>
#include <memory>
#include <string>

#include "tools/view/broker.hpp"

namespace vantage::tools {

struct WebOptions {
  std::string bind = "127.0.0.1";
  int port = 8765;          ///< 0: any free one
  std::string page_folder;  ///< of the built page; without index.html a note is served instead
  /// Answers GET /api/history: JSON of what the log holds, for charts and marks. Any thread.
  std::function<std::string()> history;
};

/// HTTP and WebSocket on one port, by civetweb: the page's files, and a Broker's frames to any
/// number of viewers up to a bound. A thread per connection reads, another one writes. It never
/// writes anything but to its sockets.
class WebServer {
 public:
  /// @throws StartupError when the address cannot be had.
  WebServer(Broker& broker, const WebOptions& options);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  WebServer(WebServer&&) = delete;
  WebServer& operator=(WebServer&&) = delete;

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8765".
  [[nodiscard]] std::string url() const;
  [[nodiscard]] bool has_page() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vantage::tools

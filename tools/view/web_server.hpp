#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/view/broker.hpp"
#include "tools/view/recording_receiver.hpp"

namespace vantage::tools {

struct WebOptions {
  std::string bind = "127.0.0.1";
  int port = 8765;     ///< 0: any unused port
  std::string source;  ///< LCM URL that a live view listens to, for the page; empty: none
  std::string
      page_folder;  ///< folder of the built page; without index.html a note is served instead
  /// Further host names that requests may use, in addition to addresses, localhost and this host's
  /// own name.
  std::vector<std::string> hosts;
  /// Other servers with pages that may connect, such as "https://viewer.example". Pages of Foxglove
  /// and of this host (Lichtblick) may always connect.
  std::vector<std::string> origins;
  /// Answers GET /api/history: JSON of past records for charts, marks and paths. Called on any
  /// thread.
  std::function<std::string()> history;
  /// Answers GET /api/series?topic=…&field=…: one number over the complete log. Called on any
  /// thread, one call at a time. Empty function: live, without a log.
  std::function<std::string(const std::string& topic, const std::string& pointer)> series;
  /// Answers POST /api/operate/WHAT of an operator page: (WHAT, key, token, body) → status and
  /// JSON. Called on any thread. Empty function: this server takes no orders.
  std::function<std::pair<int, std::string>(const std::string& what, const std::string& key,
                                            const std::string& token, const std::string& body)>
      operate;
  /// Receives the video of a recording page (POST /api/recording?key=…); null: not accepted.
  RecordingReceiver* recording = nullptr;
};

/// HTTP and WebSocket server on one port (civetweb). It serves the page's files, and a Broker's
/// frames to a bounded number of viewers. Each connection has a thread that reads and a thread that
/// writes. The server writes only to its sockets.
class WebServer {
 public:
  /// @throws StartupError if the address cannot be used.
  WebServer(Broker& broker, const WebOptions& options);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;
  WebServer(WebServer&&) = delete;
  WebServer& operator=(WebServer&&) = delete;

  /// Returns the address of the page, such as "http://127.0.0.1:8765".
  [[nodiscard]] std::string url() const;
  [[nodiscard]] bool has_page() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vantage::tools

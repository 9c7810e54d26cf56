#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/view/broker.hpp"
#include "tools/view/recording_desk.hpp"

namespace vantage::tools {

struct WebOptions {
  std::string bind = "127.0.0.1";
  int port = 8765;          ///< 0: any free one
  std::string page_folder;  ///< of the built page; without index.html a note is served instead
  /// Names by which browsers may ask for this host, besides addresses, localhost and its own.
  std::vector<std::string> hosts;
  /// Pages of other servers that may connect, such as "https://viewer.example"; Foxglove's own and
  /// those of this host (Lichtblick) always may.
  std::vector<std::string> origins;
  /// Answers GET /api/history: JSON of what there was, for charts, marks and ways. Any thread.
  std::function<std::string()> history;
  /// Answers GET /api/series?topic=…&field=…: one number over the whole log. One call at a time,
  /// any thread; empty: there is no log.
  std::function<std::string(const std::string& topic, const std::string& pointer)> series;
  /// Takes what a page that records has made (POST /api/recording?key=…); null: nothing is taken.
  RecordingDesk* recording = nullptr;
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
  /// Connections refused for the name or the page they came by, since the start.
  [[nodiscard]] std::int64_t refused() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vantage::tools

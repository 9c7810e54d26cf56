#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// Decides which connections of a web server are ended, so that slow ones leave room for others:
/// those whose request has not come within kHeaderPatience, and the oldest of an address, or of the
/// address that has the most, where there are too many. Viewers (WebSocket) do not count. Pure.
class ConnectionTable {
 public:
  static constexpr std::size_t kOfOneAddressMax = 32;
  static constexpr std::size_t kOfAllMax = 80;
  static constexpr Duration kHeaderPatience = std::chrono::seconds(3);

  /// The other end of a connection.
  struct Peer {
    std::string address;
    int port = 0;
    auto operator<=>(const Peer&) const = default;
  };

  /// Returns those of the `open` connections that are to be ended, each one once; forgets closed
  /// ones. To be called a few times per second.
  std::vector<Peer> update(const std::set<Peer>& open, Time now);
  /// The request of `peer` has come.
  void on_request(const Peer& peer, Time now) { entry(peer, now).has_request = true; }
  /// `peer` has become a viewer.
  void on_viewer(const Peer& peer, Time now) { entry(peer, now).counts = false; }

 private:
  struct Connection {
    Time since{};
    bool has_request = false;
    bool counts = true;  ///< neither a viewer nor to be ended
  };
  Connection& entry(const Peer& peer, Time now) {
    return all_.try_emplace(peer, Connection{now}).first->second;
  }
  void end_oldest_of(const std::string& address, std::size_t count, std::vector<Peer>& ended);

  std::map<Peer, Connection> all_;
};

}  // namespace vantage::tools

#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"

namespace vantage::tools {

/// Policy that ends slow connections of a web server, so that others can connect. A connection is
/// ended if its request does not arrive within kHeaderPatience. If an address has more than
/// kOfOneAddressMax connections, its oldest connections are ended. If the total exceeds kOfAllMax,
/// the oldest connections of the address with most connections are ended. Viewers (WebSocket) are
/// not counted. Pure: no I/O.
class ConnectionTable {
 public:
  static constexpr std::size_t kOfOneAddressMax = 32;
  static constexpr std::size_t kOfAllMax = 80;
  static constexpr Duration kHeaderPatience = std::chrono::seconds(3);

  /// Remote end of a connection.
  struct Peer {
    std::string address;
    int port = 0;
    auto operator<=>(const Peer&) const = default;
  };

  /// Returns the `open` connections to end, each of them once, and removes closed connections from
  /// the table. Call a few times per second.
  std::vector<Peer> update(const std::set<Peer>& open, Time now);
  /// Notes that the request of `peer` has arrived.
  void on_request(const Peer& peer, Time now) { entry(peer, now).has_request = true; }
  /// Notes that `peer` has become a viewer.
  void on_viewer(const Peer& peer, Time now) { entry(peer, now).counts = false; }

 private:
  struct Connection {
    Time since{};
    bool has_request = false;
    /// true: counts towards the limit; false for viewers and for connections returned by update()
    bool counts = true;
  };
  Connection& entry(const Peer& peer, Time now) {
    return all_.try_emplace(peer, Connection{now}).first->second;
  }
  void end_oldest_of(const std::string& address, std::size_t count, std::vector<Peer>& ended);

  std::map<Peer, Connection> all_;
};

}  // namespace vantage::tools

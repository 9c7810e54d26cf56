#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <netinet/in.h>

#include "bus/transport/url.hpp"

namespace vantage::bus::udpm {

/// Unicast connection between hosts, for networks that drop or slow down multicast (URL option
/// peers). On its own host each process uses the multicast group with ttl=0.
///
/// Each sending process sends a copy of every datagram to each peer. On each host, one process
/// receives these copies on the host's own address in the list of peers. It passes them to the
/// host's multicast group in a thread, so that all processes of the host receive them. The first
/// process that binds the address relays; when it ends, another process takes over.
///
/// Relayed datagrams are those of LCM with a new sequence number, because their senders share one
/// source address after the relay. Datagrams from addresses that are not peers, or not in LCM's
/// format, are dropped and counted.
class UnicastRelay {
 public:
  static constexpr std::int64_t kRetryPeriodNs = 500'000'000;

  /// Precondition: address.peers is not empty.
  explicit UnicastRelay(const UdpmAddress& address);
  ~UnicastRelay();
  UnicastRelay(const UnicastRelay&) = delete;
  UnicastRelay& operator=(const UnicastRelay&) = delete;
  UnicastRelay(UnicastRelay&&) = delete;
  UnicastRelay& operator=(UnicastRelay&&) = delete;

  /// Sends `head` and `payload` as one datagram to each peer on another host. Never waits. Returns
  /// false if a peer's copy could not be handed to the network.
  bool send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload);
  /// Determines this host's own peers, and tries to become the relay of this host, at most once per
  /// kRetryPeriodNs.
  void keep(std::int64_t monotonic_ns);

  [[nodiscard]] bool is_relaying() const { return thread_.joinable(); }
  /// Returns the number of datagrams that were dropped because they came from unknown addresses or
  /// were malformed.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  [[nodiscard]] std::int64_t relayed() const { return relayed_; }

 private:
  /// A fragmented message that is being relayed.
  struct Renumbered {
    std::uint64_t source = 0;
    std::uint32_t sequence = 0;
    std::uint32_t relayed = 0;
  };
  static constexpr std::size_t kRenumberedKept = 64;

  void relay(int receiver);
  [[nodiscard]] bool is_peer(const sockaddr_in& from) const;
  std::uint32_t number_for(std::uint64_t source, std::uint32_t sequence);

  std::vector<sockaddr_in> peers_;
  std::vector<char> is_own_;  ///< by peer: an address of this host
  sockaddr_in group_{};
  int group_fd_ = -1;  ///< sends to the group on this host
  int peer_fd_ = -1;   ///< sends to the peers
  int stop_fd_ = -1;
  std::int64_t next_try_ns_ = 0;
  std::array<Renumbered, kRenumberedKept> renumbered_{};  ///< used by the thread only
  std::size_t renumbered_next_ = 0;
  std::uint32_t next_sequence_ = 0;
  std::atomic<std::int64_t> refused_ = 0;
  std::atomic<std::int64_t> relayed_ = 0;
  std::thread thread_;
};

}  // namespace vantage::bus::udpm

#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <lcm/lcm.h>

#include "bus/transport/transport.hpp"

namespace vantage::test {

using Bytes = std::vector<std::uint8_t>;

inline const std::string kUrl = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
/// Time after which the transport counts as broken; a working transport needs much less.
inline constexpr std::chrono::seconds kPatience{10};

inline Bytes random_bytes(std::size_t size, unsigned seed) {
  std::mt19937 rng(seed);
  Bytes bytes(size);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(rng());
  }
  return bytes;
}

/// True if the kernel grants the receive buffer of kUrl (net.core.rmem_max is 4 MiB or more). With
/// a smaller buffer the kernel may lose bursts and large messages, so tests of them are skipped.
inline bool has_large_buffers() {
  return bus::open_transport(kUrl)->stats().receive_buffer_short_bytes == 0;
}
inline constexpr const char* kNeedsLargeBuffers = "needs sysctl net.core.rmem_max >= 4194304";

/// Handles messages until `is_done` returns true, or until none has arrived for kPatience.
inline void handle_until(bus::Transport& transport, const std::function<bool()>& is_done) {
  while (!is_done() && transport.handle(kPatience) > 0) {
  }
}

/// The udpm transport of liblcm, with a queue long enough for a burst.
class Liblcm {
 public:
  explicit Liblcm(const std::string& expression) : lcm_(lcm_create(kUrl.c_str())) {
    lcm_subscription_t* subscription =
        lcm_subscribe(lcm_.get(), expression.c_str(), &Liblcm::on_message, this);
    lcm_subscription_set_queue_capacity(subscription, 100'000);
  }
  bool publish(const std::string& channel, const Bytes& bytes) {
    return lcm_publish(lcm_.get(), channel.c_str(), bytes.data(),
                       static_cast<unsigned>(bytes.size())) == 0;
  }
  /// Handles messages until `count` were received in total, or until none has arrived for
  /// kPatience.
  void handle_until(std::size_t count) {
    constexpr int kPatienceMs = 10'000;
    while (heard_.size() < count && lcm_handle_timeout(lcm_.get(), kPatienceMs) > 0) {
    }
  }
  [[nodiscard]] const std::vector<std::pair<std::string, Bytes>>& heard() const { return heard_; }

 private:
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
    static_cast<Liblcm*>(self)->heard_.emplace_back(channel,
                                                    Bytes(bytes, bytes + buffer->data_size));
  }
  struct Close {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  std::unique_ptr<lcm_t, Close> lcm_;
  std::vector<std::pair<std::string, Bytes>> heard_;
};

/// Appends the messages that `transport` receives on `channel`.
inline void collect(bus::Transport& transport, const std::string& channel,
                    std::vector<std::pair<std::string, Bytes>>& heard) {
  transport.subscribe(channel,
                      [&heard](std::string_view name, std::span<const std::uint8_t> bytes) {
                        heard.emplace_back(name, Bytes(bytes.begin(), bytes.end()));
                      });
}

}  // namespace vantage::test

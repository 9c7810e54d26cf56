#pragma once

#include <deque>
#include <exception>
#include <memory>
#include <string>

#include <lcm/lcm.h>

#include "bus/transport/transport.hpp"

namespace vantage::bus {

/// Transport by liblcm's providers memq:// and file://, which have no receive thread exposed to the
/// network.
///
/// Names of subscriptions may only contain letters, digits and "_:/-", because liblcm interprets
/// them as regular expressions. "PREFIX*" becomes "PREFIX.*".
class LcmTransport : public Transport {
 public:
  /// @throws StartupError when liblcm cannot open `url`.
  explicit LcmTransport(const std::string& url);
  ~LcmTransport() override;
  LcmTransport(const LcmTransport&) = delete;
  LcmTransport& operator=(const LcmTransport&) = delete;
  LcmTransport(LcmTransport&&) = delete;
  LcmTransport& operator=(LcmTransport&&) = delete;

  /// @throws UsageError for a name that liblcm would interpret differently.
  void subscribe(const std::string& channel, Handler handler) override;
  void unsubscribe(const std::string& channel) override;
  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override;
  int handle(std::chrono::microseconds timeout) override;
  [[nodiscard]] TransportStats stats() const override { return stats_; }

 private:
  struct Subscription {
    LcmTransport* transport;
    std::string channel;
    Handler handler;
    lcm_subscription_t* lcm = nullptr;  ///< null after unsubscribe()
  };
  static void on_message(const lcm_recv_buf_t* buffer, const char* channel, void* subscription);

  struct Close {
    void operator()(lcm_t* lcm) const { lcm_destroy(lcm); }
  };
  std::unique_ptr<lcm_t, Close> lcm_;
  std::deque<Subscription> subscriptions_;  ///< liblcm stores pointers to the elements
  std::exception_ptr pending_;
  bool has_ended_ = false;
  bool is_handling_ = false;
  TransportStats stats_;
};

}  // namespace vantage::bus

#include "bus/transport/lcm_transport.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/check.hpp"

namespace vantage::bus {
namespace {

constexpr int kMessagesPerHandle = 4096;

/// Returns the regular expression that liblcm expects for `channel`; liblcm adds ^ and $ itself.
std::string expression_of(const std::string& channel) {
  const bool is_prefix = !channel.empty() && channel.back() == '*';
  const std::string stem = is_prefix ? channel.substr(0, channel.size() - 1) : channel;
  const bool is_plain = std::all_of(stem.begin(), stem.end(), [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' ||
           c == ':' || c == '/' || c == '-';
  });
  require(is_plain && !channel.empty(),
          "channel '" + channel + "' must consist of [A-Za-z0-9_:/-]");
  return is_prefix ? stem + ".*" : stem;
}

}  // namespace

LcmTransport::LcmTransport(const std::string& url) : lcm_(lcm_create(url.c_str())) {
  if (lcm_ == nullptr) {
    throw StartupError("LCM cannot open '" + url + "'");
  }
}

LcmTransport::~LcmTransport() = default;

void LcmTransport::subscribe(const std::string& channel, Handler handler) {
  const std::string expression = expression_of(channel);
  Subscription& own = subscriptions_.emplace_back(Subscription{this, channel, std::move(handler)});
  own.lcm = lcm_subscribe(lcm_.get(), expression.c_str(), &LcmTransport::on_message, &own);
}

// The entry remains in the deque: liblcm may hold a pointer to it until its handle() returns.
void LcmTransport::unsubscribe(const std::string& channel) {
  for (Subscription& each : subscriptions_) {
    if (each.lcm != nullptr && each.channel == channel) {
      lcm_unsubscribe(lcm_.get(), std::exchange(each.lcm, nullptr));
    }
  }
}

bool LcmTransport::publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  const bool is_sent = bytes.size() <= std::numeric_limits<std::int32_t>::max() &&
                       lcm_publish(lcm_.get(), channel.c_str(), bytes.data(),
                                   static_cast<unsigned>(bytes.size())) == 0;
  ++(is_sent ? stats_.messages_sent : stats_.send_errors);
  return is_sent;
}

// C code calls this function. An exception cannot propagate through C code, so the exception is
// stored and rethrown after the C code has returned.
void LcmTransport::on_message(const lcm_recv_buf_t* buffer, const char* channel,
                              void* subscription) {
  auto& self = *static_cast<Subscription*>(subscription);
  try {
    ++self.transport->stats_.messages_received;
    self.handler(channel, std::span(static_cast<const std::uint8_t*>(buffer->data),
                                    std::size_t{buffer->data_size}));
  } catch (...) {
    if (!self.transport->pending_) {
      self.transport->pending_ = std::current_exception();
    }
  }
}

int LcmTransport::handle(std::chrono::microseconds timeout) {
  require(!is_handling_, "Transport::handle() called from a handler");
  if (has_ended_) {
    return kSourceEnded;
  }
  // The wait is rounded up, so that a wait of less than 1 ms does not become a busy loop.
  auto wait = std::chrono::ceil<std::chrono::milliseconds>(std::max(timeout, {}));
  int handled = 0;
  is_handling_ = true;
  while (handled < kMessagesPerHandle && !pending_) {
    const int status = lcm_handle_timeout(lcm_.get(), static_cast<int>(wait.count()));
    if (status <= 0) {
      has_ended_ = status < 0;
      break;
    }
    ++handled;
    wait = {};
  }
  is_handling_ = false;
  if (pending_) {
    std::rethrow_exception(std::exchange(pending_, nullptr));
  }
  return has_ended_ && handled == 0 ? kSourceEnded : handled;
}

}  // namespace vantage::bus

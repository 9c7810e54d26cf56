#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>
#include <vector>

#include "bus/transport/channel_index.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"

namespace vantage::bus {
namespace {

struct Posted {
  std::string channel;
  std::vector<std::uint8_t> bytes;
  mutable Decoded decoded;
};

}  // namespace

struct InProcessHub::State {
  class Endpoint;

  std::size_t queue_capacity = 0;
  /// Locked during a complete publish, so that all endpoints receive all messages in the same
  /// order. Always locked before an endpoint's own mutex.
  std::mutex mutex;
  /// Subscribed endpoints, by channel name and by pattern. Each list contains an endpoint at most
  /// once.
  ByName<std::vector<Endpoint*>> listeners;
  std::vector<Endpoint*> pattern_listeners;
  HubNetwork* network = nullptr;
};

class InProcessHub::State::Endpoint : public Transport {
 public:
  Endpoint(State& hub, std::function<void()> on_arrival, std::string host)
      : hub_(hub), on_arrival_(std::move(on_arrival)), host_(std::move(host)) {}

  ~Endpoint() override {
    const std::lock_guard lock(hub_.mutex);
    std::erase(hub_.pattern_listeners, this);
    for (const Subscription& each : subscriptions_) {
      if (const auto found = hub_.listeners.find(each.pattern); found != hub_.listeners.end()) {
        std::erase(found->second, this);
      }
    }
  }
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;
  Endpoint(Endpoint&&) = delete;
  Endpoint& operator=(Endpoint&&) = delete;

  void subscribe(const std::string& channel, Handler handler) override {
    const std::lock_guard hub_lock(hub_.mutex);
    const std::lock_guard lock(mutex_);
    const bool is_pattern = channel.ends_with('*');
    std::vector<Endpoint*>& all = is_pattern ? hub_.pattern_listeners : hub_.listeners[channel];
    if (is_pattern ? patterns_.empty() : !index_.contains(channel)) {
      all.push_back(this);
    }
    if (is_pattern) {
      patterns_.push_back(channel);
    }
    const std::size_t number = index_.add(channel);
    if (number == subscriptions_.size()) {
      subscriptions_.emplace_back();
    }
    subscriptions_[number] = {channel, std::move(handler)};
  }

  void unsubscribe(const std::string& channel) override {
    const std::lock_guard hub_lock(hub_.mutex);
    const std::lock_guard lock(mutex_);
    for (const std::size_t number : index_.remove(channel)) {
      subscriptions_[number] = {};
    }
    if (std::erase(patterns_, channel) > 0) {
      if (patterns_.empty()) {
        std::erase(hub_.pattern_listeners, this);
      }
    } else if (const auto found = hub_.listeners.find(channel); found != hub_.listeners.end()) {
      std::erase(found->second, this);
    }
  }

  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    return post(channel, bytes, Reach::kAll);
  }
  bool publish_on_host(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    return post(channel, bytes, Reach::kHost);
  }

  bool post(const std::string& channel, std::span<const std::uint8_t> bytes, Reach reach) {
    auto posting = std::make_shared<Posted>();
    posting->channel = channel;
    posting->bytes.assign(bytes.begin(), bytes.end());
    const std::shared_ptr<const Posted> posted = std::move(posting);
    const std::lock_guard lock(hub_.mutex);
    if (hub_.network != nullptr) {
      hub_.network->send(channel, bytes.size(), reach);
    }
    if (const auto found = hub_.listeners.find(channel); found != hub_.listeners.end()) {
      for (Endpoint* endpoint : found->second) {
        endpoint->accept(posted);
      }
    }
    for (Endpoint* endpoint : hub_.pattern_listeners) {
      if (endpoint->matches_by_pattern_only(channel)) {
        endpoint->accept(posted);
      }
    }
    const std::lock_guard own_lock(mutex_);
    ++stats_.messages_sent;
    return true;
  }

  // Messages published by handlers are delivered at the next handle(). Otherwise this call might
  // never return when two nodes answer each other.
  int handle(std::chrono::microseconds timeout) override {
    std::size_t batch = 0;
    {
      std::unique_lock lock(mutex_);
      // Does not wait with a zero timeout: even a wait of zero sleeps for the kernel's timer slack,
      // and virtual time calls this function thousands of times per second.
      if (queue_.empty() && timeout.count() > 0) {
        arrived_.wait_for(lock, timeout, [&] { return !queue_.empty(); });
      }
      batch = queue_.size();
    }
    int handled = 0;
    for (; batch > 0; --batch) {
      const std::shared_ptr<const Posted> posted = take();
      if (posted == nullptr) {
        break;
      }
      ++handled;
      dispatch(*posted);
    }
    return handled;
  }

  [[nodiscard]] TransportStats stats() const override {
    const std::lock_guard lock(mutex_);
    return stats_;
  }

 private:
  struct Subscription {
    std::string pattern;
    Handler handler;
  };

  [[nodiscard]] bool matches_by_pattern_only(const std::string& channel) const {
    const std::lock_guard lock(mutex_);
    return !index_.contains(channel) &&
           std::any_of(patterns_.begin(), patterns_.end(), [&](const std::string& pattern) {
             return channel_matches(pattern, channel);
           });
  }

  void accept(const std::shared_ptr<const Posted>& posted) {
    if (hub_.network == nullptr || host_.empty() || hub_.network->arrives_at(host_)) {
      enqueue(posted);
    }
  }

  void enqueue(const std::shared_ptr<const Posted>& posted) {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= hub_.queue_capacity) {
      queue_.pop_front();
      ++stats_.queue_overflows;
    }
    queue_.push_back(posted);
    arrived_.notify_one();
    if (on_arrival_) {
      on_arrival_();
    }
  }

  std::shared_ptr<const Posted> take() {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) {
      return nullptr;
    }
    std::shared_ptr<const Posted> posted = std::move(queue_.front());
    queue_.pop_front();
    ++stats_.messages_received;
    return posted;
  }

  // Handlers run without the lock and may subscribe and publish. This is safe, because only the
  // owner's thread adds subscriptions, and a deque does not move its elements.
  void dispatch(const Posted& posted) {
    for (auto i = index_.next(posted.channel, 0); i; i = index_.next(posted.channel, *i + 1)) {
      subscriptions_[*i].handler(posted.channel, Payload(posted.bytes, &posted.decoded));
    }
  }

  State& hub_;
  std::function<void()> on_arrival_;
  std::string host_;
  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Subscription> subscriptions_;
  ChannelIndex index_;  ///< indexes subscriptions_
  std::vector<std::string> patterns_;
  std::deque<std::shared_ptr<const Posted>> queue_;
  TransportStats stats_;
};

InProcessHub::InProcessHub(std::size_t queue_capacity) : state_(std::make_unique<State>()) {
  require(queue_capacity > 0, "queue_capacity must be at least 1");
  state_->queue_capacity = queue_capacity;
}

InProcessHub::~InProcessHub() = default;

std::unique_ptr<Transport> InProcessHub::connect(std::function<void()> on_arrival,
                                                 std::string host) {
  return std::make_unique<State::Endpoint>(*state_, std::move(on_arrival), std::move(host));
}

void InProcessHub::use_network(HubNetwork* network) {
  const std::lock_guard lock(state_->mutex);
  state_->network = network;
}

}  // namespace vantage::bus

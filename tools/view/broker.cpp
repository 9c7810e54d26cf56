#include "tools/view/broker.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace vantage::tools {
namespace {

constexpr std::size_t kSubscriptionsMax = 10'000;  // maximum number of subscriptions per viewer
constexpr std::size_t kControlsMax = 1000;         // maximum number of waiting playback requests
/// Subscription id of time frames in the Outbox; viewers must not use it.
constexpr std::uint32_t kNoSubscription = 0xFFFFFFFFU;

Frame control(std::string text) {
  return {Frame::Kind::kControl, true, 0, std::move(text), nullptr};
}

}  // namespace

void Client::push(Frame frame) {
  {
    const std::lock_guard lock(mutex_);
    if (is_closed_) {
      return;
    }
    outbox_.push(std::move(frame));
    is_closed_ = outbox_.is_overflowing();
  }
  changed_.notify_one();
}

std::optional<Frame> Client::wait_pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_closed_ || !outbox_.empty(); });
  return is_closed_ ? std::nullopt : outbox_.pop();
}

void Client::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  changed_.notify_one();
}

bool Client::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

std::int64_t Client::dropped() const {
  const std::lock_guard lock(mutex_);
  return outbox_.dropped();
}

Broker::Broker(ServerInfo info) : info_(std::move(info)) {}

bool Broker::is_kept(const Topic& topic) const {
  using logs::foxglove::Schema;
  if (topic.is_state || !info_.range) {
    return topic.is_state;
  }
  return topic.channel.schema == Schema::kLcm ? topic.subscribers > 0
                                              : topic.channel.schema != Schema::kLog;
}

bool Broker::wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = topics_.try_emplace(topic);
  Topic& known = entry->second;
  if (is_new) {
    topic_of_.push_back(topic);
    known.channel = {static_cast<std::uint32_t>(topic_of_.size()), topic, schema};
    known.is_state = is_state;
    for (const auto& client : clients_) {
      client->push(control(advertise_text({&known.channel, 1})));
    }
  }
  ++known.count;
  return is_kept(known) || (known.subscribers > 0 && !is_holding_);
}

void Broker::write(const std::string& topic, Time time, const logs::foxglove::Json& content) {
  auto body = std::make_shared<const std::string>(
      content.dump(-1, ' ', false, logs::foxglove::Json::error_handler_t::replace));
  const std::lock_guard lock(mutex_);
  Topic& known = topics_.at(topic);
  known.time = time;
  known.newest = std::move(body);
  if (!is_holding_ && known.subscribers > 0) {
    for (const auto& client : clients_) {
      const auto ids = client->subscriptions_.find(known.channel.id);
      if (ids != client->subscriptions_.end()) {
        for (const std::uint32_t id : ids->second) {
          send(*client, id, known);
        }
      }
    }
  }
  if (!is_kept(known)) {
    known.newest.reset();
  }
}

void Broker::name_type(const std::string& topic, const std::string& type) {
  const std::lock_guard lock(mutex_);
  topics_.at(topic).type = type;
}

void Broker::send(Client& client, std::uint32_t subscription_id, const Topic& topic) {
  client.push({topic.is_state ? Frame::Kind::kState : Frame::Kind::kFlow, false, subscription_id,
               message_head(subscription_id, topic.time), topic.newest});
  report_drops(client);
}

void Broker::report_drops(Client& client) {
  const std::int64_t dropped = client.dropped();
  if (dropped > 2 * client.drops_reported_) {
    client.drops_reported_ = dropped;
    client.push(control(status_text(
        StatusLevel::kWarning,
        fmt::format("too slow: {} records were dropped for this viewer", dropped), "drops")));
  }
}

void Broker::hold() {
  const std::lock_guard lock(mutex_);
  is_holding_ = true;
}

void Broker::release() {
  const std::lock_guard lock(mutex_);
  is_holding_ = false;
  for (const auto& client : clients_) {
    for (const auto& [channel, ids] : client->subscriptions_) {
      const Topic& topic = topics_.at(topic_of_.at(channel - 1));
      for (const std::uint32_t id : ids) {
        if (topic.newest) {
          send(*client, id, topic);
        }
      }
    }
  }
}

void Broker::forget() {
  const std::lock_guard lock(mutex_);
  for (auto& [name, topic] : topics_) {
    topic.newest.reset();
  }
  time_.reset();
  ++jumps_;
}

void Broker::reached(Time time) {
  const std::lock_guard lock(mutex_);
  time_ = time;
}

void Broker::broadcast_time(Time time) {
  const std::lock_guard lock(mutex_);
  if (playback_) {
    playback_->time = time;
  }
  for (const auto& client : clients_) {
    client->push({Frame::Kind::kState, false, kNoSubscription, time_frame(time), nullptr});
  }
}

void Broker::broadcast_playback(const PlaybackState& state) {
  const std::lock_guard lock(mutex_);
  playback_ = state;
  playback_->did_seek = false;
  playback_->request_id.clear();
  for (const auto& client : clients_) {
    if (client->speaks_sdk_) {
      client->push({Frame::Kind::kControl, false, 0, playback_state_frame(state), nullptr});
    }
  }
}

void Broker::set_status(const std::string& id, const std::string& message) {
  const std::lock_guard lock(mutex_);
  if (message.empty()) {
    statuses_.erase(id);
  } else {
    statuses_[id] = message;
  }
  for (const auto& client : clients_) {
    client->push(control(message.empty() ? remove_status_text(id)
                                         : status_text(StatusLevel::kInfo, message, id)));
  }
}

void Broker::set_range(Time start, Time end) {
  const std::lock_guard lock(mutex_);
  const std::pair range(start, end);
  if (info_.range == range) {
    return;
  }
  info_.range = range;
  info_.session_id += "+";
  for (const auto& client : clients_) {
    send_channels(*client);
  }
}

// Sends the server info and all channels.
void Broker::send_channels(Client& client) const {
  client.push(control(server_info_text(info_, client.speaks_sdk_)));
  std::vector<ChannelInfo> channels;
  for (const std::string& topic : topic_of_) {
    channels.push_back(topics_.at(topic).channel);
  }
  client.push(control(advertise_text(channels)));
}

std::shared_ptr<Client> Broker::connect(bool speaks_sdk) {
  auto client = std::make_shared<Client>(Outbox(), speaks_sdk);
  const std::lock_guard lock(mutex_);
  send_channels(*client);
  for (const auto& [id, message] : statuses_) {
    client->push(control(status_text(StatusLevel::kInfo, message, id)));
  }
  if (playback_) {
    client->push(
        {Frame::Kind::kState, false, kNoSubscription, time_frame(playback_->time), nullptr});
    if (speaks_sdk) {
      client->push({Frame::Kind::kControl, false, 0, playback_state_frame(*playback_), nullptr});
    }
  }
  clients_.push_back(client);
  return client;
}

void Broker::disconnect(const std::shared_ptr<Client>& client) {
  client->close();
  const std::lock_guard lock(mutex_);
  for (const auto& [channel, ids] : client->subscriptions_) {
    topics_.at(topic_of_.at(channel - 1)).subscribers -= static_cast<int>(ids.size());
  }
  client->subscriptions_.clear();
  dropped_by_disconnected_ += client->dropped();
  std::erase(clients_, client);
}

void Broker::on_request(Client& client, const Request& request) {
  const std::lock_guard lock(mutex_);
  if (const auto* wanted = std::get_if<Subscribe>(&request)) {
    for (const auto& [id, channel] : wanted->pairs) {
      subscribe(client, id, channel);
    }
  } else if (const auto* unwanted = std::get_if<Unsubscribe>(&request)) {
    for (const std::uint32_t id : unwanted->ids) {
      unsubscribe(client, id);
    }
  } else if (const auto* playback = std::get_if<PlaybackControl>(&request)) {
    if (info_.range && controls_.size() < kControlsMax) {
      controls_.push_back(*playback);
    }
  } else if (const auto* declined = std::get_if<Declined>(&request)) {
    client.push(control(status_text(StatusLevel::kWarning,
                                    "not supported by this read-only server: " + declined->what,
                                    "declined:" + declined->what)));
  } else {
    ++malformed_;
    client.push(
        control(status_text(StatusLevel::kError, std::get<Malformed>(request).why, "malformed")));
  }
}

void Broker::subscribe(Client& client, std::uint32_t subscription_id, std::uint32_t channel_id) {
  std::size_t total = 0;
  bool is_taken = subscription_id == kNoSubscription;
  for (const auto& [channel, ids] : client.subscriptions_) {
    total += ids.size();
    is_taken = is_taken || std::find(ids.begin(), ids.end(), subscription_id) != ids.end();
  }
  if (channel_id == 0 || channel_id > topic_of_.size() || is_taken || total >= kSubscriptionsMax) {
    client.push(control(status_text(StatusLevel::kError,
                                    fmt::format("subscription {} to channel {} rejected: unknown "
                                                "channel, id in use, or too many subscriptions",
                                                subscription_id, channel_id),
                                    "subscribe")));
    return;
  }
  Topic& topic = topics_.at(topic_of_.at(channel_id - 1));
  client.subscriptions_[channel_id].push_back(subscription_id);
  ++topic.subscribers;
  if (topic.newest &&
      !is_holding_) {  // between hold() and release() the record precedes the seek position
    send(client, subscription_id, topic);
  }
}

void Broker::unsubscribe(Client& client, std::uint32_t subscription_id) {
  for (auto& [channel, ids] : client.subscriptions_) {
    topics_.at(topic_of_.at(channel - 1)).subscribers -=
        static_cast<int>(std::erase(ids, subscription_id));
  }
  std::erase_if(client.subscriptions_, [](const auto& each) { return each.second.empty(); });
}

std::vector<PlaybackControl> Broker::take_controls() {
  const std::lock_guard lock(mutex_);
  return std::exchange(controls_, {});
}

std::string Broker::topics_text() const {
  logs::foxglove::Json list = logs::foxglove::Json::array();
  const std::lock_guard lock(mutex_);
  for (const auto& [name, topic] : topics_) {
    logs::foxglove::Json entry{{"topic", name},
                               {"schema", logs::foxglove::name_of(topic.channel.schema)},
                               {"count", topic.count}};
    if (!topic.type.empty()) {
      entry["type"] = topic.type;
    }
    list.push_back(std::move(entry));
  }
  logs::foxglove::Json out{{"topics", std::move(list)}, {"jumps", jumps_}, {"time_s", nullptr}};
  if (time_) {
    out["time_s"] = to_seconds(time_->time_since_epoch());
  }
  return out.dump(-1, ' ', false, logs::foxglove::Json::error_handler_t::replace);
}

std::size_t Broker::clients() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

std::int64_t Broker::dropped() const {
  const std::lock_guard lock(mutex_);
  std::int64_t sum = dropped_by_disconnected_;
  for (const auto& client : clients_) {
    sum += client->dropped();
  }
  return sum;
}

std::int64_t Broker::malformed() const {
  const std::lock_guard lock(mutex_);
  return malformed_;
}

}  // namespace vantage::tools

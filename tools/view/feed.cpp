#include "tools/view/feed.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "logs/json/wire_json.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kRawChannelsMax = 2000;

}  // namespace

logs::foxglove::Json raw_message(std::span<const std::uint8_t> data) {
  constexpr std::size_t kFingerprintBytes = 8;
  if (const auto known = logs::message_json(data)) {
    return logs::foxglove::Json(*known);
  }
  std::string fingerprint;
  for (const std::uint8_t byte : data.first(std::min(data.size(), kFingerprintBytes))) {
    fingerprint += fmt::format("{:02x}", byte);
  }
  return {{"foreign_type", "0x" + fingerprint}, {"bytes", data.size()}};
}

template <class Message>
void Feed::listen(const bus::Channel<Message>& channel) {
  bus_.subscribe<Message>(channel,
                          [this](const Message& message) { stream_.on(message, clock_.now()); });
}

Feed::Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink)
    : clock_(clock), sink_(sink), stream_(sink), bus_(transport, bus::random_run_id()) {
  transport.subscribe("*", [this](std::string_view channel, std::span<const std::uint8_t> data) {
    // Whoever is on the network may make up names: no more topics than a lab has channels.
    if (!raw_channels_.contains(channel)) {
      if (raw_channels_.size() >= kRawChannelsMax) {
        return;
      }
      raw_channels_.emplace(channel);
    }
    const std::string topic = std::string(kRawTopics) + std::string(channel);
    if (sink_.wants(topic, logs::foxglove::Schema::kLcm, false)) {
      sink_.write(topic, clock_.now(), raw_message(data));
    }
  });
  listen(bus::kScenario);
  listen(bus::kVicon);
  listen(bus::kTruth);
  listen(bus::measurement_channel("*"));
  listen(bus::belief_channel("*"));
  listen(bus::map_channel("*"));
  listen(bus::plan_channel("*"));
  listen(bus::team_proposal_channel("*"));
  listen(bus::quadrotor_channel("*"));
  listen(bus::health_channel("*"));
  listen(bus::host_channel("*"));
  listen(bus::kCollision);
  listen(bus::kAttack);
  listen(bus::kCommand);
}

}  // namespace vantage::tools

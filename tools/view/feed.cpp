#include "tools/view/feed.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "bus/node/publisher_watch.hpp"
#include "logs/file/wire_check.hpp"
#include "logs/json/wire_json.hpp"

namespace vantage::tools {
namespace {

constexpr std::size_t kRawChannelsMax = 2000;

constexpr std::size_t kFingerprintBytes = 8;

std::string fingerprint_text(std::span<const std::uint8_t> data) {
  std::string text = "0x";
  for (const std::uint8_t byte : data.first(std::min(data.size(), kFingerprintBytes))) {
    text += fmt::format("{:02x}", byte);
  }
  return text;
}

}  // namespace

logs::foxglove::Json raw_message(std::span<const std::uint8_t> data,
                                 const logs::TypeLibrary& types) {
  const bus::WireSchema* type = types.find(data);
  if (type == nullptr) {
    return {{"foreign_type", fingerprint_text(data)}, {"bytes", data.size()}};
  }
  if (const auto known = logs::message_json(data, *type)) {
    return logs::foxglove::Json(*known);
  }
  return {{"damaged", type->name}, {"bytes", data.size()}};
}

template <class Message>
void Feed::listen(const bus::Channel<Message>& channel) {
  bus_.subscribe<Message>(channel,
                          [this](const Message& message) { stream_.on(message, clock_.now()); });
}

void Feed::pass_on(std::string_view channel, std::span<const std::uint8_t> data) {
  if (logs::type_of(data) != nullptr) {
    stream_.on_publisher(channel, bus::run_id_of(data), clock_.now());
  }
  // Any host on the network can invent channel names, so their number is bounded.
  const bool is_new = !raw_channels_.contains(channel);
  if (is_new) {
    if (raw_channels_.size() >= kRawChannelsMax) {
      return;
    }
    raw_channels_.emplace(channel);
  }
  const std::string topic = std::string(kRawTopics) + std::string(channel);
  const bool is_wanted = sink_.wants(topic, logs::foxglove::Schema::kLcm, false);
  if (is_new) {
    const bus::WireSchema* type = types_.find(data);
    sink_.name_type(topic, type == nullptr ? fingerprint_text(data) : std::string(type->name));
  }
  if (is_wanted) {
    sink_.write(topic, clock_.now(), raw_message(data, types_));
  }
}

Feed::Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink,
           const logs::TypeLibrary& types)
    : clock_(clock),
      sink_(sink),
      types_(types),
      stream_(sink),
      bus_(transport, bus::random_run_id()) {
  transport.subscribe("*", [this](std::string_view channel, std::span<const std::uint8_t> data) {
    pass_on(channel, data);
  });
  listen(bus::kScenario);
  listen(bus::kVicon);
  listen(bus::kTruth);
  listen(bus::measurement_channel("*"));
  listen(bus::belief_channel("*"));
  listen(bus::map_channel("*"));
  listen(bus::plan_channel("*"));
  listen(bus::team_proposal_channel("*"));
  listen(bus::vehicle_channel("*"));
  listen(bus::health_channel("*"));
  listen(bus::host_channel("*"));
  listen(bus::kCollision);
  listen(bus::kAttack);
  listen(bus::kCommand);
}

}  // namespace vantage::tools

#include "trial/observe/network_conflicts.hpp"

#include <algorithm>
#include <memory>
#include <string_view>

#include "bus/convert/channels.hpp"
#include "bus/node/command_claim.hpp"
#include "core/deadline.hpp"
#include "core/utf8.hpp"

namespace vantage::trial {
namespace {

constexpr std::chrono::milliseconds kStep{50};
constexpr std::size_t kChannelsMax = 10'000;

/// Returns the part of the channel name after `prefix`; empty if it does not begin with `prefix`.
std::string after(const std::string& prefix, const std::string& channel) {
  return channel.starts_with(prefix) ? channel.substr(prefix.size()) : "";
}

std::string host_in(const std::string& channel) {
  return after(bus::host_channel("").name, channel);
}
std::string vehicle_in(const std::string& channel) {
  return after(bus::vehicle_channel("").name, channel);
}

}  // namespace

ActiveChannels find_active_channels(bus::Transport& transport, Duration duration,
                                    const std::function<bool()>& stop,
                                    bus::auth::Authenticator* authenticator,
                                    const bus::Clock& clock) {
  const auto active = std::make_shared<ActiveChannels>();
  transport.subscribe("*", [=, &clock](std::string_view channel, const bus::Payload& bytes) {
    const bool is_accepted =
        authenticator == nullptr ||
        authenticator
            ->judge(channel, bytes, clock.now(), bus::claim_of(channel, bytes, ""), bytes.source)
            .may_pass;
    std::set<std::string>& names = is_accepted ? active->accepted : active->unverified;
    if (names.size() < kChannelsMax) {
      names.insert(std::string(channel));
    }
  });
  const std::int64_t end_ns = monotonic_ns() + duration.count() * 1'000;
  while (!stop() && monotonic_ns() < end_ns && transport.handle(kStep) != bus::kSourceEnded) {
  }
  return *active;
}

std::set<std::string> find_active_channels(bus::Transport& transport, Duration duration,
                                           const std::function<bool()>& stop) {
  const bus::SteadyClock clock;
  return find_active_channels(transport, duration, stop, nullptr, clock).accepted;
}

std::vector<std::string> conflicts_with_up(const scenario::Scenario& scenario,
                                           const std::string& host,
                                           const std::set<std::string>& channels) {
  const auto runs = [&](const std::string& part) {
    return host.empty() || scenario.runs_on(host, part);
  };
  const auto is_of_trial = [&](const std::string& name) {
    return !host.empty() && std::any_of(scenario.hosts.begin(), scenario.hosts.end(),
                                        [&](const auto& each) { return each.name == name; });
  };
  std::vector<std::string> out;
  for (const std::string& channel : channels) {
    const std::string other = host_in(channel);
    const std::string vehicle = vehicle_in(channel);
    const scenario::RobotSpec* const robot = scenario.find_robot(vehicle);
    const bool is_ours = robot != nullptr && robot->device != scenario::DeviceSource::kDirect;
    if (!other.empty() && (other == host || !is_of_trial(other))) {
      out.push_back("another `vantage up` runs on this network, as host " + readable(other));
    } else if (channel == bus::kTruth.name && runs(scenario::kSimPart)) {
      out.emplace_back("a simulator runs on this network (TRUTH is published)");
    } else if (!vehicle.empty() &&
               (robot == nullptr || host.empty() || (is_ours && runs(vehicle)))) {
      out.push_back("vehicle " + readable(vehicle) + " is alive on this network (" +
                    readable(channel) + " is published)");
    }
  }
  return out;
}

std::vector<std::string> conflicts_with_play(const std::set<std::string>& channels) {
  std::vector<std::string> out;
  for (const std::string& channel : channels) {
    if (!vehicle_in(channel).empty()) {
      out.push_back("vehicle " + readable(vehicle_in(channel)) + " is alive on this network");
    } else if (!host_in(channel).empty()) {
      out.push_back("`vantage up` runs on this network, as host " + readable(host_in(channel)));
    } else if (channel == bus::kTruth.name) {
      out.emplace_back("a simulator runs on this network");
    }
  }
  return out;
}

}  // namespace vantage::trial

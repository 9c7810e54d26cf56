#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/address.hpp"
#include "scenario/reader/scenario_agents_yaml.hpp"
#include "scenario/reader/scenario_sections_yaml.hpp"

namespace vantage::scenario {
namespace {

constexpr std::array<int, 3> kBlockBytes{256, 512, 1024};

void read_connection(Mapping& from, MocapSpec& mocap) {
  from.choice("protocol", mocap.protocol, all_mocap_protocols());
  from.text("host", mocap.host);
  from.integer("port", mocap.port, 1, 65535);
  from.choice("mode", mocap.mode,
              {{"push", StreamMode::kPush},
               {"pull", StreamMode::kPull},
               {"prefetch", StreamMode::kPreFetch}});
  from.choice("up_axis", mocap.up_axis,
              {{"as_told", UpAxis::kAsTold}, {"z", UpAxis::kZ}, {"y", UpAxis::kY}});
  from.integer("block_bytes", mocap.block_bytes, kBlockBytes.front(), kBlockBytes.back());
  if (std::find(kBlockBytes.begin(), kBlockBytes.end(), mocap.block_bytes) == kBlockBytes.end()) {
    from.refuse("block_bytes",
                fmt::format("must be one of 256, 512, 1024; is {}", mocap.block_bytes));
  }
}

/// Reads "PROTOCOL://HOST" or "PROTOCOL://HOST:PORT", the address of a real server.
void read_url(const Value& value, MocapSpec& mocap) {
  const std::string url = value.text();
  const std::size_t scheme_end = url.find("://");
  const std::string scheme = url.substr(0, scheme_end);
  const std::string address = url.substr(scheme_end + 3);
  std::vector<std::string_view> names;
  for (const MocapProtocol protocol : all_mocap_protocols()) {
    names.emplace_back(protocol.name());
    if (scheme == protocol.name()) {
      mocap.protocol = protocol;
    }
  }
  if (scheme != mocap.protocol.name()) {
    value.refuse(
        fmt::format("must begin with the protocol, {}; is '{}'", one_of(names), shortened(url)));
  }
  HostAndPort server{address, 0};
  if (address.find(':') != std::string::npos) {
    const Result<HostAndPort> split = split_address(address);
    if (!split.ok()) {
      value.refuse(fmt::format("{}, is '{}'", split.error().message, shortened(url)));
    }
    server = split.value();
  }
  if (server.host.empty() || server.host.find_first_of("/:") != std::string::npos) {
    value.refuse(
        fmt::format("must be {0}://HOST or {0}://HOST:PORT, is '{1}'", scheme, shortened(url)));
  }
  mocap.device = DeviceSource::kReal;
  mocap.host = server.host;
  mocap.port = server.port;
}

void read_section(Mapping& from, MocapSpec& mocap) {
  from.number("rate_hz", mocap.rate_hz, above_to(0.0, 1000.0));
  from.number("position_sigma_m", mocap.position_sigma_m, at_least(0.0));
  from.angle("yaw_sigma", mocap.yaw_sigma_rad, from_to(0.0, 180.0));
  from.number("latency_s", mocap.latency_s, from_to(0.0, 1.0));
  read_device(from, mocap.device);
  read_connection(from, mocap);
  from.integer("stuck_frames", mocap.stuck_frames, 0, 1000);
  from.number("gate_speed_mps", mocap.gate_speed_mps, at_least(0.0));
  from.number("gate_turn_radps", mocap.gate_turn_radps, at_least(0.0));
}

}  // namespace

void read_mocap(Mapping& top, MocapSpec& mocap) {
  const std::optional<Value> value = top.find("mocap");
  if (value && value->node->is_scalar() && value->node->text.find("://") != std::string::npos) {
    read_url(*value, mocap);
    return;
  }
  top.section("mocap", [&](Mapping& from) { read_section(from, mocap); });
}

}  // namespace vantage::scenario

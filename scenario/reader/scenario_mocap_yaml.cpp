#include <algorithm>
#include <array>

#include <fmt/format.h>

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

}  // namespace

void read_mocap(Mapping& from, MocapSpec& mocap) {
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

}  // namespace vantage::scenario

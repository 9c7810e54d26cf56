#include "bus/auth/trailer.hpp"

#include <algorithm>
#include <cassert>

namespace vantage::bus::auth {
namespace {

constexpr std::array<std::uint8_t, 8> kEnd{1, 'v', 'a', 'n', 't', 'a', 'g', 'e'};
static_assert(4 + 8 + 8 + 4 + kEnd.size() == kFootBytes);

std::uint64_t number_at(Bytes bytes, std::size_t offset, std::size_t width) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(offset, width)) {
    value = (value << 8U) | byte;
  }
  return value;
}

bool is_role(std::uint8_t value) { return value >= 1 && value <= kRoles.size(); }
bool is_mode(std::uint8_t value) { return value >= 1 && value <= 4; }

struct Family {
  std::string_view name;  ///< channel name, or a prefix that ends in '_'
  Role role;
  bool must_be_signed;
};

// Channel families. Channels that are not listed are for display only. TRUTH is listed because it
// brings simulated bodies into VICON when the cameras are real. HEALTH_ is listed because the
// supervisor ends silent processes. COLLISION determines the exit code of `vantage up`; HOST_
// determines whether `vantage up` starts.
constexpr std::array kFamilies{
    Family{"VICON", Role::kMocap, true},
    Family{"COMMAND", Role::kOperator, true},
    Family{"PLAN_", Role::kPlanner, true},
    Family{"PROPOSAL_", Role::kPlanner, true},
    Family{"TEAM_PROPOSAL_", Role::kPlanner, true},
    Family{"EXTERNAL_", Role::kPlanner, true},
    Family{"VEHICLE_", Role::kVehicle, true},
    Family{"MEASUREMENT_", Role::kNode, true},
    Family{"ODOMETRY_", Role::kNode, true},
    Family{"POSE_", Role::kNode, true},
    Family{"SIGHTINGS_", Role::kNode, true},
    Family{"SCAN_", Role::kNode, true},
    Family{"BELIEF_", Role::kNode, true},
    Family{"COMPACT_BELIEF_", Role::kNode, true},
    Family{"MIXTURE_", Role::kNode, true},
    Family{"MAP_", Role::kNode, true},
    Family{"ATTACK", Role::kNode, true},
    Family{"HEALTH_", Role::kNode, true},
    Family{"SCENARIO", Role::kNode, true},
    Family{"TRUTH", Role::kNode, true},
    Family{"COLLISION", Role::kNode, true},
    Family{"HOST_", Role::kNode, true},
};

const Family* family_of(std::string_view channel) {
  const auto found = std::find_if(kFamilies.begin(), kFamilies.end(), [&](const Family& family) {
    return family.name.back() == '_' ? channel.starts_with(family.name) : channel == family.name;
  });
  return found == kFamilies.end() ? nullptr : &*found;
}

}  // namespace

const char* name_of(Role role) {
  switch (role) {
    case Role::kMocap:
      return "mocap";
    case Role::kPlanner:
      return "planner";
    case Role::kVehicle:
      return "vehicle";
    case Role::kOperator:
      return "operator";
    case Role::kNode:
      return "node";
  }
  return "unknown";
}

std::optional<std::uint64_t> SignedParts::echo_for(std::uint32_t destination) const {
  for (std::size_t at = 0; at + kEchoBytes <= echoes.size(); at += kEchoBytes) {
    if (number_at(echoes, at, 4) == destination) {
      return number_at(echoes, at + 4, 8);
    }
  }
  return std::nullopt;
}

std::optional<SignedParts> split(Bytes message) {
  if (message.size() < kFootBytes + kMacBytes) {
    return std::nullopt;
  }
  const Bytes foot = message.last(kFootBytes);
  if (!std::equal(kEnd.begin(), kEnd.end(), foot.end() - kEnd.size())) {
    return std::nullopt;
  }
  const std::uint8_t role = foot[20];
  const std::uint8_t mode = foot[21];
  const std::size_t echoes_bytes = foot[22] * kEchoBytes;
  const std::size_t signature_bytes = foot[23] * kSignatureBytes;
  const std::size_t before_payload = echoes_bytes + signature_bytes + kMacBytes + kFootBytes;
  if (!is_role(role) || !is_mode(mode) || foot[22] > kEchoesMax || foot[23] > 1 ||
      message.size() < before_payload) {
    return std::nullopt;
  }
  SignedParts parts;
  parts.payload = message.first(message.size() - before_payload);
  Bytes rest = message.subspan(parts.payload.size());
  parts.echoes = rest.first(echoes_bytes);
  rest = rest.subspan(echoes_bytes);
  parts.signature = rest.first(signature_bytes);
  rest = rest.subspan(signature_bytes);
  parts.mac = rest.first(kMacBytes);
  parts.foot_bytes = foot;
  parts.foot.key_id = static_cast<std::uint32_t>(number_at(foot, 0, 4));
  parts.foot.session = number_at(foot, 4, 8);
  parts.foot.counter = number_at(foot, 12, 8);
  parts.foot.role = static_cast<Role>(role);
  parts.foot.mode = static_cast<scenario::TrialMode>(mode);
  return parts;
}

Bytes payload_of(Bytes message) {
  const auto parts = split(message);
  return parts ? parts->payload : message;
}

void append_number(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out) {
  for (std::size_t i = width; i > 0; --i) {
    out.push_back(static_cast<std::uint8_t>(value >> (8 * (i - 1))));
  }
}

void append_echoes(std::span<const Echo> echoes, std::vector<std::uint8_t>& out) {
  for (const Echo& echo : echoes) {
    append_number(echo.destination, 4, out);
    append_number(echo.nonce, 8, out);
  }
}

std::array<std::uint8_t, kFootBytes> foot_bytes(const Foot& foot, std::size_t echoes,
                                                std::size_t signatures) {
  assert(echoes <= kEchoesMax && signatures <= 1);
  std::array<std::uint8_t, kFootBytes> out{};
  std::size_t at = 0;
  const auto put = [&](std::uint64_t value, std::size_t width) {
    for (std::size_t i = width; i > 0; --i) {
      out[at++] = static_cast<std::uint8_t>(value >> (8 * (i - 1)));
    }
  };
  put(foot.key_id, 4);
  put(foot.session, 8);
  put(foot.counter, 8);
  put(static_cast<std::uint8_t>(foot.role), 1);
  put(static_cast<std::uint8_t>(foot.mode), 1);
  put(echoes, 1);
  put(signatures, 1);
  std::copy(kEnd.begin(), kEnd.end(), out.begin() + static_cast<std::ptrdiff_t>(at));
  return out;
}

Role role_of(std::string_view channel) {
  const Family* family = family_of(channel);
  return family == nullptr ? Role::kNode : family->role;
}

bool must_be_signed(std::string_view channel) {
  const Family* family = family_of(channel);
  return family != nullptr && family->must_be_signed;
}

bool is_fixed_name(std::string_view channel) {
  const Family* family = family_of(channel);
  return family != nullptr && family->name == channel;
}

}  // namespace vantage::bus::auth

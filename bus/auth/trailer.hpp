#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "scenario/security_spec.hpp"

// Encodes and decodes the trailer of a signed message, which follows the payload. No cryptography.
// LCM's tools forward the trailer unchanged, and the decoders of lcm-gen ignore it in every
// language. All numbers are big-endian, as in LCM.
//
//   payload    as lcm-gen encodes it
//   echoes     0 to 64 times: u32 destination, u64 nonce
//   signature  64 bytes, Ed25519, or none
//   MAC        16 bytes, keyed BLAKE2b
//   foot       u32 key id, u64 session, u64 counter, u8 role, u8 mode, u8 number of echoes,
//              u8 number of signatures (0, 1), u8 version (1), "vantage"

namespace vantage::bus::auth {

/// Role of a publisher. Each role has its own keys; role_of() returns the role of a channel.
enum class Role : std::uint8_t {
  kMocap = 1,     ///< VICON
  kPlanner = 2,   ///< PLAN_*, PROPOSAL_*, TEAM_PROPOSAL_*
  kVehicle = 3,   ///< VEHICLE_*
  kOperator = 4,  ///< COMMAND; its messages also have a signature
  kNode = 5,      ///< all other channels
};
inline constexpr std::array kRoles{Role::kMocap, Role::kPlanner, Role::kVehicle, Role::kOperator,
                                   Role::kNode};
/// Returns "mocap", "planner", "vehicle", "operator" or "node".
const char* name_of(Role role);

/// Addressee of a command and the nonce that this vehicle requests.
struct Echo {
  std::uint32_t destination = 0;  ///< destination_of(name of the vehicle)
  std::uint64_t nonce = 0;        ///< session of the vehicle's newest status
  friend bool operator==(const Echo&, const Echo&) = default;
};

struct Foot {
  std::uint32_t key_id = 0;
  std::uint64_t session = 0;  ///< random, new at each process start and at each arming of a vehicle
  std::uint64_t counter = 0;  ///< sender's time, µs since the Unix epoch; made strictly increasing
  Role role = Role::kNode;
  scenario::TrialMode mode = scenario::TrialMode::kLive;
  friend bool operator==(const Foot&, const Foot&) = default;
};

inline constexpr std::size_t kEchoBytes = 12;
inline constexpr std::size_t kEchoesMax = 64;
inline constexpr std::size_t kSignatureBytes = 64;
inline constexpr std::size_t kMacBytes = 16;
inline constexpr std::size_t kFootBytes = 32;

using Bytes = std::span<const std::uint8_t>;

/// Parts of a signed message: views that are valid as long as the message exists.
struct SignedParts {
  Bytes payload;
  Bytes echoes;
  Bytes signature;  ///< empty or 64 bytes
  Bytes mac;
  Bytes foot_bytes;
  Foot foot;

  /// Returns the nonce echoed to `destination`; nullopt if the command is not addressed to
  /// `destination`.
  [[nodiscard]] std::optional<std::uint64_t> echo_for(std::uint32_t destination) const;
};

/// Returns the parts of `message`; nullopt when it does not end in a trailer of this version. Reads
/// nothing outside `message`.
std::optional<SignedParts> split(Bytes message);

/// Returns `message` without its trailer, if any. Used by decoders that check every byte.
Bytes payload_of(Bytes message);

/// Appends the number as `width` bytes, big-endian.
void append_number(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out);
void append_echoes(std::span<const Echo> echoes, std::vector<std::uint8_t>& out);
/// Encodes the foot. Precondition: echoes ≤ kEchoesMax, signatures ≤ 1.
std::array<std::uint8_t, kFootBytes> foot_bytes(const Foot& foot, std::size_t echoes,
                                                std::size_t signatures);

/// Returns the role that signs messages on `channel`.
Role role_of(std::string_view channel);
/// True if an unsigned message on `channel` is refused when signatures are required. These are the
/// channels that move a vehicle, directly or through other processes. Nodes without a key may
/// publish on all other channels.
bool must_be_signed(std::string_view channel);
/// True if `channel` is a known channel with a single name, such as VICON; PLAN_Q1 is not.
bool is_fixed_name(std::string_view channel);

}  // namespace vantage::bus::auth

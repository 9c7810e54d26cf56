#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "scenario/security_spec.hpp"

// What stands behind a signed message's payload, bytes to values and back. Pure; no cryptography.
// LCM's tools carry it unread, and decoders that lcm-gen wrote, of any language, ignore it. All
// numbers are big-endian, as LCM's.
//
//   payload    as lcm-gen encodes it
//   echoes     0 to 64 times: u32 destination, u64 nonce
//   signature  64 bytes, Ed25519, or none
//   MAC        16 bytes, keyed BLAKE2b
//   foot       u32 key id, u64 session, u64 counter, u8 role, u8 mode, u8 number of echoes,
//              u8 number of signatures (0, 1), u8 version (1), "vantage"

namespace vantage::bus::auth {

/// Who may say something. Each role has keys of its own; which one a channel needs: role_of().
enum class Role : std::uint8_t {
  kMocap = 1,     ///< VICON
  kPlanner = 2,   ///< PLAN_*, PROPOSAL_*, TEAM_PROPOSAL_*
  kVehicle = 3,   ///< VEHICLE_*
  kOperator = 4,  ///< COMMAND, which is signed besides
  kNode = 5,      ///< everything else
};
inline constexpr std::array kRoles{Role::kMocap, Role::kPlanner, Role::kVehicle, Role::kOperator,
                                   Role::kNode};
/// "mocap", "planner", "vehicle", "operator", "node".
const char* name_of(Role role);

/// To whom a command is said, and what that vehicle asks to be echoed.
struct Echo {
  std::uint32_t destination = 0;  ///< destination_of() its name
  std::uint64_t nonce = 0;        ///< the session of its newest status
  friend bool operator==(const Echo&, const Echo&) = default;
};

struct Foot {
  std::uint32_t key_id = 0;
  std::uint64_t session = 0;  ///< random, for each start of a process; of a vehicle, at arming too
  std::uint64_t counter = 0;  ///< the sender's time, µs since the Unix epoch, but always rising
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

/// A signed message taken apart; views into it, valid as long as it is.
struct SignedParts {
  Bytes payload;
  Bytes echoes;
  Bytes signature;  ///< empty or 64 bytes
  Bytes mac;
  Bytes foot_bytes;
  Foot foot;

  /// The nonce echoed to `destination`, if it is one of those that are spoken to.
  [[nodiscard]] std::optional<std::uint64_t> echo_for(std::uint32_t destination) const;
};

/// nullopt when `message` ends in no trailer of this version. Reads nothing outside `message`.
std::optional<SignedParts> split(Bytes message);

/// `message` without the trailer, if it has one: what a decoder that looks at every byte is given.
Bytes payload_of(Bytes message);

/// Appends the number as `width` bytes, big-endian.
void append_number(std::uint64_t value, std::size_t width, std::vector<std::uint8_t>& out);
void append_echoes(std::span<const Echo> echoes, std::vector<std::uint8_t>& out);
/// Precondition: echoes ≤ kEchoesMax, signatures ≤ 1.
std::array<std::uint8_t, kFootBytes> foot_bytes(const Foot& foot, std::size_t echoes,
                                                std::size_t signatures);

/// The role whose key signs `channel`.
Role role_of(std::string_view channel);
/// Whether an unsigned message on `channel` is refused where signatures are required: what moves a
/// vehicle, or what those believe that move one. Others stay open to nodes that know no key.
bool must_be_signed(std::string_view channel);
/// Whether `channel` is one of ours that has a single name, such as VICON; PLAN_Q1 is not.
bool is_fixed_name(std::string_view channel);

}  // namespace vantage::bus::auth

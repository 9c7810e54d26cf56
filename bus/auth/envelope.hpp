#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bus/auth/keyring.hpp"
#include "bus/auth/trailer.hpp"
#include "core/time.hpp"
#include "scenario/security_spec.hpp"

// Signs and verifies messages. Pure functions: no clock, no network.
//
//   signature = Ed25519(seed, n ‖ channel ‖ payload ‖ echoes ‖ foot)           (COMMAND only)
//   MAC       = BLAKE2b-128(key, n ‖ channel ‖ payload ‖ echoes ‖ signature ‖ foot)
//
// n is one byte, the length of the channel's name. Key and output length are parameters of BLAKE2b
// (RFC 7693), not a prefix of the data. Every receiver that can verify a MAC could also create one.
// Commands therefore carry a signature as well, so that a captured vehicle cannot command other
// vehicles.

namespace vantage::bus::auth {

/// Appends the trailer that turns the payload in `message` into a signed message on `channel`.
/// Preconditions: key.can_sign(), key.role == foot.role, echoes ≤ kEchoesMax, channel ≤ 255 bytes.
/// Cost: 0.6 µs for 250 bytes, 16 µs more with a signature.
void sign(const Key& key, std::string_view channel, Foot foot, std::span<const Echo> echoes,
          std::vector<std::uint8_t>& message);

/// Reason why a message is refused.
enum class Refusal : std::uint8_t {
  kNone,
  kUnsigned,
  kUnknownKey,
  kWrongRole,         ///< the key's role may not publish on the channel
  kBadMac,            ///< MAC of another key, or message modified in transit
  kBadSignature,      ///< wrong or missing signature of an operator
  kOverBudget,        ///< signature not verified: the rate limit is exceeded
  kWrongMode,         ///< message from another kind of trial, such as a simulation or a replay
  kStale,             ///< the time of sending differs too much from the receiver's time
  kReplayed,          ///< received before, or older than the replay window
  kWrongSession,      ///< the command does not echo the vehicle's nonce
  kWrongDestination,  ///< the command is not addressed to this vehicle
};
inline constexpr std::size_t kRefusals = 12;
/// Returns the name used in counters: "unsigned", "unknown_key", "wrong_role", …
const char* name_of(Refusal refusal);

/// Record of the message counters received in each session, so that no message is accepted twice.
/// The record contains the newest 64 counters of each session. Older counters are refused as
/// replayed; missing counters between the stored counters are accepted. At most 256 sessions are
/// stored; a new session replaces the session that was silent longest.
class ReplayGuard {
 public:
  static constexpr std::size_t kWindow = 64;
  static constexpr std::size_t kSessionsMax = 256;

  /// Records the counter (≥ 1). Returns false if it was received before or is too old. Must only be
  /// called for messages that are verified with the key.
  bool admit(std::uint32_t key_id, std::uint64_t session, std::uint64_t counter);
  /// True if admit() would refuse the counter; changes nothing.
  [[nodiscard]] bool refuses(std::uint32_t key_id, std::uint64_t session,
                             std::uint64_t counter) const;
  [[nodiscard]] bool knows(std::uint32_t key_id, std::uint64_t session) const {
    return find(key_id, session) != nullptr;
  }

 private:
  struct Session {
    std::uint32_t key_id = 0;
    std::uint64_t session = 0;
    std::uint64_t used_last = 0;
    std::uint64_t forgotten = 0;      ///< newest counter that was removed from `seen`; 0: none
    std::vector<std::uint64_t> seen;  ///< stored counters, ascending
  };
  [[nodiscard]] const Session* find(std::uint32_t key_id, std::uint64_t session) const;
  [[nodiscard]] static bool was_received(const Session& session, std::uint64_t counter);

  std::vector<Session> sessions_;
  std::uint64_t uses_ = 0;
};

/// Token bucket for signature checks: limits the rate per second and the burst.
class Budget {
 public:
  Budget(double rate_per_s, double burst) : rate_per_s_(rate_per_s), burst_(burst), left_(burst) {}
  /// Returns true and removes a token if a token is left. `now` must not decrease.
  bool take(Time now);

 private:
  double rate_per_s_;
  double burst_;
  double left_;
  std::optional<Time> last_take_;
};

/// Sender of a message, as far as known before verification.
struct Sender {
  std::uint64_t source = 0;  ///< address and port as in bus::Payload::source
  std::uint64_t session = 0;
};

/// Limits the number of signatures that a process verifies, by sender. Only commands with a valid
/// MAC that are current or echo a current nonce are verified (Expectation::early_refusal). So
/// recorded commands of an earlier session do not reduce a budget. A sender has separate budgets
/// after its first valid signature. The other senders share one budget per host and one budget for
/// all hosts. At each level, emergency stops have a separate budget.
class SignatureBudgets {
 public:
  /// Budgets for signature checks: of ordinary commands and of emergency stops.
  struct Rates {
    Budget orders;
    Budget stops;
  };
  /// maximum number of senders; a new sender replaces the one that was silent longest
  static constexpr std::size_t kVerifiedMax = 16;
  /// maximum number of hosts; a new host replaces the one that was silent longest
  static constexpr std::size_t kHostsMax = 64;
  /// A sender or host with a message within this time is never replaced.
  static constexpr Duration kKeptFor = std::chrono::seconds(3);

  SignatureBudgets()
      : SignatureBudgets({Budget(100.0, 50.0), Budget(100.0, 50.0)},
                         {Budget(10.0, 10.0), Budget(20.0, 20.0)},
                         {Budget(40.0, 40.0), Budget(100.0, 50.0)}) {}
  SignatureBudgets(const Rates& verified, const Rates& host, const Rates& unverified)
      : verified_(verified), host_(host), unverified_(unverified) {}

  /// Returns true if a message of `sender` may be verified. `now` must not decrease.
  bool take(const Sender& sender, bool is_stop, Time now);
  /// Gives `sender` separate budgets, after a valid signature with a current nonce.
  void add_verified(const Sender& sender, Time now);

 private:
  struct VerifiedSender {
    Sender sender;
    Rates left;
    Time received{};  ///< time of the last valid signature
  };
  struct Host {
    std::uint64_t address = 0;
    Rates left;
    Time received{};
  };
  [[nodiscard]] VerifiedSender* find(const Sender& sender);
  /// Returns the entry of the sender's host; nullptr when all entries are used by other hosts.
  [[nodiscard]] Host* host_of(const Sender& sender, Time now);

  Rates verified_;  ///< initial budgets of each sender
  Rates host_;
  Rates unverified_;
  std::vector<VerifiedSender> senders_;
  std::vector<Host> hosts_;
};

/// Largest accepted difference between the sender's time and the receiver's time.
inline constexpr Duration kClockDifferenceMax = std::chrono::seconds(2);

/// Expected properties of a message.
struct Expectation {
  scenario::TrialMode mode = scenario::TrialMode::kLive;
  Time now{};                      ///< by the receiver's steady clock
  bool is_emergency_stop = false;  ///< according to the payload, before verification
  std::uint64_t source = 0;  ///< sender's address and port, as far as visible: Payload::source
  /// Reason to refuse a command without verifying its signature. It is derived from the echoes and
  /// the payload, both of which are protected by the MAC.
  Refusal early_refusal = Refusal::kNone;
  bool echoes_current_nonce = false;  ///< true: a command with a current nonce, not a recording
  bool is_of_log = false;             ///< recorded message: its time is not checked
};

struct Verdict {
  Refusal refusal = Refusal::kNone;
  Bytes payload;                     ///< message without its trailer; set for every verdict
  std::optional<SignedParts> parts;  ///< nullopt: unsigned
};

/// Checks `message` on `channel` for everything except the destination (judge_echo()). The time of
/// a command is not checked here: the caller checks its stamp and its echoes. Cost: as sign(); a
/// signature check takes 42 µs, and the budgets limit the number of checks. Changes `replays` only
/// for messages that pass all other checks.
Verdict verify(const Keyring& keyring, std::string_view channel, Bytes message,
               const Expectation& expectation, ReplayGuard& replays, SignatureBudgets& budgets);

/// Checks that a command is addressed to the vehicle `destination` and echoes one of its `nonces`.
Refusal judge_echo(const SignedParts& parts, std::uint32_t destination,
                   std::span<const std::uint64_t> nonces);

}  // namespace vantage::bus::auth

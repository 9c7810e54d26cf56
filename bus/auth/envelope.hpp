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

// Signing a message and judging one: functions of values, no clock, no network.
//
//   signature = Ed25519(seed, n ‖ channel ‖ payload ‖ echoes ‖ foot)           (COMMAND alone)
//   MAC       = BLAKE2b-128(key, n ‖ channel ‖ payload ‖ echoes ‖ signature ‖ foot)
//
// n is one byte, the length of the channel's name; BLAKE2b's key and output length are parameters
// of it (RFC 7693), not a prefix. Who verifies a MAC could make one; so that a captured vehicle
// cannot command others, what the operator says has a signature besides.

namespace vantage::bus::auth {

/// Appends to the payload in `message` what makes it a signed message on `channel`.
/// Preconditions: key.can_sign(), key.role == foot.role, echoes ≤ kEchoesMax, channel ≤ 255 bytes.
/// Cost: 0.6 µs for 250 bytes, 16 µs more with a signature.
void sign(const Key& key, std::string_view channel, Foot foot, std::span<const Echo> echoes,
          std::vector<std::uint8_t>& message);

/// Why a message is not believed.
enum class Refusal : std::uint8_t {
  kNone,
  kUnsigned,
  kUnknownKey,
  kWrongRole,         ///< the key is not of those who may say this
  kBadMac,            ///< not made with the key that it names, or changed on the way
  kBadSignature,      ///< the same of an operator's signature, or it has none
  kOverBudget,        ///< not looked at: too many to verify
  kWrongMode,         ///< of a simulation, a replay: another kind of trial
  kStale,             ///< said at another time than now
  kReplayed,          ///< heard before, or long overtaken
  kWrongSession,      ///< a command with a nonce that the vehicle does not ask for
  kWrongDestination,  ///< a command that is not said to this vehicle
};
inline constexpr std::size_t kRefusals = 12;
/// "unsigned", "unknown_key", "wrong_role", …: as counters are called.
const char* name_of(Refusal refusal);

/// What was heard of each session, so that nothing is taken twice. Remembers for each session the
/// newest 64 counters: older ones count as replayed, those between may still come. At most 256
/// sessions; the one silent longest gives way.
class ReplayGuard {
 public:
  static constexpr std::size_t kWindow = 64;
  static constexpr std::size_t kSessionsMax = 256;

  /// True once for each counter, from 1. To be asked only of what is proven to be of the key's
  /// holder.
  bool admit(std::uint32_t key_id, std::uint64_t session, std::uint64_t counter);
  /// Whether admit() would refuse it; changes nothing.
  [[nodiscard]] bool refuses(std::uint32_t key_id, std::uint64_t session,
                             std::uint64_t counter) const;
  [[nodiscard]] bool knows(std::uint32_t key_id, std::uint64_t session) const {
    return find(key_id, session) != nullptr;
  }

 private:
  struct Session {
    std::uint32_t key_id = 0;
    std::uint64_t session = 0;
    std::uint64_t asked_last = 0;
    std::uint64_t forgotten = 0;      ///< the newest that is no longer remembered; 0: none
    std::vector<std::uint64_t> seen;  ///< ascending
  };
  [[nodiscard]] const Session* find(std::uint32_t key_id, std::uint64_t session) const;
  [[nodiscard]] static bool has_heard(const Session& session, std::uint64_t counter);

  std::vector<Session> sessions_;
  std::uint64_t asked_ = 0;
};

/// So many verifications a second, and so many at once.
class Budget {
 public:
  Budget(double rate_per_s, double burst) : rate_per_s_(rate_per_s), burst_(burst), left_(burst) {}
  /// True when there is one left, which is taken. `now` never goes back.
  bool take(Time now);

 private:
  double rate_per_s_;
  double burst_;
  double left_;
  std::optional<Time> asked_;
};

/// Who says something, as far as it can be seen before it is proven.
struct Sender {
  std::uint64_t source = 0;  ///< address and port, bus::Payload::source
  std::uint64_t session = 0;
};

/// Limits how many signatures a process verifies, by sender. Only commands with a valid MAC that
/// are of now or echo a nonce of now are verified (Expectation::before_signature), so recorded
/// commands of an earlier session use up no budget. A sender has budgets of its own once it was
/// proven; the others share one for each host and one for all hosts. Emergency stops have separate
/// budgets everywhere.
class SignatureBudgets {
 public:
  /// So many of what is no stop; stops.
  struct Rates {
    Budget orders;
    Budget stops;
  };
  static constexpr std::size_t kProvenMax = 16;  ///< the one silent longest is replaced
  static constexpr std::size_t kHostsMax = 64;   ///< likewise
  /// A sender or host that was received within this time is never replaced.
  static constexpr Duration kKeptFor = std::chrono::seconds(3);

  SignatureBudgets()
      : SignatureBudgets({Budget(100.0, 50.0), Budget(100.0, 50.0)},
                         {Budget(10.0, 10.0), Budget(20.0, 20.0)},
                         {Budget(40.0, 40.0), Budget(100.0, 50.0)}) {}
  SignatureBudgets(const Rates& proven, const Rates& host, const Rates& strangers)
      : proven_(proven), host_(host), strangers_(strangers) {}

  /// Whether what `sender` says may be verified now. `now` never goes back.
  bool take(const Sender& sender, bool is_stop, Time now);
  /// Gives `sender` budgets of its own: its signature was valid and it echoed a nonce of now.
  void prove(const Sender& sender, Time now);

 private:
  struct Proven {
    Sender sender;
    Rates left;
    Time received{};  ///< when it was proven last
  };
  struct Host {
    std::uint64_t address = 0;
    Rates left;
    Time received{};
  };
  [[nodiscard]] Proven* find(const Sender& sender);
  /// nullptr: all places are kept.
  [[nodiscard]] Host* host_of(const Sender& sender, Time now);

  Rates proven_;  ///< as one begins
  Rates host_;
  Rates strangers_;
  std::vector<Proven> senders_;
  std::vector<Host> hosts_;
};

/// How far the sender's time may be from ours.
inline constexpr Duration kSaidWithin = std::chrono::seconds(2);

/// What a receiver holds a message against.
struct Expectation {
  scenario::TrialMode mode = scenario::TrialMode::kLive;
  Time now{};                      ///< by the receiver's steady clock
  bool is_emergency_stop = false;  ///< the payload says so, before anything is proven
  std::uint64_t source = 0;        ///< who sent it, as far as can be seen: Payload::source
  /// The reason to refuse a command without verifying its signature. It is derived from echoes and
  /// payload, which the MAC covers.
  Refusal before_signature = Refusal::kNone;
  bool echoes_now = false;  ///< of a command: it echoes a nonce of now, so no recording contains it
  bool is_of_log = false;   ///< recorded: its time is not judged
};

struct Verdict {
  Refusal refusal = Refusal::kNone;
  Bytes payload;                     ///< the message without its trailer, whatever the verdict
  std::optional<SignedParts> parts;  ///< nullopt: unsigned
};

/// Judges `message` on `channel` by everything except the destination (judge_echo()). The time of a
/// command is not judged here: the caller judges its stamp and its echoes. Cost: as sign(); a
/// signature is verified in 42 µs, within the budgets. Changes `replays` only for what is otherwise
/// good.
Verdict verify(const Keyring& keyring, std::string_view channel, Bytes message,
               const Expectation& expectation, ReplayGuard& replays, SignatureBudgets& budgets);

/// Whether a command is said to the vehicle `destination`, with one of the nonces it asks for.
Refusal judge_echo(const SignedParts& parts, std::uint32_t destination,
                   std::span<const std::uint64_t> nonces);

}  // namespace vantage::bus::auth

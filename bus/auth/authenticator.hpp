#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bus/auth/envelope.hpp"
#include "bus/auth/keyring.hpp"
#include "bus/auth/trailer.hpp"
#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::bus::auth {

/// One process's part in an authenticated bus: its session, what it heard of others', the nonces
/// that vehicles ask for, what was refused. Handed time; not thread-safe.
class Authenticator {
 public:
  struct Rules {
    scenario::SecurityMode mode = scenario::SecurityMode::kRequire;
    scenario::TrialMode trial = scenario::TrialMode::kLive;
    bool is_replay = false;  ///< signs everything as kReplay, and judges nothing
    bool is_of_log = false;  ///< judges what a log contains: by its signatures, not by time
  };
  /// How long a vehicle still takes the nonce that it asked for before.
  static constexpr Duration kNonceGrace = std::chrono::seconds(1);
  /// A vehicle's nonce of another session is not believed while this one was heard within so long,
  /// unless it was said later: old statuses that are sent again displace no live vehicle's.
  static constexpr Duration kNonceLease = std::chrono::seconds(2);

  Authenticator(std::shared_ptr<const Keyring> keyring, const Rules& rules);

  /// From now on this process is the vehicle `robot`: its statuses carry the nonce that commands
  /// must echo, or they act on it only by making it safer.
  void answer_to(std::string_view robot) { destination_ = destination_of(robot); }
  /// A new session, and with it a new nonce.
  void renew_session(Time now);

  /// Appends to the payload in `message` what makes it signed, if this process has the key of the
  /// channel's role; else counts. `robot`: to whom a command is said; empty: to all that are heard.
  void seal(std::string_view channel, std::string_view robot, Time now,
            std::vector<std::uint8_t>& message);

  struct Judged {
    bool may_pass = false;
    Bytes payload;
    Refusal echo = Refusal::kNone;  ///< of a command that passes, held against this vehicle's nonce
  };
  /// The statements of a command's payload, before anything is proven.
  struct CommandClaim {
    Time stamp{};
    bool makes_safer = false;  ///< hold, land, emergency stop
    bool is_emergency_stop = false;
    bool is_for_another = false;  ///< it names another vehicle than this one
  };
  /// Decides whether `message` may pass, and counts the reason if not. The time is judged by `now`,
  /// except in a replay. `claim`: of a command, if its payload can be read. `source`: the sender,
  /// as far as can be seen (Payload::source).
  Judged judge(std::string_view channel, Bytes message, Time now,
               const std::optional<CommandClaim>& claim = std::nullopt, std::uint64_t source = 0);

  /// Counts a refusal; whether the message may pass all the same (SecurityMode::kWarn).
  bool refuse(std::string_view channel, Refusal refusal);
  /// Appends "<channel>.<reason>" for each reason that refused something, and "<channel>.no_key".
  void count(std::vector<models::NamedCount>& out) const;

  [[nodiscard]] std::uint64_t session() const { return session_; }
  [[nodiscard]] bool is_replay() const { return rules_.is_replay; }
  /// Returns how far statuses that were refused as stale within the last second are ahead of our
  /// clock: the smallest difference. nullopt: none was refused.
  [[nodiscard]] std::optional<Duration> stale_ahead(Time now) const;

 private:
  /// What a vehicle asks to be echoed, as its statuses say.
  struct Asked {
    std::uint64_t nonce = 0;
    std::uint64_t counter = 0;  ///< of the newest status with it
    Time heard{};
  };
  void hear_nonce(std::string_view robot, const Foot& foot, Time now);
  /// Whether another vehicle can be echoed, if need be in the place of one that is heard no more.
  [[nodiscard]] bool make_room(Time now);
  [[nodiscard]] Refusal judge_nonce(const SignedParts& parts, Time now) const;
  /// Whether the command echoes a nonce that is valid now: ours, or that of a vehicle which this
  /// process receives.
  [[nodiscard]] bool echoes_now(const SignedParts& parts, Time now) const;
  /// The reason to refuse a command before its signature is verified; kNone: verify it.
  [[nodiscard]] Refusal judge_before_signature(const SignedParts& parts, Time now,
                                               const std::optional<CommandClaim>& claim) const;
  void note_stale(const Foot& foot, Time now);

  std::shared_ptr<const Keyring> keyring_;
  Rules rules_;
  std::uint64_t session_ = 0;
  std::uint64_t session_before_ = 0;
  std::optional<Time> renewed_;
  std::uint64_t counter_ = 0;
  std::optional<std::uint32_t> destination_;  ///< of a vehicle
  std::map<std::uint32_t, Asked> asked_;      ///< by destination
  std::optional<Duration> stale_ahead_;
  Time stale_received_{};
  ReplayGuard replays_;
  SignatureBudgets budgets_;
  std::map<std::string, std::array<std::int64_t, kRefusals>, std::less<>> refused_;
  std::map<std::string, std::int64_t, std::less<>> without_key_;
};

/// The channel and the reason of a counter that count() made; nullopt for any other.
struct RefusalCount {
  std::string channel;
  std::string reason;
};
std::optional<RefusalCount> parse_refusal(std::string_view counter);

/// Makes what a live process of `scenario` signs and judges by; nullptr without security.
/// @throws StartupError where a device is real and security is not `require`, and as
/// load_keyring().
std::unique_ptr<Authenticator> authenticator_for(const scenario::Scenario& scenario);
/// The form for a replay: signs as a replay and judges nothing. nullptr without security, or where
/// the folder of keys does not exist. @throws StartupError as load_keyring().
std::unique_ptr<Authenticator> replay_authenticator_for(const scenario::Scenario& scenario);
/// The form for who reads a log: judges as the flight's processes did, but not by time. nullptr and
/// @throws as the form for a replay.
std::unique_ptr<Authenticator> log_authenticator_for(const scenario::Scenario& scenario);

/// What keeps `scenario` from being flown as it says, each a sentence; empty: nothing. Looks at the
/// key files: every role's must be here. Where commands must echo nonces there is room for those of
/// kEchoesMax robots.
std::vector<std::string> security_faults(const scenario::Scenario& scenario);

/// @throws StartupError when this host's keys do not let it say commands.
void require_operator(const scenario::Scenario& scenario);

}  // namespace vantage::bus::auth

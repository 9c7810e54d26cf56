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

/// State of one process on an authenticated bus: its session, the replay windows and nonces of
/// other sessions, and the numbers of refused messages. Times are parameters. Not thread-safe.
class Authenticator {
 public:
  struct Rules {
    scenario::SecurityMode mode = scenario::SecurityMode::kRequire;
    scenario::TrialMode trial = scenario::TrialMode::kLive;
    bool is_replay = false;  ///< true: signs all messages as kReplay and accepts all messages
    /// true: checks signatures but not times, because the messages are recorded
    bool is_of_log = false;
  };
  /// Time for which a vehicle still accepts its previous nonce after its nonce has changed.
  static constexpr Duration kNonceGrace = std::chrono::seconds(1);
  /// Lease of a vehicle's nonce. For this time after a status with the nonce, another nonce is only
  /// accepted from a newer status. So replayed statuses cannot replace a live vehicle's nonce.
  static constexpr Duration kNonceLease = std::chrono::seconds(2);

  Authenticator(std::shared_ptr<const Keyring> keyring, const Rules& rules);

  /// Declares this process to be the vehicle `robot`. Its statuses then carry the nonce that
  /// commands must echo. A command without this nonce is only obeyed if it makes the vehicle safer.
  void act_as_vehicle(std::string_view robot) { destination_ = destination_of(robot); }
  /// Begins a new session, and with it a new nonce.
  void renew_session(Time now);

  /// Appends the trailer that signs the payload in `message`, if this process has the key of the
  /// channel's role; otherwise counts the message. `robot`: addressee of a command; empty: all
  /// vehicles that send a status to this process.
  void seal(std::string_view channel, std::string_view robot, Time now,
            std::vector<std::uint8_t>& message);

  struct Judged {
    bool may_pass = false;
    Bytes payload;
    /// for an accepted command: result of comparing its echo with this vehicle's nonce
    Refusal echo = Refusal::kNone;
  };
  /// Unverified content of a command.
  struct CommandClaim {
    Time stamp{};
    bool makes_safer = false;  ///< hold, land or emergency stop
    bool is_emergency_stop = false;
    bool is_for_another = false;  ///< addressed to another vehicle
  };
  /// Decides whether `message` is accepted, and counts the reason of a refusal. The message's time
  /// is compared with `now`, except with is_of_log. With is_replay every message is accepted.
  /// `claim`: for a command with a readable payload. `source`: sender, as far as visible
  /// (Payload::source).
  Judged judge(std::string_view channel, Bytes message, Time now,
               const std::optional<CommandClaim>& claim = std::nullopt, std::uint64_t source = 0);

  /// Counts a refusal. Returns true if the message is accepted nevertheless: in every mode except
  /// kRequire.
  bool refuse(std::string_view channel, Refusal refusal);
  /// Appends the counter "<channel>.<reason>" for each reason for which messages were refused, and
  /// "<channel>.no_key" for messages published unsigned because this process has no key.
  void count(std::vector<models::NamedCount>& out) const;

  [[nodiscard]] std::uint64_t session() const { return session_; }
  [[nodiscard]] bool is_replay() const { return rules_.is_replay; }
  /// Returns the smallest difference (> 0: ahead) from this process's clock among the statuses
  /// refused as stale within the last second; nullopt if there is none.
  [[nodiscard]] std::optional<Duration> stale_ahead(Time now) const;

 private:
  /// Nonce that commands to a vehicle must echo, as requested by its statuses.
  struct RequestedNonce {
    std::uint64_t nonce = 0;
    std::uint64_t counter = 0;  ///< counter of the newest status with this nonce
    Time received_at{};
  };
  void record_nonce(std::string_view robot, const Foot& foot, Time now);
  /// Frees an entry for the nonce of another vehicle, if necessary by removing the entry of a
  /// silent vehicle. Returns false if no entry can be freed.
  [[nodiscard]] bool make_room(Time now);
  [[nodiscard]] Refusal judge_nonce(const SignedParts& parts, Time now) const;
  /// True if the command echoes a nonce that is valid at `now`: the nonce of this process, or of a
  /// vehicle that sends a status to this process.
  [[nodiscard]] bool echoes_current_nonce(const SignedParts& parts, Time now) const;
  /// Returns the reason to refuse a command before its signature is verified; kNone: verify it.
  [[nodiscard]] Refusal judge_before_signature(const SignedParts& parts, Time now,
                                               const std::optional<CommandClaim>& claim) const;
  void note_stale(const Foot& foot, Time now);

  std::shared_ptr<const Keyring> keyring_;
  Rules rules_;
  std::uint64_t session_ = 0;
  std::uint64_t session_before_ = 0;
  std::optional<Time> renewed_;
  std::uint64_t counter_ = 0;
  std::optional<std::uint32_t> destination_;           ///< set if this process is a vehicle
  std::map<std::uint32_t, RequestedNonce> requested_;  ///< requested nonce of each destination
  std::optional<Duration> stale_ahead_;
  Time stale_received_{};
  ReplayGuard replays_;
  SignatureBudgets budgets_;
  std::map<std::string, std::array<std::int64_t, kRefusals>, std::less<>> refused_;
  std::map<std::string, std::int64_t, std::less<>> without_key_;
};

/// Channel and reason of a counter from count(). parse_refusal() returns nullopt for other
/// counters.
struct RefusalCount {
  std::string channel;
  std::string reason;
};
std::optional<RefusalCount> parse_refusal(std::string_view counter);

/// Creates the authenticator of a live process of `scenario`; nullptr without security.
/// @throws StartupError when a device is real and security is not `require`, and in the same cases
/// as load_keyring().
std::unique_ptr<Authenticator> authenticator_for(const scenario::Scenario& scenario);
/// Creates the authenticator of a replay: it signs as a replay and checks nothing. nullptr without
/// security or without the folder of keys. @throws StartupError as load_keyring().
std::unique_ptr<Authenticator> replay_authenticator_for(const scenario::Scenario& scenario);
/// Creates the authenticator of a log reader: it makes the checks that the flight's processes made,
/// except those of time. Returns nullptr and throws in the same cases as
/// replay_authenticator_for().
std::unique_ptr<Authenticator> log_authenticator_for(const scenario::Scenario& scenario);

/// Returns the security faults that prevent `scenario` from being flown, one sentence each; empty
/// if there are none. Checks the key files: keys of all roles must be present. If commands must
/// echo nonces, at most kEchoesMax robots are possible.
std::vector<std::string> security_faults(const scenario::Scenario& scenario);

/// Checks that this host can sign commands, unless security is off. @throws StartupError if it
/// cannot.
void require_operator(const scenario::Scenario& scenario);

}  // namespace vantage::bus::auth

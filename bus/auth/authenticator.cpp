#include "bus/auth/authenticator.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <sodium.h>

#include "core/check.hpp"

namespace vantage::bus::auth {
namespace {

constexpr std::string_view kStatusPrefix = "VEHICLE_";
constexpr std::string_view kNoKey = "no_key";
/// Maximum number of channels that are counted separately, so that invented names cannot exhaust
/// memory. Further channels share one entry.
constexpr std::size_t kCountedChannelsMax = 1024;
constexpr std::string_view kOtherChannels = "(other)";

std::uint64_t random_session() {
  start_sodium();
  std::uint64_t session = 0;
  while (session == 0) {
    randombytes_buf(&session, sizeof session);
  }
  return session;
}

/// Returns the count of `channel`. Invented names may fill the table, but channels with a fixed
/// name (VICON, COMMAND, …) always have their own entry.
template <class Count>
Count& entry_of(std::map<std::string, Count, std::less<>>& counts, std::string_view channel) {
  const auto found = counts.find(channel);
  if (found != counts.end()) {
    return found->second;
  }
  const bool has_room = counts.size() < kCountedChannelsMax || is_fixed_name(channel);
  return counts[std::string(has_room ? channel : kOtherChannels)];
}

/// True if a sender's `stamp` is within kClockDifferenceMax of `now`.
bool is_current(Time stamp, Time now) {
  return stamp >= now - kClockDifferenceMax && stamp <= now + kClockDifferenceMax;
}

constexpr Duration kStaleShownFor = std::chrono::seconds(1);

/// Returns the error text, with its remedy, for a real device without required signatures.
std::string real_device_fault(const scenario::Scenario& scenario) {
  return "a device is real, so its commands must be signed: write security: {mode: require, "
         "keys: FOLDER} into the scenario, and create the keys: vantage keys new " +
         (scenario.security.keys.empty() ? "FOLDER" : scenario.security.keys);
}

bool lacks_required_security(const scenario::Scenario& scenario) {
  return scenario::trial_mode(scenario) == scenario::TrialMode::kLive &&
         scenario.security.mode != scenario::SecurityMode::kRequire;
}

/// True if there are more vehicles than one command can address. Vehicles beyond this number could
/// not be armed and would detect a loss of the operator. Every robot requests an echo; only robots
/// with drivers check it.
bool has_too_many_vehicles(const scenario::Scenario& scenario) {
  return scenario.security.mode == scenario::SecurityMode::kRequire &&
         scenario.robots.size() > kEchoesMax &&
         std::any_of(scenario.robots.begin(), scenario.robots.end(), [](const auto& robot) {
           return robot.device != scenario::DeviceSource::kDirect;
         });
}

std::unique_ptr<Authenticator> made_for(const scenario::Scenario& scenario,
                                        Authenticator::Rules rules) {
  const scenario::SecuritySpec& security = scenario.security;
  if (security.mode == scenario::SecurityMode::kOff) {
    return nullptr;
  }
  rules.mode = security.mode;
  rules.trial = scenario::trial_mode(scenario);
  return std::make_unique<Authenticator>(
      std::make_shared<const Keyring>(load_keyring(security.keys)), rules);
}

bool has_key_folder(const scenario::Scenario& scenario) {
  std::error_code error;
  return std::filesystem::exists(scenario.security.keys, error);
}

}  // namespace

Authenticator::Authenticator(std::shared_ptr<const Keyring> keyring, const Rules& rules)
    : keyring_(std::move(keyring)), rules_(rules), session_(random_session()) {
  rules_.trial = rules.is_replay ? scenario::TrialMode::kReplay : rules.trial;
}

void Authenticator::renew_session(Time now) {
  session_before_ = session_;
  session_ = random_session();
  renewed_ = now;
}

void Authenticator::seal(std::string_view channel, std::string_view robot, Time now,
                         std::vector<std::uint8_t>& message) {
  const Role role = role_of(channel);
  const Key* const key = keyring_->signing(role);
  if (key == nullptr) {
    ++entry_of(without_key_, channel);
    return;
  }
  std::vector<Echo> echoes;
  if (role == Role::kOperator) {
    const std::uint32_t to = destination_of(robot);
    for (const auto& [destination, requested] : requested_) {
      if ((robot.empty() || destination == to) && echoes.size() < kEchoesMax) {
        echoes.push_back({destination, requested.nonce});
      }
    }
  }
  counter_ =
      std::max(counter_ + 1, static_cast<std::uint64_t>(std::max<std::int64_t>(0, to_utime(now))));
  sign(*key, channel, {key->id, session_, counter_, role, rules_.trial}, echoes, message);
}

Authenticator::Judged Authenticator::judge(std::string_view channel, Bytes message, Time now,
                                           const std::optional<CommandClaim>& claim,
                                           std::uint64_t source) {
  if (rules_.is_replay) {
    return {true, payload_of(message)};
  }
  Expectation expectation{rules_.trial, now, claim && claim->is_emergency_stop, source};
  const bool is_command = role_of(channel) == Role::kOperator;
  expectation.is_of_log = rules_.is_of_log;
  if (rules_.is_of_log) {
    expectation.echoes_current_nonce = true;
  } else if (const auto parts = is_command ? split(message) : std::nullopt) {
    expectation.early_refusal = judge_before_signature(*parts, now, claim);
    expectation.echoes_current_nonce = echoes_current_nonce(*parts, now);
  }
  const Verdict verdict = verify(*keyring_, channel, message, expectation, replays_, budgets_);
  Judged judged{true, verdict.payload};
  if (verdict.refusal == Refusal::kUnsigned && !must_be_signed(channel)) {
    return judged;
  }
  const bool is_status = channel.starts_with(kStatusPrefix);
  if (verdict.refusal != Refusal::kNone) {
    if (verdict.refusal == Refusal::kStale && is_status) {
      note_stale(verdict.parts->foot, now);
    }
    judged.may_pass = refuse(channel, verdict.refusal);
    return judged;
  }
  if (is_status) {
    record_nonce(channel.substr(kStatusPrefix.size()), verdict.parts->foot, now);
  } else if (is_command && destination_) {
    judged.echo = judge_nonce(*verdict.parts, now);
  }
  return judged;
}

void Authenticator::record_nonce(std::string_view robot, const Foot& foot, Time now) {
  const std::uint32_t destination = destination_of(robot);
  const auto known = requested_.find(destination);
  if (known == requested_.end()) {
    if (make_room(now)) {
      requested_[destination] = {foot.session, foot.counter, now};
    }
    return;
  }
  RequestedNonce& requested = known->second;
  if (foot.session == requested.nonce) {
    requested.counter = std::max(requested.counter, foot.counter);
    requested.received_at = now;
  } else if (foot.counter > requested.counter || now - requested.received_at > kNonceLease) {
    requested = {foot.session, foot.counter, now};
  }
}

// When a vehicle is silent for longer than kNonceLease, any nonce of the vehicle is accepted. Its
// entry can then be removed without loss of protection.
bool Authenticator::make_room(Time now) {
  if (requested_.size() < kEchoesMax) {
    return true;
  }
  const auto oldest = std::min_element(
      requested_.begin(), requested_.end(),
      [](const auto& a, const auto& b) { return a.second.received_at < b.second.received_at; });
  if (now - oldest->second.received_at <= kNonceLease) {
    return false;
  }
  requested_.erase(oldest);
  return true;
}

Refusal Authenticator::judge_nonce(const SignedParts& parts, Time now) const {
  const std::array nonces{session_, session_before_};
  const bool is_in_grace_time = renewed_ && now - *renewed_ <= kNonceGrace;
  return judge_echo(parts, *destination_, std::span(nonces).first(is_in_grace_time ? 2 : 1));
}

bool Authenticator::echoes_current_nonce(const SignedParts& parts, Time now) const {
  if (destination_) {
    return judge_nonce(parts, now) == Refusal::kNone;
  }
  return std::any_of(requested_.begin(), requested_.end(), [&](const auto& each) {
    const auto& [destination, requested] = each;
    return now - requested.received_at <= kNonceLease &&
           parts.echo_for(destination) == requested.nonce;
  });
}

// A recording of an earlier session echoes old nonces and has old time stamps. A command with a
// current time stamp is verified even with a wrong nonce, so that its counter is recorded. A
// command that makes a vehicle safer may be late if its session was verified before.
Refusal Authenticator::judge_before_signature(const SignedParts& parts, Time now,
                                              const std::optional<CommandClaim>& claim) const {
  const bool is_late_but_known =
      claim && claim->makes_safer && replays_.knows(parts.foot.key_id, parts.foot.session);
  if ((claim && is_current(claim->stamp, now)) || is_late_but_known ||
      echoes_current_nonce(parts, now)) {
    return Refusal::kNone;
  }
  const bool may_be_anyones =
      !destination_ || !claim || claim->makes_safer || claim->is_for_another;
  return may_be_anyones ? Refusal::kStale : judge_nonce(parts, now);
}

void Authenticator::note_stale(const Foot& foot, Time now) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const Duration ahead = from_utime(static_cast<std::int64_t>(std::min(foot.counter, kMax))) - now;
  const std::optional<Duration> known = stale_ahead(now);
  if (!known || std::chrono::abs(ahead) <= std::chrono::abs(*known)) {
    stale_ahead_ = ahead;
    stale_received_ = now;
  }
}

std::optional<Duration> Authenticator::stale_ahead(Time now) const {
  const bool is_recent = stale_ahead_ && now - stale_received_ <= kStaleShownFor;
  return is_recent ? stale_ahead_ : std::nullopt;
}

bool Authenticator::refuse(std::string_view channel, Refusal refusal) {
  ++entry_of(refused_, channel)[static_cast<std::size_t>(refusal)];
  return rules_.mode != scenario::SecurityMode::kRequire;
}

void Authenticator::count(std::vector<models::NamedCount>& out) const {
  for (const auto& [channel, counts] : refused_) {
    for (std::size_t i = 0; i < kRefusals; ++i) {
      if (counts[i] != 0) {
        out.push_back({channel + "." + name_of(static_cast<Refusal>(i)), counts[i]});
      }
    }
  }
  for (const auto& [channel, count] : without_key_) {
    out.push_back({fmt::format("{}.{}", channel, kNoKey), count});
  }
}

std::optional<RefusalCount> parse_refusal(std::string_view counter) {
  const std::size_t dot = counter.rfind('.');
  if (dot == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view reason = counter.substr(dot + 1);
  bool is_known = reason == kNoKey;
  for (std::size_t i = 1; i < kRefusals; ++i) {
    is_known = is_known || reason == name_of(static_cast<Refusal>(i));
  }
  return is_known
             ? std::optional(RefusalCount{std::string(counter.substr(0, dot)), std::string(reason)})
             : std::nullopt;
}

std::unique_ptr<Authenticator> authenticator_for(const scenario::Scenario& scenario) {
  if (lacks_required_security(scenario)) {
    throw StartupError(real_device_fault(scenario));
  }
  return made_for(scenario, {});
}

std::unique_ptr<Authenticator> replay_authenticator_for(const scenario::Scenario& scenario) {
  return has_key_folder(scenario) ? made_for(scenario, {.is_replay = true}) : nullptr;
}

std::unique_ptr<Authenticator> log_authenticator_for(const scenario::Scenario& scenario) {
  return has_key_folder(scenario) ? made_for(scenario, {.is_of_log = true}) : nullptr;
}

std::vector<std::string> security_faults(const scenario::Scenario& scenario) {
  if (lacks_required_security(scenario)) {
    return {real_device_fault(scenario)};
  }
  std::vector<std::string> faults;
  if (scenario.security.mode == scenario::SecurityMode::kOff) {
    return faults;
  }
  if (has_too_many_vehicles(scenario)) {
    faults.push_back(fmt::format(
        "robots: the scenario has {1} vehicles, but a signed command can address at most {0}; use "
        "fewer vehicles, or simulate them without drivers (device: direct)",
        kEchoesMax, scenario.robots.size()));
  }
  try {
    const Keyring keyring = load_keyring(scenario.security.keys);
    for (const Role role : kRoles) {
      const bool is_there = std::any_of(
          keyring.keys().begin(), keyring.keys().end(),
          [role](const Key& key) { return key.role == role && key.use == KeyUse::kSigns; });
      if (!is_there) {
        faults.push_back(fmt::format("{}: no key for the role {} (file {}-ID.key)",
                                     scenario.security.keys, name_of(role), name_of(role)));
      }
    }
  } catch (const StartupError& error) {
    faults.emplace_back(error.what());
  }
  return faults;
}

void require_operator(const scenario::Scenario& scenario) {
  if (scenario.security.mode != scenario::SecurityMode::kOff &&
      load_keyring(scenario.security.keys).signing(Role::kOperator) == nullptr) {
    throw StartupError(scenario.security.keys +
                       ": this host cannot send commands: operator-ID.sign is missing; only "
                       "operator stations have this file");
  }
}

}  // namespace vantage::bus::auth

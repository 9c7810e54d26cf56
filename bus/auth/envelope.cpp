#include "bus/auth/envelope.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <limits>

#include <sodium.h>

namespace vantage::bus::auth {
namespace {

using Mac = std::array<std::uint8_t, kMacBytes>;
static_assert(kMacBytes == crypto_generichash_BYTES_MIN);
static_assert(kSignatureBytes == crypto_sign_ed25519_BYTES);

Mac mac_of(const Secret& key, std::string_view channel, std::initializer_list<Bytes> parts) {
  const auto length = static_cast<std::uint8_t>(channel.size());
  crypto_generichash_state state;
  crypto_generichash_init(&state, key.bytes().data(), key.bytes().size(), kMacBytes);
  crypto_generichash_update(&state, &length, 1);
  crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(channel.data()),
                            channel.size());
  for (const Bytes part : parts) {
    crypto_generichash_update(&state, part.data(), part.size());
  }
  Mac mac{};
  crypto_generichash_final(&state, mac.data(), mac.size());
  sodium_memzero(&state, sizeof state);
  return mac;
}

/// Returns the signed bytes in one contiguous buffer, as Ed25519 requires.
std::vector<std::uint8_t> signed_text(std::string_view channel,
                                      std::initializer_list<Bytes> parts) {
  std::vector<std::uint8_t> text;
  text.push_back(static_cast<std::uint8_t>(channel.size()));
  text.insert(text.end(), channel.begin(), channel.end());
  for (const Bytes part : parts) {
    text.insert(text.end(), part.begin(), part.end());
  }
  return text;
}

/// Adds `one` to `all` if `all` is not full. Otherwise replaces the entry that has been silent
/// longest, if it was silent for more than kKeptFor. Returns nullptr when no entry can be replaced.
template <class One>
One* added(One one, std::vector<One>& all, std::size_t count_max) {
  if (all.size() < count_max) {
    return &all.emplace_back(std::move(one));
  }
  const auto oldest = std::min_element(
      all.begin(), all.end(), [](const One& a, const One& b) { return a.received < b.received; });
  if (one.received - oldest->received <= SignatureBudgets::kKeptFor) {
    return nullptr;
  }
  *oldest = std::move(one);
  return &*oldest;
}

bool is_current(std::uint64_t counter, Time now) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  const Time sent_at = from_utime(static_cast<std::int64_t>(std::min(counter, kMax)));
  return sent_at >= now - kClockDifferenceMax && sent_at <= now + kClockDifferenceMax;
}

Refusal judge_signature(const Key& key, std::string_view channel, const SignedParts& parts,
                        SignatureBudgets& budgets, const Expectation& expectation) {
  if (parts.signature.empty()) {
    return Refusal::kBadSignature;
  }
  const Sender sender{expectation.source, parts.foot.session};
  if (!budgets.take(sender, expectation.is_emergency_stop, expectation.now)) {
    return Refusal::kOverBudget;
  }
  const std::vector<std::uint8_t> text =
      signed_text(channel, {parts.payload, parts.echoes, parts.foot_bytes});
  const bool is_good = crypto_sign_ed25519_verify_detached(parts.signature.data(), text.data(),
                                                           text.size(), key.public_key.data()) == 0;
  if (!is_good) {
    return Refusal::kBadSignature;
  }
  if (expectation.echoes_current_nonce) {
    budgets.add_verified(sender, expectation.now);
  }
  return Refusal::kNone;
}

Refusal judge(const Keyring& keyring, std::string_view channel, const SignedParts& parts,
              const Expectation& expectation, ReplayGuard& replays, SignatureBudgets& budgets) {
  const Foot& foot = parts.foot;
  const Key* const key = keyring.find(foot.key_id);
  if (key == nullptr) {
    return Refusal::kUnknownKey;
  }
  if (key->role != role_of(channel) || foot.role != key->role) {
    return Refusal::kWrongRole;
  }
  const Mac mac =
      mac_of(key->mac, channel, {parts.payload, parts.echoes, parts.signature, parts.foot_bytes});
  if (sodium_memcmp(mac.data(), parts.mac.data(), mac.size()) != 0) {
    return Refusal::kBadMac;
  }
  if (foot.mode != expectation.mode) {
    return Refusal::kWrongMode;
  }
  // This check precedes the signature check, so that a replayed message cannot use up a budget.
  if (replays.refuses(foot.key_id, foot.session, foot.counter)) {
    return Refusal::kReplayed;
  }
  if (key->role == Role::kOperator) {
    if (expectation.early_refusal != Refusal::kNone) {
      return expectation.early_refusal;
    }
    const Refusal refusal = judge_signature(*key, channel, parts, budgets, expectation);
    if (refusal != Refusal::kNone) {
      return refusal;
    }
  } else if (!expectation.is_of_log && !is_current(foot.counter, expectation.now)) {
    return Refusal::kStale;
  }
  replays.admit(foot.key_id, foot.session, foot.counter);
  return Refusal::kNone;
}

}  // namespace

const char* name_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::kNone:
      return "none";
    case Refusal::kUnsigned:
      return "unsigned";
    case Refusal::kUnknownKey:
      return "unknown_key";
    case Refusal::kWrongRole:
      return "wrong_role";
    case Refusal::kBadMac:
      return "bad_mac";
    case Refusal::kBadSignature:
      return "bad_signature";
    case Refusal::kOverBudget:
      return "over_budget";
    case Refusal::kWrongMode:
      return "wrong_mode";
    case Refusal::kStale:
      return "stale";
    case Refusal::kReplayed:
      return "replayed";
    case Refusal::kWrongSession:
      return "wrong_session";
    case Refusal::kWrongDestination:
      return "wrong_destination";
  }
  return "unknown";
}

void sign(const Key& key, std::string_view channel, Foot foot, std::span<const Echo> echoes,
          std::vector<std::uint8_t>& message) {
  assert(key.can_sign() && key.role == foot.role && channel.size() <= 255);
  foot.key_id = key.id;
  const std::size_t payload_bytes = message.size();
  const bool has_signature = key.role == Role::kOperator;
  const auto bytes = foot_bytes(foot, echoes.size(), has_signature ? 1 : 0);
  append_echoes(echoes, message);
  std::array<std::uint8_t, kSignatureBytes> signature{};
  const Bytes payload = Bytes(message).first(payload_bytes);
  const Bytes echo_bytes = Bytes(message).subspan(payload_bytes);
  if (has_signature) {
    const std::vector<std::uint8_t> text = signed_text(channel, {payload, echo_bytes, bytes});
    crypto_sign_ed25519_detached(signature.data(), nullptr, text.data(), text.size(),
                                 key.signing->bytes().data());
  }
  const Bytes used = Bytes(signature).first(has_signature ? signature.size() : 0);
  const Mac mac = mac_of(key.mac, channel, {payload, echo_bytes, used, bytes});
  message.insert(message.end(), used.begin(), used.end());
  message.insert(message.end(), mac.begin(), mac.end());
  message.insert(message.end(), bytes.begin(), bytes.end());
}

const ReplayGuard::Session* ReplayGuard::find(std::uint32_t key_id, std::uint64_t session) const {
  const auto known = std::find_if(sessions_.begin(), sessions_.end(), [&](const Session& each) {
    return each.session == session && each.key_id == key_id;
  });
  return known == sessions_.end() ? nullptr : &*known;
}

bool ReplayGuard::was_received(const Session& session, std::uint64_t counter) {
  return counter <= session.forgotten ||
         std::binary_search(session.seen.begin(), session.seen.end(), counter);
}

bool ReplayGuard::refuses(std::uint32_t key_id, std::uint64_t session,
                          std::uint64_t counter) const {
  const Session* const known = find(key_id, session);
  return known != nullptr && was_received(*known, counter);
}

bool ReplayGuard::admit(std::uint32_t key_id, std::uint64_t session, std::uint64_t counter) {
  ++uses_;
  auto known = std::find_if(sessions_.begin(), sessions_.end(), [&](const Session& each) {
    return each.session == session && each.key_id == key_id;
  });
  if (known == sessions_.end()) {
    if (sessions_.size() == kSessionsMax) {
      sessions_.erase(std::min_element(
          sessions_.begin(), sessions_.end(),
          [](const Session& a, const Session& b) { return a.used_last < b.used_last; }));
    }
    Session added;
    added.key_id = key_id;
    added.session = session;
    added.seen.reserve(kWindow + 1);
    known = sessions_.insert(sessions_.end(), std::move(added));
  }
  known->used_last = uses_;
  if (was_received(*known, counter)) {
    return false;
  }
  std::vector<std::uint64_t>& seen = known->seen;
  seen.insert(std::upper_bound(seen.begin(), seen.end(), counter), counter);
  if (seen.size() > kWindow) {
    known->forgotten = seen.front();
    seen.erase(seen.begin());
  }
  return true;
}

bool Budget::take(Time now) {
  if (last_take_ && now > *last_take_) {
    left_ = std::min(burst_, left_ + rate_per_s_ * to_seconds(now - *last_take_));
  }
  last_take_ = now;
  if (left_ < 1.0) {
    return false;
  }
  left_ -= 1.0;
  return true;
}

SignatureBudgets::VerifiedSender* SignatureBudgets::find(const Sender& sender) {
  const auto found =
      std::find_if(senders_.begin(), senders_.end(), [&](const VerifiedSender& each) {
        return each.sender.source == sender.source && each.sender.session == sender.session;
      });
  return found == senders_.end() ? nullptr : &*found;
}

SignatureBudgets::Host* SignatureBudgets::host_of(const Sender& sender, Time now) {
  const std::uint64_t address = sender.source >> 16U;  // address without the port
  const auto found = std::find_if(hosts_.begin(), hosts_.end(),
                                  [&](const Host& each) { return each.address == address; });
  Host* const host =
      found != hosts_.end() ? &*found : added(Host{address, host_, now}, hosts_, kHostsMax);
  if (host != nullptr) {
    host->received = now;
  }
  return host;
}

bool SignatureBudgets::take(const Sender& sender, bool is_stop, Time now) {
  const auto take_from = [is_stop, now](Rates& rates) {
    return (is_stop ? rates.stops : rates.orders).take(now);
  };
  // A sender that forges address and session is also limited by the other budgets.
  if (VerifiedSender* const verified = find(sender);
      verified != nullptr && take_from(verified->left)) {
    return true;
  }
  Host* const host = host_of(sender, now);
  return (host == nullptr || take_from(host->left)) && take_from(unverified_);
}

void SignatureBudgets::add_verified(const Sender& sender, Time now) {
  if (VerifiedSender* const verified = find(sender)) {
    verified->received = now;
  } else {
    added(VerifiedSender{sender, verified_, now}, senders_, kVerifiedMax);
  }
}

Verdict verify(const Keyring& keyring, std::string_view channel, Bytes message,
               const Expectation& expectation, ReplayGuard& replays, SignatureBudgets& budgets) {
  Verdict verdict;
  verdict.payload = message;
  verdict.parts = split(message);
  if (!verdict.parts) {
    verdict.refusal = Refusal::kUnsigned;
    return verdict;
  }
  verdict.payload = verdict.parts->payload;
  verdict.refusal = judge(keyring, channel, *verdict.parts, expectation, replays, budgets);
  return verdict;
}

Refusal judge_echo(const SignedParts& parts, std::uint32_t destination,
                   std::span<const std::uint64_t> nonces) {
  const std::optional<std::uint64_t> nonce = parts.echo_for(destination);
  if (!nonce) {
    return Refusal::kWrongDestination;
  }
  const bool is_valid = std::find(nonces.begin(), nonces.end(), *nonce) != nonces.end();
  return is_valid ? Refusal::kNone : Refusal::kWrongSession;
}

}  // namespace vantage::bus::auth

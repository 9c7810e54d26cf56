#include "wire/mavlink/signing.hpp"

#include <algorithm>

#include <sodium.h>

#include "core/check.hpp"

namespace vantage::wire::mavlink {
namespace {

constexpr std::int64_t kEpoch2015Utime = 1'420'070'400'000'000;
constexpr std::uint64_t kTimestampMax = (std::uint64_t{1} << 48U) - 1;
constexpr std::uint64_t kMinute10us = 6'000'000;

void start_sodium() {
  [[maybe_unused]] static const bool is_ready =
      (require(sodium_init() >= 0, "libsodium cannot be initialised"), true);
}

}  // namespace

std::uint64_t signing_timestamp_10us(Time time) {
  const std::int64_t since_us = std::max<std::int64_t>(0, to_utime(time) - kEpoch2015Utime);
  return std::min(static_cast<std::uint64_t>(since_us / 10), kTimestampMax);
}

void wipe(std::span<std::uint8_t> secret) { sodium_memzero(secret.data(), secret.size()); }

std::array<std::uint8_t, 6> truncated_signature(const SigningKey& key, const Frame& frame,
                                                std::uint8_t link_id,
                                                std::uint64_t timestamp_10us) {
  start_sodium();
  std::vector<std::uint8_t> bytes;
  append_unsigned_bytes(frame, bytes);
  bytes.push_back(link_id);
  for (unsigned i = 0; i < 6; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(timestamp_10us >> (8 * i)));
  }
  std::array<std::uint8_t, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  crypto_hash_sha256_update(&state, key.data(), key.size());
  crypto_hash_sha256_update(&state, bytes.data(), bytes.size());
  crypto_hash_sha256_final(&state, hash.data());
  sodium_memzero(&state, sizeof state);
  std::array<std::uint8_t, 6> out{};
  std::copy_n(hash.begin(), out.size(), out.begin());
  return out;
}

void Signer::sign(Frame& frame, Time now) {
  newest_10us_ = std::min(std::max(newest_10us_ + 1, signing_timestamp_10us(now)), kTimestampMax);
  frame.incompatible_flags |= kFlagSigned;
  frame.crc = crc_of(frame);
  frame.signature =
      Signature{link_id_, newest_10us_, truncated_signature(key_, frame, link_id_, newest_10us_)};
}

SignatureVerdict Signer::check(const Frame& frame, Time now) {
  if (!frame.signature) {
    return SignatureVerdict::kUnsigned;
  }
  const Signature& signature = *frame.signature;
  const std::array<std::uint8_t, 6> expected =
      truncated_signature(key_, frame, signature.link_id, signature.timestamp_10us);
  if (sodium_memcmp(expected.data(), signature.truncated.data(), expected.size()) != 0) {
    return SignatureVerdict::kWrong;
  }
  const Stream stream{frame.origin.system_id, frame.origin.component_id, signature.link_id};
  const auto known = streams_.find(stream);
  if (known != streams_.end()) {
    if (signature.timestamp_10us <= known->second) {
      return SignatureVerdict::kReplayed;
    }
    known->second = signature.timestamp_10us;
  } else {
    const std::uint64_t own_10us = std::max(newest_10us_, signing_timestamp_10us(now));
    if (signature.timestamp_10us + kMinute10us < own_10us) {
      return SignatureVerdict::kReplayed;
    }
    if (streams_.size() >= kStreamsMax) {
      return SignatureVerdict::kTooManyStreams;
    }
    streams_.emplace(stream, signature.timestamp_10us);
  }
  newest_10us_ = std::max(newest_10us_, signature.timestamp_10us);
  return SignatureVerdict::kGood;
}

}  // namespace vantage::wire::mavlink

#include "wire/mavlink/signing.hpp"

#include <gtest/gtest.h>

namespace vantage::wire::mavlink {
namespace {

constexpr Time kNow = from_utime(1'767'225'600'000'000);  // 2026-01-01
constexpr SigningKey kKey{1, 2, 3, 4, 5};

Frame heartbeat() { return pack(Heartbeat{0, 18, 8, 0, 4, 3}, {255, 191, 0}); }

TEST(SigningTimestamp, CountsTenMicrosecondsSince2015) {
  EXPECT_EQ(signing_timestamp_10us(from_utime(1'420'070'400'000'000)), 0U);
  EXPECT_EQ(signing_timestamp_10us(from_utime(1'420'070'401'000'000)), 100'000U);
  EXPECT_EQ(signing_timestamp_10us(from_utime(0)), 0U);
  EXPECT_EQ(signing_timestamp_10us(from_utime(9'000'000'000'000'000'000)), 0xFFFF'FFFF'FFFFU)
      << "the timestamp has 48 bits";
}

// Bytes of a signed HEARTBEAT, computed from the specification with Python's hashlib and a separate
// CRC. The signature is the first six bytes of sha256(key + header + payload + CRC + link id +
// timestamp).
TEST(Signer, WritesTheReferenceBytes) {
  SigningKey key{};
  for (std::size_t i = 0; i < key.size(); ++i) {
    key[i] = static_cast<std::uint8_t>(i);
  }
  Frame frame = heartbeat();
  Signer(key, 7).sign(frame, kNow);
  std::vector<std::uint8_t> bytes;
  append_bytes(frame, bytes);
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{0xfd, 0x09, 0x01, 0x00, 0x00, 0xff, 0xbf, 0x00, 0x00,
                                              0x00, 0x00, 0x00, 0x00, 0x00, 0x12, 0x08, 0x00, 0x04,
                                              0x03, 0x2c, 0x9c, 0x07, 0x00, 0xe0, 0x3c, 0xd6, 0x92,
                                              0x1f, 0xa4, 0x16, 0x74, 0x12, 0x03, 0x2d}));
}

TEST(Signer, AcceptsItsPeersSignature) {
  Signer sender(kKey, 3);
  Signer receiver(kKey, 4);
  for (int i = 0; i < 10; ++i) {  // also if no time passes
    Frame frame = heartbeat();
    sender.sign(frame, kNow);
    EXPECT_EQ(frame.signature->link_id, 3);
    EXPECT_EQ(receiver.check(frame, kNow), SignatureVerdict::kGood);
  }
}

TEST(Signer, RefusesAnotherKeyAndAnyChange) {
  Signer sender(kKey, 3);
  Frame frame = heartbeat();
  sender.sign(frame, kNow);
  SigningKey other = kKey;
  other[31] ^= 1;
  EXPECT_EQ(Signer(other, 0).check(frame, kNow), SignatureVerdict::kWrong);
  const auto expect_wrong = [](const Frame& changed) {
    EXPECT_EQ(Signer(kKey, 0).check(changed, kNow), SignatureVerdict::kWrong);
  };
  Frame changed = frame;
  changed.payload[0] ^= 1;
  expect_wrong(changed);
  changed = frame;
  changed.origin.sequence ^= 1;
  expect_wrong(changed);
  changed = frame;
  changed.signature->link_id ^= 1;
  expect_wrong(changed);
  changed = frame;
  changed.signature->timestamp_10us += 1;
  expect_wrong(changed);
  EXPECT_EQ(Signer(kKey, 0).check(heartbeat(), kNow), SignatureVerdict::kUnsigned);
}

TEST(Signer, RefusesReplays) {
  Signer sender(kKey, 3);
  Signer receiver(kKey, 0);
  Frame first = heartbeat();
  Frame second = heartbeat();
  sender.sign(first, kNow);
  sender.sign(second, kNow);
  EXPECT_EQ(receiver.check(second, kNow), SignatureVerdict::kGood);
  EXPECT_EQ(receiver.check(second, kNow), SignatureVerdict::kReplayed);
  EXPECT_EQ(receiver.check(first, kNow), SignatureVerdict::kReplayed);
}

TEST(Signer, RefusesOlderTimestampsOfAStream) {
  Signer sender(kKey, 3);
  Signer receiver(kKey, 0);
  std::vector<Frame> frames(5, heartbeat());
  for (Frame& frame : frames) {
    sender.sign(frame, kNow);
  }
  for (const Frame& frame : frames) {
    EXPECT_EQ(receiver.check(frame, kNow), SignatureVerdict::kGood);
  }
  for (const Frame& frame : frames) {
    EXPECT_EQ(receiver.check(frame, kNow), SignatureVerdict::kReplayed);
  }
}

// A stream is identified by system, component and link. The timestamps of different streams are
// independent.
TEST(Signer, TracksTimestampsPerStream) {
  Signer receiver(kKey, 0);
  const auto check = [&](std::uint8_t system, std::uint8_t component, std::uint8_t link,
                         std::chrono::seconds late) {
    Frame frame = pack(Heartbeat{0, 18, 8, 0, 4, 3}, {system, component, 0});
    Signer(kKey, link).sign(frame, kNow - late);
    return receiver.check(frame, kNow);
  };
  using std::chrono::seconds;
  EXPECT_EQ(check(1, 1, 1, seconds(0)), SignatureVerdict::kGood);
  EXPECT_EQ(check(1, 1, 2, seconds(10)), SignatureVerdict::kGood);
  EXPECT_EQ(check(1, 2, 1, seconds(20)), SignatureVerdict::kGood);
  EXPECT_EQ(check(2, 1, 1, seconds(30)), SignatureVerdict::kGood);
  EXPECT_EQ(check(1, 1, 1, seconds(5)), SignatureVerdict::kReplayed);
  EXPECT_EQ(check(1, 1, 2, seconds(5)), SignatureVerdict::kGood);
  EXPECT_EQ(check(1, 2, 1, seconds(15)), SignatureVerdict::kGood);
  EXPECT_EQ(check(2, 1, 1, seconds(25)), SignatureVerdict::kGood);
}

TEST(Signer, RefusesANewStreamOneMinuteBehind) {
  Signer sender(kKey, 3);
  Frame frame = heartbeat();
  sender.sign(frame, kNow);
  EXPECT_EQ(Signer(kKey, 0).check(frame, kNow + std::chrono::seconds(60)), SignatureVerdict::kGood);
  EXPECT_EQ(Signer(kKey, 0).check(frame, kNow + std::chrono::seconds(60) + Duration{10}),
            SignatureVerdict::kReplayed);
}

// Even if its clock is behind, a signer signs with a later timestamp than the newest frame from its
// peer, and refuses a new stream one minute behind this frame.
TEST(Signer, SignsWithALaterTimestampThanItsPeer) {
  Signer peer(kKey, 3);
  Signer ours(kKey, 3);  // same link, clock one hour behind
  const Time behind = kNow - std::chrono::hours(1);
  for (int time = 0; time < 3; ++time) {
    Frame theirs = heartbeat();
    peer.sign(theirs, kNow + std::chrono::seconds(time));
    ASSERT_EQ(ours.check(theirs, behind), SignatureVerdict::kGood);
    Frame own = heartbeat();
    ours.sign(own, behind);
    EXPECT_EQ(own.signature->timestamp_10us, theirs.signature->timestamp_10us + 1);
  }
  Signer third(kKey, 9);
  Frame old = heartbeat();
  third.sign(old, kNow - std::chrono::seconds(61));
  EXPECT_EQ(ours.check(old, behind), SignatureVerdict::kReplayed);
}

TEST(Signer, TimestampsIncreaseForAnyClock) {
  Signer signer(kKey, 3);
  std::uint64_t last_10us = 0;
  for (const int seconds : {0, 0, 5, -10, -10, 6}) {
    Frame frame = heartbeat();
    signer.sign(frame, kNow + std::chrono::seconds(seconds));
    EXPECT_GT(frame.signature->timestamp_10us, last_10us) << seconds;
    EXPECT_GE(frame.signature->timestamp_10us,
              signing_timestamp_10us(kNow + std::chrono::seconds(seconds)));
    last_10us = frame.signature->timestamp_10us;
  }
}

TEST(Signer, KeepsABoundedNumberOfStreams) {
  Signer receiver(kKey, 0);
  for (int link = 0; link < 256; ++link) {
    Signer sender(kKey, static_cast<std::uint8_t>(link));
    Frame frame = heartbeat();
    sender.sign(frame, kNow);
    EXPECT_EQ(receiver.check(frame, kNow),
              link < 64 ? SignatureVerdict::kGood : SignatureVerdict::kTooManyStreams);
  }
}

}  // namespace
}  // namespace vantage::wire::mavlink

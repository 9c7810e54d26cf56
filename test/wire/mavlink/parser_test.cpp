#include "wire/mavlink/parser.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "test/wire/mavlink/hex.hpp"
#include "test/wire/mavlink/random_message.hpp"
#include "wire/mavlink/signing.hpp"

namespace vantage::wire::mavlink {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const Frame& frame) {
  Bytes bytes;
  append_bytes(frame, bytes);
  return bytes;
}

std::vector<Frame> frames_in(Parser& parser, const Bytes& bytes) {
  std::vector<Frame> frames;
  parser.feed(bytes, [&frames](const Frame& frame) { frames.push_back(frame); });
  return frames;
}

Frame attitude_frame(std::uint8_t sequence) {
  Attitude attitude;
  attitude.time_boot_ms = 1000U + sequence;
  attitude.yawspeed = 0.25F;
  return pack(attitude, {1, 1, sequence});
}

/// Returns a frame of an unknown message with all payload bytes equal to `fill`.
Bytes unknown_frame(std::uint8_t fill) {
  constexpr std::array<std::uint8_t, 10> kHeader{kMarkerV2, 20, 0, 0, 9, 1, 1, 0x50, 0xC3, 0};
  Bytes bytes(kHeader.size() + 22, fill);
  std::ranges::copy(kHeader, bytes.begin());
  return bytes;
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }

TEST(Parser, ReturnsAFrameWithItsLastByte) {
  Parser parser;
  std::mt19937_64 rng(2);
  test::for_each_message([&]<class Message>() {
    const Frame sent = pack(test::random_message<Message>(rng), {7, 8, 9});
    const Bytes bytes = bytes_of(sent);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      const std::vector<Frame> frames = frames_in(parser, {bytes[i]});
      ASSERT_EQ(frames.size(), i + 1 == bytes.size() ? 1U : 0U) << Message::kMessage.name;
      if (!frames.empty()) {
        EXPECT_EQ(frames[0].message_id, sent.message_id);
        EXPECT_EQ(frames[0].origin, sent.origin);
        EXPECT_EQ(frames[0].payload, sent.payload);
      }
    }
  });
  EXPECT_EQ(parser.counts().bytes_skipped, 0);
}

TEST(Parser, FindsEveryFrameInNoiseWithoutMarkers) {
  std::mt19937_64 rng(3);
  Bytes stream;
  std::size_t noise = 0;
  for (int i = 0; i < 200; ++i) {
    for (std::size_t n = rng() % 40; n > 0; --n, ++noise) {
      stream.push_back(static_cast<std::uint8_t>(rng() % 250));
    }
    append(stream, bytes_of(attitude_frame(static_cast<std::uint8_t>(i))));
  }
  Parser parser;
  EXPECT_EQ(frames_in(parser, stream).size(), 200U);
  EXPECT_EQ(parser.counts().frames, 200);
  EXPECT_EQ(parser.counts().frames_v1, 0);
  EXPECT_EQ(parser.counts().bytes_skipped, static_cast<std::int64_t>(noise));
}

TEST(Parser, FindsAFrameAfterATruncatedOne) {
  Bytes torn = bytes_of(attitude_frame(0));
  for (std::size_t length = 1; length < torn.size(); ++length) {
    Bytes stream(torn.begin(), torn.begin() + static_cast<std::ptrdiff_t>(length));
    for (std::uint8_t i = 1; i <= 3; ++i) {
      append(stream, bytes_of(attitude_frame(i)));
    }
    Parser parser;
    std::vector<Frame> frames = frames_in(parser, stream);
    parser.flush([&frames](const Frame& frame) { frames.push_back(frame); });
    ASSERT_EQ(frames.size(), 3U) << length << " bytes of the torn one";
    EXPECT_EQ(frames[0].origin.sequence, 1);
  }
}

TEST(Parser, RefusesAnyFlippedBit) {
  const Bytes good = bytes_of(attitude_frame(0));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<std::uint8_t>(bad[bit / 8] ^ (1U << (bit % 8)));
    Parser parser;
    EXPECT_TRUE(frames_in(parser, bad).empty()) << "bit " << bit;
    std::size_t found = 0;
    parser.flush([&found](const Frame&) { ++found; });
    EXPECT_EQ(found, 0U);
  }
}

TEST(Parser, CountsUnknownMessagesAndContinues) {
  Parser parser;
  Bytes stream = unknown_frame(0xFD);  // the payload consists of frame markers
  append(stream, bytes_of(attitude_frame(1)));
  append(stream, unknown_frame(0));
  EXPECT_EQ(frames_in(parser, stream).size(), 1U);
  EXPECT_EQ(parser.counts().unknown, 2);
  EXPECT_EQ(parser.counts().bytes_skipped, 0);
}

TEST(Parser, DropsFramesWithIncompatibleFlags) {
  Frame frame = attitude_frame(1);
  frame.incompatible_flags = 0x02;
  frame.crc = crc_of(frame);
  Parser parser;
  EXPECT_TRUE(frames_in(parser, bytes_of(frame)).empty());
  EXPECT_EQ(parser.counts().unknown_flags, 1);
  frame.incompatible_flags = 0;
  frame.compatible_flags = 0xFF;
  frame.crc = crc_of(frame);
  EXPECT_EQ(frames_in(parser, bytes_of(frame)).size(), 1U);
}

TEST(Parser, RecognisesVersionOne) {
  Frame frame = pack(Heartbeat{4, 2, 3, 128, 4, 3}, {1, 1, 200});
  frame.is_v1 = true;
  frame.payload_size = 9;
  frame.crc = crc_of(frame);
  const Bytes bytes = bytes_of(frame);
  // The expected bytes were computed manually: marker, length, sequence, system, component, id,
  // payload.
  EXPECT_EQ(test::hex_of_bytes(bytes).substr(0, 30), "fe09c8010100040000000203800403");
  EXPECT_EQ(bytes.size(), 17U);
  Parser parser;
  const std::vector<Frame> frames = frames_in(parser, bytes);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].is_v1);
  EXPECT_EQ(parser.counts().frames_v1, 1);
  const auto heartbeat = unpack<Heartbeat>(frames[0]);
  ASSERT_TRUE(heartbeat.has_value());
  EXPECT_EQ(heartbeat->custom_mode, 4U);
  EXPECT_EQ(heartbeat->base_mode, 128);
}

// Version 1 has its sequence number at the position at which version 2 has its flags. Version 1 is
// never signed.
TEST(Parser, ReadsEverySequenceNumberOfVersionOne) {
  Parser parser;
  for (int sequence = 0; sequence < 256; ++sequence) {
    Frame frame = pack(Heartbeat{4, 2, 3, 128, 4, 3}, {7, 8, static_cast<std::uint8_t>(sequence)});
    frame.is_v1 = true;
    frame.crc = crc_of(frame);
    const std::vector<Frame> frames = frames_in(parser, bytes_of(frame));
    ASSERT_EQ(frames.size(), 1U) << sequence;
    EXPECT_EQ(frames[0].origin, frame.origin);
    EXPECT_FALSE(frames[0].signature.has_value());
  }
  EXPECT_EQ(parser.counts().frames_v1, 256);
}

TEST(Parser, ReadsSignedFrames) {
  const SigningKey key{1, 2, 3};
  const Time now = from_utime(1'767'225'600'123'450);
  Signer sender(key, 7);
  Signer receiver(key, 0);
  Parser parser;
  std::mt19937_64 rng(6);
  test::for_each_message([&]<class Message>() {
    Frame sent = pack(test::random_message<Message>(rng), {9, 8, 7});
    sender.sign(sent, now);
    const Bytes bytes = bytes_of(sent);
    ASSERT_EQ(bytes.size(), 10U + sent.payload_size + 2 + 13);
    EXPECT_TRUE(frames_in(parser, {bytes.begin(), bytes.end() - 1}).empty());
    const std::vector<Frame> frames = frames_in(parser, {bytes.back()});
    ASSERT_EQ(frames.size(), 1U) << Message::kMessage.name;
    ASSERT_TRUE(frames[0].signature.has_value());
    EXPECT_EQ(frames[0].signature->link_id, 7);
    EXPECT_EQ(frames[0].signature->timestamp_10us, sent.signature->timestamp_10us);
    EXPECT_EQ(frames[0].signature->truncated, sent.signature->truncated);
    EXPECT_EQ(receiver.check(frames[0], now), SignatureVerdict::kGood);
  });
  EXPECT_EQ(parser.counts().bytes_skipped, 0);
}

// A frame with an unknown checksum seed is accepted only if another frame follows it.
TEST(Parser, TreatsAnUnknownMessageAsNoiseIfNoFrameFollows) {
  Parser parser;
  Bytes stream = unknown_frame(0);
  stream.push_back(0x55);
  append(stream, bytes_of(attitude_frame(1)));
  EXPECT_EQ(frames_in(parser, stream).size(), 1U);
  EXPECT_EQ(parser.counts().unknown, 0);
  EXPECT_EQ(parser.counts().bytes_skipped, 33);
}

TEST(Parser, FindsFramesAfterAFalseMarkerAtTheDatagramsEnd) {
  Bytes datagram{kMarkerV2, 200, 0, 0, 0, 1, 1, 30, 0, 0};
  append(datagram, bytes_of(attitude_frame(5)));
  Parser parser;
  EXPECT_TRUE(frames_in(parser, datagram).empty());
  std::vector<Frame> frames;
  parser.flush([&frames](const Frame& frame) { frames.push_back(frame); });
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].origin.sequence, 5);
  EXPECT_EQ(frames_in(parser, bytes_of(attitude_frame(6))).size(), 1U);
}

TEST(Parser, AccountsForEveryByte) {
  std::mt19937_64 rng(4);
  Parser parser;
  std::int64_t fed = 0;
  std::int64_t consumed = 0;
  const auto consume = [&consumed](const Frame& frame) {
    consumed += (frame.is_v1 ? 8 : 12) + frame.payload_size + (frame.signature ? 13 : 0);
  };
  Bytes chunk;
  for (int i = 0; i < 200'000; ++i) {
    chunk.clear();
    switch (rng() % 4) {
      case 0:  // a valid frame
        append(chunk, bytes_of(pack(test::random_message<Odometry>(rng), {1, 1, 0})));
        break;
      case 1:  // a frame with a few bytes changed
        append(chunk, bytes_of(pack(test::random_message<BatteryStatus>(rng), {1, 1, 0})));
        for (int n = 0; n < 3; ++n) {
          chunk[rng() % chunk.size()] = static_cast<std::uint8_t>(rng());
        }
        break;
      case 2:  // a part of a frame
        append(chunk, bytes_of(attitude_frame(0)));
        chunk.resize(rng() % chunk.size());
        break;
      default:  // noise with many markers
        for (std::size_t n = rng() % 64; n > 0; --n) {
          const auto byte = static_cast<std::uint8_t>(rng());
          chunk.push_back(byte < 64 ? (byte < 32 ? kMarkerV1 : kMarkerV2) : byte);
        }
    }
    fed += static_cast<std::int64_t>(chunk.size());
    parser.feed(chunk, consume);
  }
  parser.flush(consume);
  // Frames of unknown messages are consumed but not returned.
  EXPECT_LE(parser.counts().bytes_skipped + consumed, fed);
  EXPECT_GE(parser.counts().bytes_skipped + consumed + 280 * parser.counts().unknown, fed);
  EXPECT_GT(parser.counts().frames, 40'000);
  EXPECT_EQ(frames_in(parser, bytes_of(attitude_frame(6))).size(), 1U);
}

TEST(SequenceMonitor, CountsGapsPerSenderAcrossTheWrap) {
  SequenceMonitor monitor;
  for (int i = 250; i < 260; ++i) {
    monitor.on_frame({1, 1, static_cast<std::uint8_t>(i)});
    monitor.on_frame({2, 1, 0});  // another sender, with a repeated number
  }
  EXPECT_EQ(monitor.lost(), 0);
  EXPECT_EQ(monitor.out_of_order(), 9);
  monitor.on_frame({1, 1, 9});  // numbers 4 … 8 are missing
  EXPECT_EQ(monitor.lost(), 5);
  monitor.on_frame({1, 1, 6});
  EXPECT_EQ(monitor.out_of_order(), 10);
  monitor.on_frame({1, 1, 10});
  EXPECT_EQ(monitor.lost(), 5);
}

TEST(SequenceMonitor, CountsStepsBelowHalfTheRangeAsLoss) {
  for (int start = 0; start < 256; start += 51) {
    for (int step = 1; step < 256; ++step) {
      SequenceMonitor monitor;
      monitor.on_frame({1, 1, static_cast<std::uint8_t>(start)});
      monitor.on_frame({1, 1, static_cast<std::uint8_t>(start + step)});
      EXPECT_EQ(monitor.lost(), step <= 128 ? step - 1 : 0) << step;
      EXPECT_EQ(monitor.out_of_order(), step <= 128 ? 0 : 1) << step;
    }
  }
}

TEST(SequenceMonitor, TracksSixtyFourSenders) {
  SequenceMonitor monitor;
  for (int round = 0; round < 2; ++round) {
    for (int sender = 0; sender < 80; ++sender) {  // each has another system and component pair
      monitor.on_frame({static_cast<std::uint8_t>(sender / 9),
                        static_cast<std::uint8_t>(sender % 9),
                        static_cast<std::uint8_t>(sender + 3 * round)});
    }
  }
  EXPECT_EQ(monitor.lost(), 64 * 2);
  EXPECT_EQ(monitor.out_of_order(), 0);
}

}  // namespace
}  // namespace vantage::wire::mavlink

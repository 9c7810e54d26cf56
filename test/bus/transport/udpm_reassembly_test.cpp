#include "bus/transport/udpm_reassembly.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace vantage::bus::udpm {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::int64_t kSecondNs = 1'000'000'000;

/// A message cut into fragments of any size, as the parser returns them.
class Message {
 public:
  Message(std::uint32_t sequence, std::size_t bytes, std::size_t piece_bytes, unsigned seed = 1)
      : sequence_(sequence), piece_bytes_(piece_bytes), payload_(bytes) {
    std::mt19937 rng(seed);
    std::generate(payload_.begin(), payload_.end(),
                  [&] { return static_cast<std::uint8_t>(rng()); });
  }
  [[nodiscard]] std::uint16_t count() const {
    return static_cast<std::uint16_t>((payload_.size() + piece_bytes_ - 1) / piece_bytes_);
  }
  [[nodiscard]] Packet piece(std::uint16_t number) const {
    const std::size_t offset = number * piece_bytes_;
    Packet packet;
    packet.is_fragment = true;
    packet.sequence = sequence_;
    packet.message_bytes = static_cast<std::uint32_t>(payload_.size());
    packet.fragment_offset = static_cast<std::uint32_t>(offset);
    packet.fragment_number = number;
    packet.fragment_count = count();
    packet.channel = number == 0 ? "T" : "";
    packet.payload =
        std::span(payload_).subspan(offset, std::min(piece_bytes_, payload_.size() - offset));
    return packet;
  }
  [[nodiscard]] const Bytes& payload() const { return payload_; }

 private:
  std::uint32_t sequence_;
  std::size_t piece_bytes_;
  Bytes payload_;
};

TEST(Reassembler, AcceptsFragmentsInAnyOrder) {
  std::mt19937 rng(3);
  for (std::uint32_t trial = 0; trial < 100; ++trial) {
    Reassembler reassembler;
    const Message message(trial, 1'000 + trial * 7, 100, trial);
    std::vector<std::uint16_t> order(message.count());
    for (std::uint16_t i = 0; i < message.count(); ++i) {
      order[i] = i;
    }
    std::shuffle(order.begin(), order.end(), rng);
    for (std::size_t i = 0; i + 1 < order.size(); ++i) {
      ASSERT_FALSE(reassembler.add(1, message.piece(order[i]), 0).has_value());
    }
    const auto whole = reassembler.add(1, message.piece(order.back()), 0);
    ASSERT_TRUE(whole.has_value());
    EXPECT_EQ(whole->channel, "T");
    EXPECT_EQ(whole->source, 1U);
    EXPECT_EQ(whole->payload, message.payload());
    EXPECT_EQ(reassembler.counts().completed, 1);
    EXPECT_EQ(reassembler.bytes_kept(), 0U);
  }
}

TEST(Reassembler, IgnoresDuplicates) {
  Reassembler reassembler;
  const Message message(1, 200, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value())
      << "a repeated fragment does not complete the message";
  const auto whole = reassembler.add(1, message.piece(1), 0);
  ASSERT_TRUE(whole.has_value());
  EXPECT_EQ(whole->payload, message.payload());
  EXPECT_FALSE(reassembler.add(1, message.piece(1), 0).has_value()) << "late duplicate";
  EXPECT_EQ(reassembler.messages_kept(), 0U) << "a late duplicate starts no new message";
  EXPECT_EQ(reassembler.counts().duplicates, 2);
  EXPECT_EQ(reassembler.counts().incomplete, 0);
}

TEST(Reassembler, SeparatesSendersAndMessages) {
  Reassembler reassembler;
  const Message a(1, 200, 100, 1);
  const Message b(1, 200, 100, 2);
  const Message c(2, 200, 100, 3);
  EXPECT_FALSE(reassembler.add(1, a.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(2, b.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, c.piece(0), 0).has_value());
  EXPECT_EQ(reassembler.add(1, a.piece(1), 0)->payload, a.payload());
  EXPECT_EQ(reassembler.add(2, b.piece(1), 0)->payload, b.payload());
  EXPECT_EQ(reassembler.add(1, c.piece(1), 0)->payload, c.payload());
  EXPECT_EQ(reassembler.counts().conflicting, 0);
  EXPECT_EQ(reassembler.counts().completed, 3);
}

TEST(Reassembler, DropsAndCountsIncompleteMessages) {
  Reassembler reassembler;
  const Message message(1, 200, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  reassembler.expire(kSecondNs);
  EXPECT_EQ(reassembler.messages_kept(), 1U);
  reassembler.expire(kSecondNs + 1);
  EXPECT_EQ(reassembler.messages_kept(), 0U);
  EXPECT_EQ(reassembler.bytes_kept(), 0U);
  EXPECT_EQ(reassembler.counts().incomplete, 1);
}

TEST(Reassembler, MeasuresAgeFromTheNewestFragment) {
  Reassembler reassembler;
  const Message message(1, 300, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 5 * kSecondNs).has_value());
  EXPECT_FALSE(reassembler.add(1, message.piece(1), 6 * kSecondNs).has_value());
  reassembler.expire(7 * kSecondNs);
  EXPECT_EQ(reassembler.messages_kept(), 1U);
  EXPECT_TRUE(reassembler.add(1, message.piece(2), 7 * kSecondNs).has_value());
}

TEST(Reassembler, DropsOnlyTheMessagesThatAreTooOld) {
  Reassembler reassembler;
  for (std::uint32_t i = 0; i < 5; ++i) {
    const Message message(i, 200, 100);
    EXPECT_FALSE(reassembler.add(1, message.piece(0), i * kSecondNs / 4).has_value());
  }
  reassembler.expire(kSecondNs + kSecondNs / 4 + 1);
  EXPECT_EQ(reassembler.messages_kept(), 3U);
  EXPECT_EQ(reassembler.counts().incomplete, 2);
  const Message last(2, 200, 100);
  EXPECT_TRUE(reassembler.add(1, last.piece(1), 2 * kSecondNs).has_value());
}

// The newest 256 completed messages are remembered for one second; repeated fragments of them do
// not start a new message.
TEST(Reassembler, RecognisesDuplicatesOfTheNewest256ForOneSecond) {
  for (const std::uint32_t messages : {1U, 256U, 257U, 600U}) {
    Reassembler reassembler;
    for (std::uint32_t i = 0; i < messages; ++i) {
      EXPECT_TRUE(reassembler.add(1, Message(i, 50, 50).piece(0), 10).has_value());
    }
    const std::uint32_t known = std::min(messages, 256U);
    for (std::uint32_t i = messages - known; i < messages; ++i) {
      EXPECT_FALSE(reassembler.add(1, Message(i, 50, 50).piece(0), 10 + kSecondNs).has_value());
    }
    EXPECT_EQ(reassembler.counts().duplicates, known) << messages;
    EXPECT_EQ(reassembler.counts().completed, messages);
    if (messages > known) {
      EXPECT_TRUE(reassembler.add(1, Message(messages - known - 1, 50, 50).piece(0), 20))
          << "the message before the remembered ones";
    }
    EXPECT_TRUE(reassembler.add(1, Message(messages - 1, 50, 50).piece(0), 11 + kSecondNs))
        << "another message with that number, a second later";
  }
}

TEST(Reassembler, AcceptsAReusedSequenceNumberLater) {
  Reassembler reassembler;
  const Message first(1, 200, 100, 1);
  const Message second(1, 200, 100, 2);
  EXPECT_FALSE(reassembler.add(1, first.piece(0), 0).has_value());
  EXPECT_TRUE(reassembler.add(1, first.piece(1), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, second.piece(0), 2 * kSecondNs).has_value());
  EXPECT_EQ(reassembler.add(1, second.piece(1), 2 * kSecondNs)->payload, second.payload());
}

TEST(Reassembler, RefusesFragmentsThatContradictTheirMessage) {
  Reassembler reassembler;
  const Message message(1, 200, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  Packet liar = message.piece(1);
  liar.message_bytes = 300;
  EXPECT_FALSE(reassembler.add(1, liar, 0).has_value());
  EXPECT_EQ(reassembler.counts().conflicting, 1);
  EXPECT_EQ(reassembler.add(1, message.piece(1), 0)->payload, message.payload()) << "not affected";
}

TEST(Reassembler, DistinguishesDuplicatesFromContradictions) {
  Reassembler reassembler;
  const Message message(1, 300, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, message.piece(1), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, message.piece(1), 0).has_value());
  EXPECT_EQ(reassembler.counts().duplicates, 1);
  EXPECT_EQ(reassembler.counts().conflicting, 0);
  Packet elsewhere = message.piece(1);
  elsewhere.fragment_offset += 1;
  EXPECT_FALSE(reassembler.add(1, elsewhere, 0).has_value());
  EXPECT_EQ(reassembler.counts().conflicting, 1);
  Packet other = message.piece(1);
  other.payload = message.piece(2).payload;
  EXPECT_FALSE(reassembler.add(1, other, 0).has_value());
  other.payload = message.piece(1).payload.first(99);
  EXPECT_FALSE(reassembler.add(1, other, 0).has_value());
  EXPECT_EQ(reassembler.counts().conflicting, 3);
  EXPECT_EQ(reassembler.counts().duplicates, 1);
  EXPECT_EQ(reassembler.add(1, message.piece(2), 0)->payload, message.payload());
}

TEST(Reassembler, RefusesShortMessages) {
  Reassembler reassembler;
  const Message message(1, 200, 100);
  Packet shorter = message.piece(1);
  shorter.payload = shorter.payload.first(99);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, shorter, 0).has_value());
  EXPECT_EQ(reassembler.counts().conflicting, 1);
  EXPECT_EQ(reassembler.messages_kept(), 0U);
}

TEST(Reassembler, RefusesFragmentsThatOverlap) {
  Reassembler reassembler;
  const Message message(1, 200, 100);
  Packet overlapping = message.piece(1);
  overlapping.fragment_offset = 50;
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, overlapping, 0).has_value());
  EXPECT_EQ(reassembler.counts().conflicting, 1);
  EXPECT_EQ(reassembler.counts().completed, 0);
  EXPECT_EQ(reassembler.bytes_kept(), 0U);
}

TEST(Reassembler, RefusesMessagesAboveTheSizeLimit) {
  Reassembler reassembler({.message_bytes_max = 1000});
  const Message message(1, 1001, 100);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_EQ(reassembler.counts().oversized, 1);
  EXPECT_EQ(reassembler.bytes_kept(), 0U);
  EXPECT_FALSE(reassembler.add(1, Message(2, 1000, 100).piece(0), 0).has_value());
  EXPECT_EQ(reassembler.counts().oversized, 1) << "the size limit itself is accepted";
  EXPECT_EQ(reassembler.messages_kept(), 1U);
  EXPECT_FALSE(reassembler.add(1, Message(3, 5'000, 100).piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, Message(3, 5'000, 100).piece(1), 0).has_value());
  EXPECT_EQ(reassembler.counts().oversized, 3) << "fragments";
  ASSERT_EQ(reassembler.oversized().size(), 1U);
  const auto& [channel, refused] = *reassembler.oversized().begin();
  EXPECT_EQ(channel, message.piece(0).channel);
  EXPECT_EQ(refused.messages, 2);
  EXPECT_EQ(refused.bytes_max, 5'000U);
}

TEST(Reassembler, KeepsTheStatedMemoryLimit) {
  const ReassemblyLimits limits;
  EXPECT_EQ(limits.message_bytes_max, 4U * 1024U * 1024U);
  EXPECT_EQ(limits.source_bytes_max, 8U * 1024U * 1024U);
  EXPECT_EQ(limits.total_bytes_max, 32U * 1024U * 1024U);
  EXPECT_EQ(limits.messages_max, 256U);
  EXPECT_EQ(limits.age_max_ns, kSecondNs);
}

TEST(Reassembler, AllocatesOnlyForReceivedBytes) {
  Reassembler reassembler;
  const Message little(1, 10, 10);
  Packet claim = little.piece(0);
  claim.message_bytes = 4U << 20U;
  claim.fragment_count = 65;
  EXPECT_FALSE(reassembler.add(1, claim, 0).has_value());
  EXPECT_LT(reassembler.bytes_kept(), 1000U);
}

TEST(Reassembler, LimitsEachSenderToItsShare) {
  const ReassemblyLimits limits{.source_bytes_max = 10'000};
  Reassembler reassembler(limits);
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Message message(i, 3'000, 1'500);
    EXPECT_FALSE(reassembler.add(1, message.piece(0), i).has_value());
    EXPECT_LE(reassembler.bytes_kept(), limits.source_bytes_max);
  }
  EXPECT_EQ(reassembler.counts().incomplete,
            100 - static_cast<std::int64_t>(reassembler.messages_kept()));
}

// Up to 16 incomplete messages are stored. When another arrives, the two that grew last are kept.
// The one with the fewest bytes among the other 14 is dropped; if several have equally few, the
// oldest of them. The result is compared with a plain list.
TEST(Reassembler, DropsTheLeastCompleteMessageExceptTheNewestEighth) {
  struct Held {
    std::uint32_t sequence;
    std::size_t bytes;
  };
  std::mt19937 rng(17);
  for (int trial = 0; trial < 20; ++trial) {
    Reassembler reassembler({.messages_max = 16});
    std::vector<Held> held;  // ordered by last growth, newest last
    std::int64_t given_up = 0;
    for (std::uint32_t sequence = 0; sequence < 200; ++sequence) {
      if (!held.empty() && rng() % 3 == 0) {  // one more fragment of a stored message
        const auto at = held.begin() + static_cast<std::ptrdiff_t>(rng() % held.size());
        const Message message(at->sequence, 3'000, 1'000);
        if (at->bytes < 1'000) {
          EXPECT_FALSE(reassembler.add(1, message.piece(1), 0).has_value());
          at->bytes += 1'000;
          std::rotate(at, at + 1, held.end());
        }
      }
      const Message message(sequence, 3'000, 1'000);
      Packet first = message.piece(0);
      first.payload = first.payload.first(1 + rng() % 10);
      if (held.size() == 16) {
        held.erase(std::min_element(held.begin(), held.end() - 2, [](const Held& a, const Held& b) {
          return a.bytes < b.bytes;
        }));
        ++given_up;
      }
      held.push_back({sequence, first.payload.size()});
      EXPECT_FALSE(reassembler.add(1, first, 0).has_value());
      ASSERT_EQ(reassembler.messages_kept(), held.size());
      ASSERT_EQ(reassembler.counts().incomplete, given_up);
    }
    // The first fragment of each stored message is recognised as a duplicate.
    for (const Held& each : held) {
      const std::int64_t before =
          reassembler.counts().duplicates + reassembler.counts().conflicting;
      const Message message(each.sequence, 3'000, 1'000);
      EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
      ASSERT_EQ(reassembler.counts().duplicates + reassembler.counts().conflicting, before + 1)
          << each.sequence;
    }
  }
}

// A message that alone exceeds its sender's limit is dropped; messages of other senders are kept.
TEST(Reassembler, DropsAMessageBeyondItsSendersShare) {
  Reassembler reassembler({.source_bytes_max = 10'000});
  const Message others(1, 9'000, 4'500);
  EXPECT_FALSE(reassembler.add(2, others.piece(0), 0).has_value());
  const Message message(1, 20'000, 4'000);
  EXPECT_FALSE(reassembler.add(1, message.piece(0), 0).has_value());
  EXPECT_FALSE(reassembler.add(1, message.piece(1), 0).has_value());
  EXPECT_EQ(reassembler.messages_kept(), 2U);
  EXPECT_FALSE(reassembler.add(1, message.piece(2), 0).has_value());
  EXPECT_EQ(reassembler.messages_kept(), 1U);
  EXPECT_EQ(reassembler.counts().incomplete, 1);
  const Message at_once(2, 30'000, 15'000);
  EXPECT_FALSE(reassembler.add(1, at_once.piece(0), 0).has_value());
  EXPECT_EQ(reassembler.messages_kept(), 1U);
  EXPECT_EQ(reassembler.counts().incomplete, 2);
  EXPECT_EQ(reassembler.add(2, others.piece(1), 0)->payload, others.payload());
  EXPECT_EQ(reassembler.bytes_kept(), 0U);
}

TEST(Reassembler, LimitsAllSendersTogether) {
  const ReassemblyLimits limits{.source_bytes_max = 10'000, .total_bytes_max = 30'000};
  Reassembler reassembler(limits);
  for (std::uint64_t source = 0; source < 50; ++source) {
    EXPECT_FALSE(reassembler.add(source, Message(1, 8'000, 4'000).piece(0), 0).has_value());
    EXPECT_LE(reassembler.bytes_kept(), limits.total_bytes_max);
  }
  EXPECT_GE(reassembler.messages_kept(), 6U) << "messages of 4 kB each, with little overhead";
}

// Memory is charged by what arrived: per fragment its bytes and an overhead allowance; per message
// an overhead allowance and one bit per fragment.
TEST(Reassembler, CountsMemoryForFragmentsAndMessageSize) {
  Reassembler reassembler;
  const Message message(1, 8'000, 10);
  std::size_t before = 0;
  std::vector<std::size_t> charged;
  for (std::uint16_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(reassembler.add(1, message.piece(i), 0).has_value());
    charged.push_back(reassembler.bytes_kept() - before);
    before = reassembler.bytes_kept();
  }
  EXPECT_EQ(charged[1], 10U + 128U) << "64 bytes, in a vector whose capacity doubles";
  EXPECT_EQ(charged[2], charged[1]);
  EXPECT_EQ(charged[3], charged[1]);
  EXPECT_EQ(charged[0], charged[1] + 256U + message.count() / 8U);
}

// 100 000 first fragments, each from a new sender, arrive between the two halves of a genuine
// message.
TEST(Reassembler, CompletesMessagesDuringAFloodOfFirstFragments) {
  const ReassemblyLimits limits;
  Reassembler reassembler(limits);
  const Message good(1, 100'000, 50'000);
  EXPECT_FALSE(reassembler.add(7, good.piece(0), 0).has_value());
  const Message claim(9, 200, 100);
  for (std::uint64_t source = 1'000; source < 101'000; ++source) {
    EXPECT_FALSE(reassembler.add(source, claim.piece(0), 1).has_value());
  }
  EXPECT_LE(reassembler.messages_kept(), limits.messages_max);
  EXPECT_EQ(reassembler.add(7, good.piece(1), 2)->payload, good.payload());
}

// Nearly complete messages, each from a new sender, arrive between the fragments of a genuine
// message, which therefore has the fewest bytes.
TEST(Reassembler, CompletesMessagesDuringAFloodOfIncompleteOnes) {
  Reassembler reassembler;
  std::uint64_t stranger = 1'000;
  std::int64_t now_ns = 0;
  const auto flood = [&](int messages) {
    const Message claim(9, 150'000, 50'000);
    for (int i = 0; i < messages; ++i, ++stranger) {
      EXPECT_FALSE(reassembler.add(stranger, claim.piece(0), ++now_ns).has_value());
      EXPECT_FALSE(reassembler.add(stranger, claim.piece(1), ++now_ns).has_value());
    }
  };
  flood(1'000);
  for (std::uint32_t i = 0; i < 50; ++i) {
    const Message good(i, 200'000, 50'000, i);
    for (std::uint16_t k = 0; k < 3; ++k) {
      EXPECT_FALSE(reassembler.add(7, good.piece(k), ++now_ns).has_value());
      flood(10);
    }
    const auto message = reassembler.add(7, good.piece(3), ++now_ns);
    ASSERT_TRUE(message.has_value()) << i;
    EXPECT_EQ(message->payload, good.payload());
  }
}

// An attacker that uses the sender's address and next number, but another size or count, does not
// destroy the sender's message.
TEST(Reassembler, SeparatesAMessageFromAForgeryOfItsNumber) {
  Reassembler reassembler;
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Message good(i, 300, 100, i);
    const Message shorter(i, 200, 100, 99);
    const Message whole(i, 50, 50, 98);
    EXPECT_FALSE(reassembler.add(7, shorter.piece(0), i).has_value());
    EXPECT_TRUE(reassembler.add(7, whole.piece(0), i).has_value()) << "a separate message";
    EXPECT_FALSE(reassembler.add(7, good.piece(0), i).has_value());
    EXPECT_FALSE(reassembler.add(7, good.piece(1), i).has_value());
    const auto message = reassembler.add(7, good.piece(2), i);
    ASSERT_TRUE(message.has_value()) << i;
    EXPECT_EQ(message->payload, good.payload());
  }
  EXPECT_GT(reassembler.counts().conflicting, 0);
}

// If the attacker also uses the same size and count, only that message is destroyed, and the
// conflict is counted.
TEST(Reassembler, LosesOnlyTheForgedMessage) {
  Reassembler reassembler;
  const Message forged(0, 300, 100, 99);
  EXPECT_FALSE(reassembler.add(7, forged.piece(1), 0).has_value());
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Message good(i, 300, 100, i + 1);
    EXPECT_FALSE(reassembler.add(7, good.piece(0), i).has_value());
    EXPECT_FALSE(reassembler.add(7, good.piece(1), i).has_value());
    const auto message = reassembler.add(7, good.piece(2), i);
    EXPECT_EQ(message.has_value() && message->payload == good.payload(), i > 0);
  }
  EXPECT_EQ(reassembler.counts().conflicting, 1);
}

TEST(Reassembler, StaysWithinItsLimitsUnderRandomFragments) {
  const ReassemblyLimits limits{.message_bytes_max = 5'000,
                                .source_bytes_max = 8'000,
                                .total_bytes_max = 40'000,
                                .messages_max = 20};
  Reassembler reassembler(limits);
  std::mt19937_64 rng(5);
  const Bytes bytes(3'000);
  std::int64_t fragments = 0;
  for (std::int64_t i = 0; i < 100'000; ++i) {
    Packet packet;
    packet.is_fragment = true;
    packet.sequence = static_cast<std::uint32_t>(rng() % 4);
    packet.message_bytes = static_cast<std::uint32_t>(1 + rng() % 6'000);
    packet.fragment_count =
        static_cast<std::uint16_t>(1 + rng() % std::min<std::uint64_t>(4, packet.message_bytes));
    packet.fragment_number = static_cast<std::uint16_t>(rng() % packet.fragment_count);
    packet.fragment_offset = static_cast<std::uint32_t>(rng() % packet.message_bytes);
    const std::size_t room = packet.message_bytes - packet.fragment_offset;
    packet.payload = std::span(bytes).first(1 + rng() % std::min<std::size_t>(room, bytes.size()));
    packet.channel = packet.fragment_number == 0 ? "T" : "";
    const auto message = reassembler.add(rng() % 12, packet, i * 1'000'000);
    ++fragments;
    if (message) {
      ASSERT_LE(message->payload.size(), limits.message_bytes_max);
    }
    ASSERT_LE(reassembler.bytes_kept(), limits.total_bytes_max);
    ASSERT_LE(reassembler.messages_kept(), limits.messages_max);
    if (i % 100 == 0) {
      reassembler.expire(i * 1'000'000);
    }
  }
  const ReassemblyCounts& counts = reassembler.counts();
  EXPECT_GT(counts.completed, 0);
  EXPECT_GT(counts.incomplete, 0);
  EXPECT_GT(counts.oversized, 0);
  reassembler.expire(std::int64_t{1} << 60);
  EXPECT_EQ(reassembler.bytes_kept(), 0U) << "all memory has been released";
}

}  // namespace
}  // namespace vantage::bus::udpm

#include "logs/file/log_event.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace vantage::logs {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(BigEndian, RoundTripsInEveryWidth) {
  constexpr std::uint64_t kValue = 0x0102030405060708U;
  for (std::size_t width = 1; width <= 8; ++width) {
    Bytes bytes{0xFF};
    append_big_endian(kValue, width, bytes);
    ASSERT_EQ(bytes.size(), 1 + width);
    for (std::size_t i = 0; i < width; ++i) {
      EXPECT_EQ(bytes[1 + i], 8 - width + i + 1) << "the last bytes, highest first";
    }
    EXPECT_EQ(read_big_endian(bytes.data() + 1, width),
              width == 8 ? kValue : kValue & ((std::uint64_t{1} << (8 * width)) - 1));
  }
}

// The bytes equal those that LCM's eventlog.c writes.
TEST(AppendEvent, WritesEventsLikeLcm) {
  Bytes bytes;
  append_event({0x0102, from_utime(0x030405), "AB", Bytes{7, 8, 9}}, bytes);
  EXPECT_EQ(bytes, (Bytes{0xED, 0xA1, 0xDA, 0x01, 0, 0, 0, 0, 0, 0, 1, 2,   0,   0, 0, 0, 0,
                          3,    4,    5,    0,    0, 0, 2, 0, 0, 0, 3, 'A', 'B', 7, 8, 9}));
  EXPECT_EQ(event_bytes_at(bytes, 0), bytes.size());
}

TEST(IsEventChannel, AcceptsTextWithoutControlCharacters) {
  EXPECT_FALSE(is_event_channel(""));
  EXPECT_TRUE(is_event_channel(std::string(63, 'A')));
  EXPECT_FALSE(is_event_channel(std::string(64, 'A')));
  for (int byte = 0; byte < 256; ++byte) {
    const std::string no_text{static_cast<char>(0xFF), static_cast<char>(byte)};
    const bool is_control = byte < 0x20 || byte == 0x7F;
    EXPECT_EQ(is_event_channel(no_text), !is_control) << byte;
    if (byte > 0 && byte < 0x80) {
      EXPECT_TRUE(is_event_channel(std::string(1, static_cast<char>(byte)))) << byte;
    }
  }
}

TEST(FindSync, ReturnsTheNextSyncWord) {
  Bytes bytes(20, 0xED);
  const Bytes word{0xED, 0xA1, 0xDA, 0x01};
  for (const std::size_t at : {3U, 16U}) {
    std::copy(word.begin(), word.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
  EXPECT_EQ(find_sync(bytes, 0), 3U);
  EXPECT_EQ(find_sync(bytes, 3), 3U);
  EXPECT_EQ(find_sync(bytes, 4), 16U);
  EXPECT_EQ(find_sync(bytes, 16), 16U);
  for (const std::size_t from : {17U, 19U, 20U, 21U, 1000U}) {
    EXPECT_EQ(find_sync(bytes, from), 20U) << from;
  }
  bytes.pop_back();  // removes the last byte
  EXPECT_EQ(find_sync(bytes, 4), 19U);
}

TEST(EventAt, AcceptsValuesUpToTheirLimits) {
  for (const std::size_t name : {std::size_t{1}, kChannelBytesMax}) {
    for (const std::int64_t number : {std::int64_t{0}, INT64_MAX}) {
      Bytes bytes;
      append_event({number, from_utime(number), std::string(name, 'A'), {}}, bytes);
      ASSERT_EQ(bytes.size(), kEventHeaderBytes + name);
      const auto event = event_at(bytes, 0);
      ASSERT_TRUE(event) << name << " " << number;
      EXPECT_EQ(event->number, number);
      EXPECT_EQ(to_utime(event->time), number);
      EXPECT_EQ(event->channel.size(), name);
      EXPECT_TRUE(event->data.empty());
      bytes.pop_back();
      EXPECT_FALSE(event_at(bytes, 0));
    }
  }
  Bytes bytes;
  append_event({1, from_utime(2), "ABC", Bytes{5, 6}}, bytes);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(event_at(std::span(bytes).first(size), 0)) << size;
  }
  EXPECT_TRUE(event_at(bytes, 0));
}

TEST(WholeEvents, EndWithinTheWrittenBytes) {
  Bytes events;
  std::vector<std::size_t> ends{0};
  for (const std::size_t data : {3U, 0U, 5U}) {
    append_event({1, from_utime(2), "ABC", Bytes(data, 1)}, events);
    ends.push_back(events.size());
  }
  for (std::size_t written = 0; written <= events.size() + 1; ++written) {
    const WholeEvents whole = whole_events(events, written);
    std::size_t expected = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      expected = ends[i] <= written ? i : expected;
    }
    EXPECT_EQ(whole.bytes, ends[expected]) << written;
    EXPECT_EQ(whole.events_beyond, 3 - static_cast<std::int64_t>(expected)) << written;
  }
  EXPECT_EQ(whole_events({}, 0).events_beyond, 0);
}

}  // namespace
}  // namespace vantage::logs

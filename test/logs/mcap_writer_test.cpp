// Checks every number of every record of a written MCAP file against the specification
// (mcap.dev/spec), including numbers that readers normally ignore.

#include "logs/export/mcap_writer.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <zstd.h>

#include "logs/export/crc32.hpp"
#include "test/logs/file_support.hpp"

namespace vantage::logs {
namespace {

/// Reads little-endian numbers and length-prefixed text in sequence.
class Reader {
 public:
  explicit Reader(std::string_view left) : left_(left) {}
  std::uint64_t number(std::size_t width) {
    std::uint64_t out = 0;
    const std::string_view bytes = take(width);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      out |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    }
    return out;
  }
  std::string_view text(std::size_t width = 4) { return take(number(width)); }
  std::string_view rest() { return take(left_.size()); }
  [[nodiscard]] bool is_empty() const { return left_.empty(); }

 private:
  std::string_view take(std::size_t size) {
    if (size > left_.size()) {
      ADD_FAILURE() << "the record ends too early";
      return "";
    }
    const std::string_view out = left_.substr(0, size);
    left_.remove_prefix(size);
    return out;
  }
  std::string_view left_;
};

struct Record {
  std::uint8_t opcode = 0;
  std::uint64_t offset = 0;
  std::uint64_t size = 0;  ///< bytes, with opcode and length
  std::string_view content;
};

std::vector<Record> records_of(std::string_view bytes, std::uint64_t offset) {
  std::vector<Record> out;
  Reader in(bytes);
  while (!in.is_empty() && !::testing::Test::HasFailure()) {
    Record record;
    record.opcode = static_cast<std::uint8_t>(in.number(1));
    record.offset = offset;
    record.content = in.text(8);
    record.size = 9 + record.content.size();
    offset += record.size;
    out.push_back(record);
  }
  return out;
}

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
enum Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kStatistics = 11,
  kSummaryOffset = 14,
  kDataEnd = 15
};

struct Written {
  std::uint16_t topic = 0;
  std::int64_t logged = 0;
  std::int64_t published = 0;
  std::string message;
};

/// Writes `count` messages of about 1 kB on three topics with two schemas, not in the order of
/// their times.
std::vector<Written> write_file(const std::string& path, int count) {
  McapWriter writer(path, {"a profile", "an encoding", "a schema language"});
  const std::uint16_t topics[] = {writer.topic("/a", "A", "text of A"),
                                  writer.topic("/b", "B", "text of B"),
                                  writer.topic("/c", "A", "another text")};
  EXPECT_EQ(writer.topic("/b", "B", "text of B"), topics[1]);
  std::vector<Written> out;
  for (int i = 0; i < count; ++i) {
    const std::int64_t logged = 1'700'000'000'000'000 + 1'000 * i - (i % 5 == 3 ? 3'500 : 0);
    out.push_back({topics[i % 7 == 0 ? 2 : i % 2], logged, logged - 250,
                   std::to_string(i) + std::string(1'000, 'x')});
    writer.write(out.back().topic, from_utime(out.back().logged), from_utime(out.back().published),
                 out.back().message);
  }
  EXPECT_EQ(writer.messages(), static_cast<std::uint64_t>(count));
  EXPECT_TRUE(writer.finish());
  EXPECT_TRUE(writer.finish()) << "a second call has no effect";
  return out;
}

class McapFile : public ::testing::Test {
 protected:
  void read(int count) {
    written_ = write_file(folder_.file("a.mcap"), count);
    const test::Bytes bytes = test::read_file(folder_.file("a.mcap"));
    bytes_.assign(bytes.begin(), bytes.end());
    const std::string_view all = bytes_;
    ASSERT_EQ(all.substr(0, 8), kMagic);
    ASSERT_EQ(all.substr(all.size() - 8), kMagic);
    records_ = records_of(all.substr(8, all.size() - 16), 8);
  }
  [[nodiscard]] std::vector<Record> of(std::uint8_t opcode) const {
    std::vector<Record> out;
    for (const Record& record : records_) {
      if (record.opcode == opcode) {
        out.push_back(record);
      }
    }
    return out;
  }
  static std::string unpacked(std::string_view packed, std::uint64_t size) {
    std::string out(size, ' ');
    EXPECT_EQ(ZSTD_decompress(out.data(), out.size(), packed.data(), packed.size()), size);
    return out;
  }
  static void expect_schema(const Record& record, std::uint64_t id, std::string_view name,
                            std::string_view text) {
    Reader in(record.content);
    EXPECT_EQ(in.number(2), id);
    EXPECT_EQ(in.text(), name);
    EXPECT_EQ(in.text(), "a schema language");
    EXPECT_EQ(in.text(), text);
    EXPECT_TRUE(in.is_empty());
  }
  static void expect_channel(const Record& record, std::uint64_t id, std::uint64_t schema,
                             std::string_view name) {
    Reader in(record.content);
    EXPECT_EQ(in.number(2), id);
    EXPECT_EQ(in.number(2), schema);
    EXPECT_EQ(in.text(), name);
    EXPECT_EQ(in.text(), "an encoding");
    EXPECT_EQ(in.number(4), 0U) << "no metadata";
    EXPECT_TRUE(in.is_empty());
  }

  test::TemporaryFolder folder_;
  std::vector<Written> written_;
  std::string bytes_;
  std::vector<Record> records_;
};

TEST_F(McapFile, HasCorrectChunkIndexes) {
  read(2'500);
  const auto chunks = of(kChunk);
  const auto chunk_indexes = of(kChunkIndex);
  ASSERT_EQ(chunks.size(), 3U) << "chunks of one mebibyte";
  ASSERT_EQ(chunk_indexes.size(), 3U);
  std::size_t next = 0;
  std::map<std::uint64_t, std::uint64_t> sent;  // by topic
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    Reader chunk(chunks[c].content);
    const std::uint64_t first_ns = chunk.number(8);
    const std::uint64_t last_ns = chunk.number(8);
    const std::uint64_t size = chunk.number(8);
    const std::uint64_t crc = chunk.number(4);
    EXPECT_EQ(chunk.text(), "zstd");
    const std::string_view packed = chunk.text(8);
    EXPECT_TRUE(chunk.is_empty());
    const std::string content = unpacked(packed, size);
    EXPECT_EQ(crc, crc32(content));
    EXPECT_EQ(size >= 1U << 20U, c < 2);
    EXPECT_LT(size, (1U << 20U) + 1'100U) << "at most one message above the limit";
    std::uint64_t least_ns = ~std::uint64_t{0};
    std::uint64_t most_ns = 0;
    using Entry = std::tuple<std::uint64_t, std::uint64_t, std::uint64_t>;  // topic, time, offset
    std::vector<Entry> entries;
    std::vector<Record> described;
    for (const Record& record : records_of(content, 0)) {
      if (record.opcode != kMessage) {
        described.push_back(record);
        continue;
      }
      ASSERT_LT(next, written_.size());
      const Written& wanted = written_[next++];
      Reader in(record.content);
      EXPECT_EQ(in.number(2), wanted.topic);
      EXPECT_EQ(in.number(4), sent[wanted.topic]++) << "counted by topic";
      const std::uint64_t logged_ns = in.number(8);
      EXPECT_EQ(logged_ns, static_cast<std::uint64_t>(wanted.logged) * 1'000);
      EXPECT_EQ(in.number(8), static_cast<std::uint64_t>(wanted.published) * 1'000);
      EXPECT_EQ(in.rest(), wanted.message);
      least_ns = std::min(least_ns, logged_ns);
      most_ns = std::max(most_ns, logged_ns);
      entries.emplace_back(wanted.topic, logged_ns, record.offset);
    }
    EXPECT_EQ(first_ns, least_ns);
    EXPECT_EQ(last_ns, most_ns);
    ASSERT_EQ(described.size(), c == 0 ? 5U : 0U)
        << "each schema and topic is described before its first message";
    if (c == 0) {
      expect_schema(described[0], 1, "A", "text of A");
      expect_channel(described[1], 0, 1, "/a");
      expect_schema(described[2], 2, "B", "text of B");
      expect_channel(described[3], 1, 2, "/b");
      expect_channel(described[4], 2, 1, "/c");
    }

    Reader index(chunk_indexes[c].content);
    EXPECT_EQ(index.number(8), first_ns);
    EXPECT_EQ(index.number(8), last_ns);
    EXPECT_EQ(index.number(8), chunks[c].offset);
    EXPECT_EQ(index.number(8), chunks[c].size);
    Reader offsets(index.text());
    const std::uint64_t index_bytes = index.number(8);
    EXPECT_EQ(index.text(), "zstd");
    EXPECT_EQ(index.number(8), packed.size());
    EXPECT_EQ(index.number(8), size);
    EXPECT_TRUE(index.is_empty());
    std::vector<Entry> indexed;
    std::uint64_t bytes = 0;
    while (!offsets.is_empty()) {
      const std::uint64_t topic = offsets.number(2);
      const std::uint64_t offset = offsets.number(8);
      EXPECT_EQ(offset, chunks[c].offset + chunks[c].size + bytes) << "one index follows the other";
      Reader at(std::string_view(bytes_).substr(offset));
      EXPECT_EQ(at.number(1), kMessageIndex);
      Reader content_of(at.text(8));
      EXPECT_EQ(content_of.number(2), topic);
      Reader list(content_of.text());
      EXPECT_TRUE(content_of.is_empty());
      std::uint64_t entries_here = 0;
      for (; !list.is_empty(); ++entries_here) {
        const std::uint64_t time_ns = list.number(8);
        indexed.emplace_back(topic, time_ns, list.number(8));
      }
      bytes += 9 + 2 + 4 + 16 * entries_here;
    }
    EXPECT_EQ(index_bytes, bytes);
    std::sort(entries.begin(), entries.end());
    std::sort(indexed.begin(), indexed.end());
    EXPECT_EQ(indexed, entries);
  }
  EXPECT_EQ(next, written_.size());
}

TEST_F(McapFile, EndsWithASummary) {
  read(2'500);
  Reader header(records_.front().content);
  EXPECT_EQ(records_.front().opcode, kHeader);
  EXPECT_EQ(header.text(), "a profile");
  EXPECT_EQ(header.text(), "vantage");
  EXPECT_TRUE(header.is_empty());

  const Record data_end = of(kDataEnd).at(0);
  Reader end(data_end.content);
  EXPECT_EQ(end.number(4), crc32(std::string_view(bytes_).substr(0, data_end.offset)));
  const std::uint64_t summary_start = data_end.offset + data_end.size;
  std::map<std::uint8_t, std::pair<std::uint64_t, std::uint64_t>> groups;  // offset, length
  std::vector<Record> summary;
  for (const Record& record : records_) {
    if (record.offset < summary_start || record.opcode == kSummaryOffset ||
        record.opcode == kFooter) {
      continue;
    }
    summary.push_back(record);
    auto& [at, size] = groups.try_emplace(record.opcode, record.offset, 0U).first->second;
    EXPECT_EQ(record.offset, at + size) << "records of a group are contiguous";
    size += record.size;
  }
  ASSERT_EQ(summary.size(), 2U + 3U + 1U + 3U);
  expect_schema(summary[0], 1, "A", "text of A");
  expect_schema(summary[1], 2, "B", "text of B");
  expect_channel(summary[2], 0, 1, "/a");
  expect_channel(summary[3], 1, 2, "/b");
  expect_channel(summary[4], 2, 1, "/c");

  const auto offsets = of(kSummaryOffset);
  ASSERT_EQ(offsets.size(), groups.size());
  for (const Record& each : offsets) {
    Reader in(each.content);
    const auto& [at, size] = groups.at(static_cast<std::uint8_t>(in.number(1)));
    EXPECT_EQ(in.number(8), at);
    EXPECT_EQ(in.number(8), size);
    EXPECT_TRUE(in.is_empty());
  }
  const Record last = of(kFooter).at(0);
  Reader footer(last.content);
  EXPECT_EQ(footer.number(8), summary_start);
  EXPECT_EQ(footer.number(8), offsets.front().offset);
  EXPECT_EQ(footer.number(4), crc32(std::string_view(bytes_).substr(
                                  summary_start, last.offset + 9 + 16 - summary_start)));
  EXPECT_TRUE(footer.is_empty());
  EXPECT_EQ(last.offset + last.size + kMagic.size(), bytes_.size());
}

TEST_F(McapFile, HasCorrectStatistics) {
  for (const int count : {0, 1, 2'500}) {
    read(count);
    std::uint64_t first_ns = count == 0 ? 0 : ~std::uint64_t{0};
    std::uint64_t last_ns = 0;
    std::map<std::uint64_t, std::uint64_t> by_topic{{0, 0}, {1, 0}, {2, 0}};
    for (const Written& each : written_) {
      first_ns = std::min(first_ns, static_cast<std::uint64_t>(each.logged) * 1'000);
      last_ns = std::max(last_ns, static_cast<std::uint64_t>(each.logged) * 1'000);
      ++by_topic[each.topic];
    }
    Reader in(of(kStatistics).at(0).content);
    EXPECT_EQ(in.number(8), static_cast<std::uint64_t>(count));
    EXPECT_EQ(in.number(2), 2U) << "schemas";
    EXPECT_EQ(in.number(4), 3U) << "topics";
    EXPECT_EQ(in.number(4), 0U) << "attachments";
    EXPECT_EQ(in.number(4), 0U) << "metadata";
    EXPECT_EQ(in.number(4), of(kChunk).size());
    EXPECT_EQ(in.number(8), first_ns);
    EXPECT_EQ(in.number(8), last_ns);
    Reader counts(in.text());
    EXPECT_TRUE(in.is_empty());
    for (const auto& [topic, messages] : by_topic) {
      EXPECT_EQ(counts.number(2), topic);
      EXPECT_EQ(counts.number(8), messages);
    }
    EXPECT_TRUE(counts.is_empty());
  }
}

// A user's detector may stamp with −1, or in nanoseconds.
TEST(McapWriter, ClampsTimesToTheFormatsRange) {
  const test::TemporaryFolder folder;
  constexpr std::int64_t kMost_ns = std::numeric_limits<std::int64_t>::max();
  const std::pair<std::int64_t, std::int64_t> cases[] = {
      {-5'000'000, 0},
      {std::numeric_limits<std::int64_t>::min(), 0},
      {0, 0},
      {1'700'000'000'000'000, 1'700'000'000'000'000'000},
      {1'700'000'000'000'000'000, kMost_ns},
      {std::numeric_limits<std::int64_t>::max(), kMost_ns}};
  McapWriter writer(folder.file("a.mcap"));
  const auto topic = writer.topic("/a", "A", "{}");
  for (const auto& [utime, wanted_ns] : cases) {
    writer.write(topic, from_utime(utime), from_utime(utime), "{}");
  }
  ASSERT_TRUE(writer.finish());
  const test::Bytes bytes = test::read_file(folder.file("a.mcap"));
  const std::string_view all(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::vector<std::uint64_t> written_ns;
  for (const Record& record : records_of(all.substr(8, all.size() - 16), 8)) {
    if (record.opcode == kChunk) {
      Reader chunk(record.content);
      chunk.number(16);
      const std::uint64_t size = chunk.number(8);
      chunk.number(4);
      chunk.text();
      std::string content(size, ' ');
      const std::string_view packed = chunk.text(8);
      ZSTD_decompress(content.data(), size, packed.data(), packed.size());
      for (const Record& message : records_of(content, 0)) {
        if (message.opcode == kMessage) {
          Reader in(message.content);
          in.number(6);
          written_ns.push_back(in.number(8));
        }
      }
    }
  }
  ASSERT_EQ(written_ns.size(), std::size(cases));
  for (std::size_t i = 0; i < written_ns.size(); ++i) {
    EXPECT_EQ(written_ns[i], static_cast<std::uint64_t>(cases[i].second)) << cases[i].first;
  }
}

TEST(McapWriter, RefusesTooManyTopics) {
  const test::TemporaryFolder folder;
  McapWriter writer(folder.file("a.mcap"));
  for (int i = 0; i < 65'535; ++i) {
    EXPECT_EQ(writer.topic(std::to_string(i), "A", "{}"), i);
  }
  EXPECT_EQ(writer.failure(), "");
  writer.topic("one more", "A", "{}");
  EXPECT_NE(writer.failure().find("--channels"), std::string::npos) << writer.failure();
  EXPECT_FALSE(writer.finish());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace vantage::logs

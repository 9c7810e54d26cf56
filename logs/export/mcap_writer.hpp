#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace vantage::logs {

/// What the messages of an MCAP file are, all alike.
struct McapEncoding {
  std::string profile;  ///< what a reader may count on; "ros2"
  std::string message = "json";
  std::string schema = "jsonschema";
};

/// Writes an MCAP file of messages in one encoding: chunks (compressed with zstd) with their
/// indexes, a summary with schemas, channels, statistics and chunk index, checksums throughout; so
/// viewers can seek in it. It has another name, PATH.part, until it is whole; one that cannot be
/// written is not left. Source: the MCAP format specification, mcap.dev/spec.
class McapWriter {
 public:
  /// @throws StartupError "PATH: cannot be written: REASON".
  explicit McapWriter(const std::string& path, McapEncoding encoding = {});
  /// Finishes the file if finish() was not called.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;
  McapWriter(McapWriter&&) = delete;
  McapWriter& operator=(McapWriter&&) = delete;

  /// Returns a new topic, or the one of that name. Topics with equal `schema_name` share the first
  /// one's `schema_text`. Beyond 65,535 topics nothing more is written, see failure().
  std::uint16_t topic(const std::string& name, const std::string& schema_name,
                      const std::string& schema_text);
  /// `topic`: an answer of topic().
  void write(std::uint16_t topic, Time logged, Time published, std::string_view message);
  /// Writes what is pending and the summary, and gives the file its name. False when not all could
  /// be written; failure() says why.
  bool finish();
  /// "PATH: cannot be written: REASON"; empty while all could.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  /// Messages with a time before 1970 or after 2262, which is written as the nearest in between.
  [[nodiscard]] std::int64_t times_held() const { return times_held_; }

 private:
  struct Schema {
    std::string name;
    std::string text;
  };
  struct Topic {
    std::string name;
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
  };
  /// Of the chunk in hand: per topic, (time, offset in the chunk) of each message.
  using ChunkTimes = std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;
  struct TimeSpan {
    std::uint64_t first_ns = 0;
    std::uint64_t last_ns = 0;
    bool is_empty = true;
    void add(std::uint64_t time_ns);
  };

  void put(std::string_view bytes);
  void close_chunk();
  std::string schema_record(std::size_t index) const;
  std::string topic_record(std::size_t index) const;
  std::string statistics_record() const;

  void fail(const std::string& why);

  struct Compressor;
  std::string path_;
  McapEncoding encoding_;
  std::string failure_;
  std::unique_ptr<Compressor> compressor_;
  std::ofstream out_;
  std::uint64_t written_bytes_ = 0;
  std::uint32_t data_crc_ = 0;
  std::vector<Schema> schemas_;               ///< ids from 1
  std::vector<Topic> topics_;                 ///< ids from 0
  std::map<std::string, std::uint16_t> ids_;  ///< of topics, by name
  std::string chunk_;
  ChunkTimes chunk_times_;
  TimeSpan chunk_span_;
  TimeSpan span_;
  std::vector<std::string> chunk_index_records_;
  std::uint64_t messages_ = 0;
  std::int64_t times_held_ = 0;
  bool is_finished_ = false;
};

}  // namespace vantage::logs

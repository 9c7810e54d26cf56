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

/// Encoding of all messages of an MCAP file.
struct McapEncoding {
  std::string profile;  ///< profile of the MCAP file, such as "ros2"
  std::string message = "json";
  std::string schema = "jsonschema";
};

/// Writer of an MCAP file with messages in one encoding. The file has zstd-compressed chunks with
/// indexes, a summary with schemas, channels, statistics and chunk index, and checksums throughout,
/// so viewers can seek in it. It is named PATH.part until it is complete; an incomplete file is
/// deleted. Source: the MCAP format specification, mcap.dev/spec.
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

  /// Returns the topic `name`, which is added if it is new. Topics with equal `schema_name` share
  /// the first one's `schema_text`. Beyond 65,535 topics nothing more is written, see failure().
  std::uint16_t topic(const std::string& name, const std::string& schema_name,
                      const std::string& schema_text);
  /// Appends a message. `topic` must be a result of topic().
  void write(std::uint16_t topic, Time logged, Time published, std::string_view message);
  /// Writes pending data and the summary, and renames the file. Returns false if not everything
  /// could be written; failure() contains the reason.
  bool finish();
  /// Returns "PATH: cannot be written: REASON"; empty without an error.
  [[nodiscard]] const std::string& failure() const { return failure_; }
  [[nodiscard]] std::uint64_t messages() const { return messages_; }
  /// Returns the number of messages with a time before 1970 or after 2262, which was clamped.
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
  /// Index of the current chunk: (time, offset in the chunk) of each message, by topic.
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
  std::vector<Schema> schemas_;               ///< the schema at index i has the id i + 1
  std::vector<Topic> topics_;                 ///< the topic at index i has the id i
  std::map<std::string, std::uint16_t> ids_;  ///< topic ids by name
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

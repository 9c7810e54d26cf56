#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

#include "logs/foxglove/stream.hpp"

namespace vantage::tools {

/// Filter in front of a Sink for the messages before a seek position, which are played twice. The
/// first pass counts the records of each topic; the second pass makes only the last record of each
/// topic, because viewers see no other record. Making a record costs many times as much as counting
/// it. Both passes handle all messages.
class SeekPreroll : public logs::foxglove::Sink {
 public:
  explicit SeekPreroll(logs::foxglove::Sink& audience) : audience_(audience) {}

  /// Begins the first pass: counts records and makes none.
  void count() {
    stage_ = Stage::kCounts;
    left_.clear();
  }
  /// Begins the second pass over the same records: calls the audience's wants() for each, and
  /// passes on the last record of each topic.
  void make_last() { stage_ = Stage::kMakesLast; }
  /// Ends the second pass: all further records are passed on.
  void end() { stage_ = Stage::kPassesOn; }

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override {
    if (stage_ == Stage::kCounts) {
      ++left_[topic];
      return false;
    }
    const bool is_made = stage_ == Stage::kPassesOn || --left_[topic] <= 0;
    return audience_.wants(topic, schema, is_state) && is_made;
  }

  void write(const std::string& topic, Time time, const logs::foxglove::Json& content) override {
    audience_.write(topic, time, content);
  }

  void name_type(const std::string& topic, const std::string& type) override {
    if (stage_ != Stage::kCounts) {
      audience_.name_type(topic, type);
    }
  }

 private:
  enum class Stage : std::uint8_t { kPassesOn, kCounts, kMakesLast };

  logs::foxglove::Sink& audience_;
  Stage stage_ = Stage::kPassesOn;
  std::unordered_map<std::string, std::int64_t> left_;  ///< number of remaining records, by topic
};

}  // namespace vantage::tools

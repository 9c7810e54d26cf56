#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

#include "logs/foxglove/stream.hpp"

namespace vantage::tools {

/// Stands before a Sink while what led up to an instant is played to it, twice and alike: first the
/// records of each topic are counted, then of each only the last is made. Making a record costs
/// many times what is needed to know that there is one, and of what led up to an instant only the
/// last of each topic is seen. Whatever the records are made from is heard in full both times.
class LeadUp : public logs::foxglove::Sink {
 public:
  explicit LeadUp(logs::foxglove::Sink& audience) : audience_(audience) {}

  /// From now on records are counted, and none is made.
  void count() {
    stage_ = Stage::kCounts;
    left_.clear();
  }
  /// From now on the same records come again: the audience is asked whether it wants each, as if it
  /// heard all, and gets the last of a topic.
  void tell() { stage_ = Stage::kTellsTheLast; }
  /// From now on everything is passed on.
  void end() { stage_ = Stage::kPassesOn; }

  bool wants(const std::string& topic, logs::foxglove::Schema schema, bool is_state) override {
    if (stage_ == Stage::kCounts) {
      ++left_[topic];
      return false;
    }
    const bool is_told = stage_ == Stage::kPassesOn || --left_[topic] <= 0;
    return audience_.wants(topic, schema, is_state) && is_told;
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
  enum class Stage : std::uint8_t { kPassesOn, kCounts, kTellsTheLast };

  logs::foxglove::Sink& audience_;
  Stage stage_ = Stage::kPassesOn;
  std::unordered_map<std::string, std::int64_t> left_;  ///< records still to come, by topic
};

}  // namespace vantage::tools

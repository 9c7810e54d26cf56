#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/stream.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::logs::foxglove {

/// A sink that stores all records, except topics that the test refuses.
class Notebook : public Sink {
 public:
  struct Record {
    std::string topic;
    Time time;
    Json content;
  };
  bool wants(const std::string& topic, Schema schema, bool /*is_state*/) override {
    const auto [entry, is_new] = schemas.try_emplace(topic, schema);
    EXPECT_EQ(entry->second, schema) << topic << " has two schemas";
    return !refused.contains(topic);
  }
  void write(const std::string& topic, Time time, const Json& content) override {
    records.push_back({topic, time, content});
  }
  [[nodiscard]] std::vector<Json> of(const std::string& topic) const {
    std::vector<Json> out;
    for (const Record& record : records) {
      if (record.topic == topic) {
        out.push_back(record.content);
      }
    }
    return out;
  }

  std::map<std::string, Schema> schemas;
  std::set<std::string> refused;
  std::vector<Record> records;
};

inline scenario::Scenario lab() {
  return scenario::load_scenario(std::string(VANTAGE_SOURCE_DIR) + "/config/lab.yaml");
}

inline models::ScenarioNotice lab_notice() {
  models::ScenarioNotice notice;
  notice.stamp.time = from_utime(1'000'000);
  notice.yaml = lab().source_text;
  notice.version = "test";
  notice.process = "trial";
  return notice;
}

}  // namespace vantage::logs::foxglove

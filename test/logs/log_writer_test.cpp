#include "logs/record/log_writer.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include "core/check.hpp"

namespace vantage::logs {
namespace {

TEST(LogWriter, WritesWhatLcmReadsWithTheTimesItWasGiven) {
  const std::string path = ::testing::TempDir() + "vantage_log_writer.lcmlog";
  const std::vector<std::uint8_t> first = {1, 2, 3};
  {
    LogWriter writer(path);
    EXPECT_TRUE(writer.write(from_utime(1'700'000'000'000'000), "SCENARIO", first));
    EXPECT_TRUE(writer.write(from_utime(1'700'000'000'500'000), "TRUTH", {}));
    EXPECT_EQ(writer.events(), 2);
  }
  lcm::LogFile log(path, "r");
  ASSERT_TRUE(log.good());
  const lcm::LogEvent* event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->timestamp, 1'700'000'000'000'000);
  EXPECT_EQ(event->channel, "SCENARIO");
  const auto* bytes = static_cast<const std::uint8_t*>(event->data);
  EXPECT_EQ(std::vector<std::uint8_t>(bytes, bytes + event->datalen), first);
  event = log.readNextEvent();
  ASSERT_NE(event, nullptr);
  EXPECT_EQ(event->timestamp, 1'700'000'000'500'000);
  EXPECT_EQ(event->datalen, 0);
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(LogWriter, RefusesAPathThatCannotBeWritten) {
  EXPECT_THROW(LogWriter("/nonexistent/folder/x.lcmlog"), StartupError);
}

}  // namespace
}  // namespace vantage::logs

#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <vantage_lcm/attack_t.hpp>

#include "logs/file/seekable_log.hpp"
#include "test/logs/file_support.hpp"
#include "tools/view/broker.hpp"
#include "tools/view/log_view.hpp"

namespace vantage::tools {
namespace {

// One invalid stamp among valid ones does not change what is shown.
TEST(LogHistory, IgnoresInvalidStamp) {
  const logs::test::TemporaryFolder folder;
  constexpr std::int64_t kNow = 1'795'000'000'000'000;
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  const logs::TypeLibrary types;
  for (const std::int64_t broken : {std::int64_t{0}, kMost - 1, kMost}) {
    logs::test::Bytes bytes;
    for (std::int64_t i = 0; i < 100; ++i) {
      vantage_lcm::attack_t wire{};
      wire.utime = kNow + 10'000 * i;
      wire.sequence = i;
      logs::test::append_message(wire, i, i == 50 ? broken : wire.utime, "ATTACK", bytes);
    }
    const std::string path = folder.file(std::to_string(broken));
    logs::test::write_file(path, bytes);
    logs::SeekableLog log(path);
    while (log.advance(bytes.size())) {
    }
    EXPECT_EQ(log.range().first, from_utime(kNow)) << broken;
    EXPECT_EQ(log.range().second, from_utime(kNow + 990'000)) << broken;
    Broker broker({"test", "s", log.range()});
    EXPECT_FALSE(log_history(log, types, broker).empty());
    const Time begin = first_picture(log);
    LogView view(log, types, broker, begin);
    view.play(0);
    view.tick(20'000'000'000);
  }
}

}  // namespace
}  // namespace vantage::tools

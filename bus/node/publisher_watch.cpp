#include "bus/node/publisher_watch.hpp"

#include "bus/convert/channels.hpp"

namespace vantage::bus {
namespace {

constexpr std::size_t kChannelsMax = 16'384;
constexpr std::size_t kEarlierMax = 7;
constexpr int kReturnsOfTwo = 4;
constexpr std::string_view kExternalPrefix = "EXTERNAL_";

bool may_have_several(std::string_view channel) {
  return channel == kCommand.name || channel == kCollision.name ||
         channel.starts_with(kExternalPrefix);
}

}  // namespace

bool PublisherWatch::on_run(std::string_view channel, std::int64_t run_id) {
  if (run_id <= 0 || may_have_several(channel)) {
    return false;
  }
  auto found = runs_.find(channel);
  if (found == runs_.end()) {
    if (runs_.size() < kChannelsMax) {
      runs_.emplace(channel, Runs{run_id, {}, 0, false});
    }
    return false;
  }
  Runs& runs = found->second;
  if (run_id == runs.current) {
    return false;
  }
  const bool is_return = std::erase(runs.earlier, run_id) > 0;
  if (runs.earlier.size() == kEarlierMax) {
    runs.earlier.erase(runs.earlier.begin());
  }
  runs.earlier.push_back(runs.current);
  runs.current = run_id;
  runs.returns = is_return ? runs.returns + 1 : 0;
  const bool is_new = !runs.is_contested && runs.returns >= kReturnsOfTwo;
  runs.is_contested = runs.is_contested || is_new;
  return is_new;
}

std::vector<std::string> PublisherWatch::contested() const {
  std::vector<std::string> out;
  for (const auto& [channel, runs] : runs_) {
    if (runs.is_contested) {
      out.push_back(channel);
    }
  }
  return out;
}

std::int64_t run_id_of(std::span<const std::uint8_t> message) {
  constexpr std::size_t kBegin = 16;
  constexpr std::size_t kBytes = 8;
  if (message.size() < kBegin + kBytes) {
    return 0;
  }
  std::uint64_t id = 0;
  for (const std::uint8_t byte : message.subspan(kBegin, kBytes)) {
    id = id << 8U | byte;
  }
  return static_cast<std::int64_t>(id);
}

}  // namespace vantage::bus

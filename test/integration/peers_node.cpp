// peers_node URL NAME OTHER…: publishes messages of three sizes. Ends when it has received each
// size from each OTHER, and each OTHER has reported that it has received all, too. Exit code 1
// after 60 s, or if a message has a wrong content.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bus/transport/transport.hpp"
#include "core/deadline.hpp"

namespace {

constexpr std::array<std::size_t, 3> kSizes = {100, 3000, 200'000};
constexpr std::int64_t kLimitNs = 60'000'000'000;
constexpr std::int64_t kPeriodNs =
    500'000'000;  // the switch passes some thousand frames per second
constexpr int kFarewells = 6;

/// Returns the content of a message: one byte that states whether the sender has received all
/// messages, then a fixed pattern.
std::vector<std::uint8_t> content(const std::string& sender, std::size_t size, bool has_all) {
  std::vector<std::uint8_t> bytes(size);
  for (std::size_t i = 0; i < size; ++i) {
    bytes[i] = static_cast<std::uint8_t>(i * 131 + static_cast<unsigned char>(sender.back()));
  }
  bytes[0] = has_all ? 1 : 0;
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const std::string& name = words.at(1);
  const std::set<std::string> others(words.begin() + 2, words.end());
  const auto transport =
      vantage::bus::open_waiting_transport(words.at(0), [](const std::string& /*words*/) {});
  std::map<std::string, std::set<std::size_t>> received;
  std::set<std::string> ready;
  bool is_wrong = false;
  transport->subscribe("FROM_*", [&](std::string_view channel, const auto& bytes) {
    const std::string sender(channel.substr(std::strlen("FROM_")));
    if (sender == name) {
      return;
    }
    const bool has_all = bytes[0] == 1;
    const auto expected = content(sender, bytes.size(), has_all);
    is_wrong = is_wrong || !std::equal(bytes.begin(), bytes.end(), expected.begin());
    received[sender].insert(bytes.size());
    if (has_all) {
      ready.insert(sender);
    }
  });
  // A HOST_* message must come from the same host: names of one host begin with the same letter.
  transport->subscribe("HOST_*", [&](std::string_view channel, const auto& /*bytes*/) {
    is_wrong = is_wrong || channel[std::strlen("HOST_")] != name[0];
  });
  const std::int64_t end_ns = vantage::monotonic_ns() + kLimitNs;
  std::int64_t next_ns = 0;
  for (int farewells = 0; farewells < kFarewells && vantage::monotonic_ns() < end_ns;) {
    bool has_all = true;
    for (const std::string& other : others) {
      has_all = has_all && received[other].size() == kSizes.size();
    }
    bool are_all_ready = has_all;
    for (const std::string& other : others) {
      are_all_ready = are_all_ready && ready.contains(other);
    }
    transport->handle(std::chrono::milliseconds(50));
    if (vantage::monotonic_ns() < next_ns) {
      continue;
    }
    next_ns = vantage::monotonic_ns() + kPeriodNs;
    farewells += are_all_ready ? 1 : 0;
    for (const std::size_t size : kSizes) {
      transport->publish("FROM_" + name, content(name, size, has_all));
    }
    transport->publish_on_host("HOST_" + name, content(name, 50, has_all));
  }
  for (const std::string& other : others) {
    std::printf("%s from %s: %zu sizes%s\n", name.c_str(), other.c_str(), received[other].size(),
                ready.contains(other) ? ", ready" : "");
    is_wrong = is_wrong || received[other].size() != kSizes.size() || !ready.contains(other);
  }
  return is_wrong ? 1 : 0;
}

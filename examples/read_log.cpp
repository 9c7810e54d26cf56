// Reads a log, even if it is damaged. Prints the number of messages on each channel and the last
// belief of each robot. Needs component logs.
#include <cstdio>
#include <map>
#include <string>
#include <type_traits>

#include <vantage/logs/file/log_scan.hpp>
#include <vantage/logs/file/mapped_file.hpp>
#include <vantage/logs/file/message_visit.hpp>

using namespace vantage;

int main(int count, char** words) {
  if (count != 2) {
    std::fprintf(stderr, "usage: read_log LOG\n");
    return 2;
  }
  const logs::MappedFile file(words[1]);
  logs::LogScan scan(file.bytes(), logs::check_wire_data);
  std::map<std::string, int, std::less<>> messages;
  std::map<std::string, models::RobotBelief> beliefs;
  while (const auto placed = scan.next()) {
    ++messages[std::string(placed->channel)];
    logs::visit_message(*placed, [&](const auto& message) {
      if constexpr (std::is_same_v<std::decay_t<decltype(message)>, models::RobotBelief>) {
        beliefs[message.robot] = message;
      }
    });
  }
  for (const auto& [channel, number] : messages) {
    std::printf("%-20s %6d\n", channel.c_str(), number);
  }
  for (const auto& [robot, belief] : beliefs) {
    std::printf("%s: last belief contains %zu targets\n", robot.c_str(), belief.targets.size());
  }
  return messages.empty() ? 1 : 0;
}

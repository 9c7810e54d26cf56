#include "drivers/quadrotor/command_sender.hpp"

#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

constexpr Duration kAnswerWait = std::chrono::milliseconds(500);
constexpr Duration kProgressWait = std::chrono::seconds(3);
constexpr int kSendsMax = 4;

bool is_same(const wire::mavlink::CommandLong& a, const wire::mavlink::CommandLong& b) {
  return a.param1 == b.param1 && a.param2 == b.param2 && a.param3 == b.param3 &&
         a.param7 == b.param7;
}

}  // namespace

void CommandSender::send_command(const wire::mavlink::CommandLong& command, Time now,
                                 Duration pause) {
  const auto [found, is_new] = entries_.try_emplace(command.command);
  Entry& entry = found->second;
  if (!is_new && is_same(entry.command, command) &&
      (entry.is_under_way || (entry.outcome && now < entry.outcome->time + pause))) {
    return;
  }
  entry.command = command;
  entry.is_under_way = true;
  entry.sent = 0;
  entry.next_send = now;
}

void CommandSender::send_command_periodically(const wire::mavlink::CommandLong& command, Time now,
                                              Duration period) {
  const auto [found, is_new] = entries_.try_emplace(command.command);
  Entry& entry = found->second;
  if (is_new || !is_same(entry.command, command) || now >= entry.last_send + period) {
    entry.command = command;
    entry.is_under_way = true;
    entry.sent = 0;
    entry.next_send = now;
  }
}

void CommandSender::acknowledge(const wire::mavlink::CommandAck& ack, Time now) {
  const auto found = entries_.find(ack.command);
  if (found == entries_.end() || !found->second.is_under_way) {
    return;
  }
  Entry& entry = found->second;
  if (ack.result == wire::mavlink::result::kInProgress) {
    entry.next_send = now + kProgressWait;
    return;
  }
  entry.is_under_way = false;
  entry.outcome = Outcome{ack.result, now};
}

std::vector<wire::mavlink::CommandLong> CommandSender::due(Time now) {
  std::vector<wire::mavlink::CommandLong> out;
  for (auto& [number, entry] : entries_) {
    if (!entry.is_under_way || now < entry.next_send) {
      continue;
    }
    if (entry.sent == kSendsMax) {
      entry.is_under_way = false;
      entry.outcome = Outcome{std::nullopt, now};
      ++unanswered_;
      continue;
    }
    entry.command.confirmation = static_cast<std::uint8_t>(entry.sent);
    ++entry.sent;
    entry.last_send = now;
    entry.next_send = now + kAnswerWait;
    out.push_back(entry.command);
  }
  return out;
}

bool CommandSender::is_under_way(std::uint16_t command) const {
  const auto found = entries_.find(command);
  return found != entries_.end() && found->second.is_under_way;
}

std::optional<CommandSender::Outcome> CommandSender::outcome(std::uint16_t command) const {
  const auto found = entries_.find(command);
  return found == entries_.end() ? std::nullopt : found->second.outcome;
}

}  // namespace vantage::drivers

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_packet.hpp"
#include "bus/transport/udpm_transport.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "core/saturated_time.hpp"
#include "core/utf8.hpp"
#include "logs/play/player.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/console/terminal.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "trial/observe/network_conflicts.hpp"

namespace vantage::tools {
namespace {

struct PlayArguments {
  std::string log;
  std::string url;
  double speed = 1.0;
  std::optional<double> from_s;
  std::optional<double> to_s;
  std::vector<std::string> include;
  std::vector<std::string> exclude;
  std::vector<std::string> renames;
  std::string prefix;
  bool ignore_others = false;
  double gap_max_s = 60.0;
  bool loops = false;
  bool starts_paused = false;
  bool as_json = false;
};

logs::PlayOptions options_of(const PlayArguments& arguments, const logs::IndexedLog& log) {
  logs::PlayOptions options;
  options.speed = arguments.speed;
  options.loops = arguments.loops;
  options.gap_max = saturated_seconds(arguments.gap_max_s);
  require_channels(log, arguments.include);
  options.starts_paused = arguments.starts_paused;
  options.rules.channels = logs::ChannelFilter(arguments.include, arguments.exclude);
  options.rules.names = logs::ChannelRenames(arguments.renames);
  if (arguments.from_s) {
    options.rules.from = saturated_sum(log.survey().begin, saturated_seconds(*arguments.from_s));
  }
  if (arguments.to_s) {
    options.rules.to = saturated_sum(log.survey().begin, saturated_seconds(*arguments.to_s));
  }
  require(options.rules.from < options.rules.to, "--from-s must be less than --to-s");
  return options;
}

/// @throws StartupError if a flight is running on the network, because its vehicles might use the
/// log's messages.
void refuse_conflicts(const PlayArguments& arguments) {
  if (arguments.ignore_others || !arguments.prefix.empty()) {
    return;
  }
  const auto transport = bus::open_transport(arguments.url);
  const auto conflicts = trial::conflicts_with_play(
      trial::find_active_channels(*transport, trial::kListenTime, stop_requested));
  if (!conflicts.empty()) {
    throw StartupError(conflicts.front() +
                       ": play on another network (--url), under other names (--prefix), or skip "
                       "this check with --ignore-others");
  }
}

/// Reasons why messages could not be published, by channel.
class PublishFailures {
 public:
  explicit PublishFailures(const bus::Transport& transport) {
    if (const auto* udpm = dynamic_cast<const bus::udpm::UdpmTransport*>(&transport)) {
      message_bytes_max_ = udpm->message_bytes_max();
    }
  }
  void add(const std::string& channel, std::size_t bytes) {
    if (channels_.contains(channel) || channels_.size() < kChannelsPrintedMax) {
      channels_[channel] = std::max(channels_[channel], bytes);
    }
  }
  void print() const {
    for (const auto& [channel, bytes] : channels_) {
      fmt::print(stderr, "{}: {}\n", readable(channel), why(channel, bytes));
    }
  }

 private:
  static constexpr std::size_t kChannelsPrintedMax = 20;

  [[nodiscard]] std::string why(const std::string& channel, std::size_t bytes) const {
    if (bytes > message_bytes_max_) {
      return fmt::format(
          "messages have up to {} bytes, more than max_message_size {}; raise max_message_size in "
          "--url",
          bytes, message_bytes_max_);
    }
    if (!bus::udpm::is_channel_name(channel)) {
      return fmt::format("not a valid LCM channel name: it must have 1 to {} bytes",
                         bus::udpm::kChannelBytesMax);
    }
    return "the network rejected messages of up to " + std::to_string(bytes) + " bytes";
  }

  std::size_t message_bytes_max_ = std::numeric_limits<std::size_t>::max();
  std::map<std::string, std::size_t> channels_;  ///< bytes of the largest message, by channel
};

void print_summary(const PlayArguments& arguments, const logs::PlayReport& report,
                   const PublishFailures& failures) {
  if (arguments.as_json) {
    print_json(nlohmann::ordered_json{{"published", report.published},
                                      {"failed", report.failed},
                                      {"passes", report.passes},
                                      {"late_mean_us", report.late_mean_us},
                                      {"late_worst_us", report.late_worst_us},
                                      {"late_over_1_ms", report.late_over_1_ms},
                                      {"gaps", report.gaps}});
  } else {
    print_line(fmt::format("{} messages published, on average {:.0f} µs late, at most {:.0f} µs",
                           report.published, report.late_mean_us, report.late_worst_us));
  }
  if (report.failed > 0) {
    fmt::print(stderr, "{} messages could not be published\n", report.failed);
    failures.print();
  }
}

int run(const PlayArguments& arguments) {
  const logs::IndexedLog log = open_log(arguments.log);
  refuse_conflicts(arguments);
  const auto transport = bus::open_transport(url_for_log(arguments.url));
  PublishFailures failures(*transport);
  logs::Player player(log, options_of(arguments, log), logs::monotonic_timer(),
                      [&](const logs::LogEvent& event) {
                        const std::string channel = arguments.prefix + std::string(event.channel);
                        const bool is_sent = transport->publish(channel, event.data);
                        if (!is_sent) {
                          failures.add(channel, event.data.size());
                        }
                        return is_sent;
                      });
  Terminal terminal;
  const auto command = [&]() -> std::optional<logs::PlayCommand> {
    while (const auto text = terminal.read()) {
      if (auto wish = logs::parse_play_command(*text)) {
        return wish;
      }
      if (!terminal.is_interactive()) {
        print_line("play: unknown command '" + *text +
                       "'; expected pause, resume, seek S, step S, speed X or quit",
                   stderr);
      }
    }
    return std::nullopt;
  };
  Screen screen;
  const bool shows = is_terminal() && !arguments.as_json;
  const auto on_position = [&](const logs::PlaySchedule& schedule, Time position) {
    if (shows) {
      screen.redraw({fmt::format(
          "{:8.2f} of {:.2f} s   × {:g}{}", to_seconds(position - log.survey().begin),
          log.survey().duration_s(), schedule.speed(), schedule.is_paused() ? "   paused" : "")});
    }
  };
  int gaps_printed = 0;
  const auto on_gap = [&](Time from, Time to) {
    constexpr int kGapsPrintedMax = 5;
    if (++gaps_printed <= kGapsPrintedMax) {
      fmt::print(
          stderr,
          "vantage: {}: a gap is skipped: the log's times jump from {:.3f} s to {:.3f} s after "
          "the first event\n",
          arguments.log, to_seconds(from - log.survey().begin),
          to_seconds(to - log.survey().begin));
    }
  };
  const logs::PlayReport report = player.run(command, stop_requested, on_position, on_gap);
  print_summary(arguments, report, failures);
  return report.failed == 0 ? 0 : 1;
}

}  // namespace

void add_log_play_command(CLI::App& log, Runner& chosen) {
  CLI::App* command =
      log.add_subcommand("play", "Publish the messages of a log again with their original timing.");
  auto arguments = std::make_shared<PlayArguments>();
  command->add_option("log", arguments->log, "LCM event log")->required();
  command->add_option("--url", arguments->url, "LCM URL of the bus; default: $LCM_DEFAULT_URL");
  command
      ->add_option("--speed", arguments->speed,
                   "playback speed relative to the recording; 1: original speed")
      ->check(number_between(1.0 / 64.0, 64.0))
      ->capture_default_str();
  command
      ->add_option("--from-s", arguments->from_s,
                   "start of the part to play, s after the first event")
      ->check(any_number());
  command
      ->add_option("--to-s", arguments->to_s,
                   "end of the part to play (not included), s after the first event")
      ->check(any_number());
  command
      ->add_option(
          "--gap-max-s", arguments->gap_max_s,
          "longest gap to wait for, s; larger jumps of the log's times, forward or back, are "
          "skipped")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--channels", arguments->include,
                      "channels to play; regular expressions that match whole names; default: all");
  command->add_option("--without", arguments->exclude,
                      "channels not to play; regular expressions that match whole names");
  command->add_option("--rename", arguments->renames,
                      "rename channels: OLD=NEW or OLD*=NEW*; the first matching rule applies");
  command->add_option("--prefix", arguments->prefix,
                      "text to put before the name of every channel");
  command->add_flag("--ignore-others", arguments->ignore_others,
                    "play even if vehicles, a supervisor or a simulator are active on the network");
  command->add_flag("--loop", arguments->loops, "start again when the end is reached");
  command->add_flag("--paused", arguments->starts_paused,
                    "start paused; the space key or the line 'resume' starts playback");
  command->add_flag("--json", arguments->as_json, "print one JSON object at the end");
  command->footer(
      "Keys: space pauses, right or f and left or b jump 5 s forward and back, + and - (or up and\n"
      "down) change the speed, q quits. Without a terminal it reads lines: pause, resume, seek S,\n"
      "step S, speed X, quit.\n"
      "After a jump back, vantage's processes reject the messages as too old: restart them.\n"
      "Viewers and other LCM programs accept them.\n"
      "Examples:\n"
      "  vantage log play flight.lcmlog --speed 2 --from-s 30\n"
      "  vantage log play flight.lcmlog --channels VICON --rename VICON=MOCAP --loop");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

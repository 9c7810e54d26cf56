#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/process_usage.hpp"
#include "bus/transport/transport.hpp"
#include "bus/transport/udpm_transport.hpp"
#include "core/check.hpp"
#include "core/life_line.hpp"
#include "core/process.hpp"
#include "core/utf8.hpp"
#include "logs/record/recorder.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {
namespace {

constexpr std::uint64_t kMebi = std::uint64_t{1} << 20U;
constexpr auto kFirstPatience = std::chrono::seconds(2);
constexpr Duration kDrainPatience = std::chrono::milliseconds(100);

struct RecordArguments {
  std::string log;
  std::string url;
  std::string scenario;
  std::vector<std::string> include;
  std::vector<std::string> exclude;
  bool appends = false;
  std::uint64_t rotate_mib = 0;
  std::uint64_t limit_mib = 0;
  std::uint64_t free_mib = 100;
  double duration_s = 0.0;
  bool as_json = false;
  bool is_quiet = false;
};

logs::SpoolOptions options_of(const RecordArguments& arguments) {
  logs::SpoolOptions options;
  options.path = arguments.log;
  options.existing = arguments.appends ? logs::Existing::kAppend : logs::Existing::kRefuse;
  options.rotate_bytes = arguments.rotate_mib * kMebi;
  options.limit_bytes = arguments.limit_mib * kMebi;
  return options;
}

void check_room(const RecordArguments& arguments) {
  const auto free_bytes = logs::free_bytes_for(arguments.log);
  if (free_bytes && *free_bytes < arguments.free_mib * kMebi) {
    throw StartupError(fmt::format(
        "{}: {} MiB are free there, less than --free-mib {}: make room, or write elsewhere",
        arguments.log, *free_bytes / kMebi, arguments.free_mib));
  }
}

/// Prints once when the free space falls below --free-mib, and once when it rises above it again.
class RoomWatch {
 public:
  explicit RoomWatch(const RecordArguments& arguments) : arguments_(arguments) {}
  void look(const logs::SpoolReport& report) {
    const bool is_little = report.free_bytes && *report.free_bytes < arguments_.free_mib * kMebi;
    if (is_little != std::exchange(was_little_, is_little)) {
      print_line(fmt::format("record: {} MiB are left for {}",
                             report.free_bytes.value_or(0) / kMebi, report.path),
                 stderr);
    }
  }

 private:
  const RecordArguments& arguments_;
  bool was_little_ = false;
};

/// Messages that were sent but not recorded, as far as the transport knows.
struct Losses {
  std::int64_t for_want_of_room = 0;
  std::int64_t incomplete = 0;
  std::int64_t oversized = 0;
  std::vector<std::string> sentences;
  [[nodiscard]] bool is_none() const { return sentences.empty(); }
};

Losses losses_of(const bus::Transport& transport, logs::ChannelFilter channels) {
  const bus::TransportStats stats = transport.stats();
  Losses out;
  out.for_want_of_room = stats.kernel_drops + stats.queue_overflows;
  out.incomplete = stats.incomplete_messages;
  if (out.for_want_of_room > 0) {
    out.sentences.push_back(
        fmt::format("{} datagrams or messages were lost for want of room before they were recorded",
                    out.for_want_of_room));
  }
  if (out.incomplete > 0) {
    out.sentences.push_back(
        fmt::format("{} messages are not in the log: parts of them never arrived", out.incomplete));
  }
  if (const auto* udpm = dynamic_cast<const bus::udpm::UdpmTransport*>(&transport)) {
    for (const auto& [channel, refused] : udpm->oversized()) {
      if (channels.takes(channel)) {
        out.oversized += refused.messages;
        out.sentences.push_back(fmt::format(
            "{}: {} messages are not in the log: of up to {} bytes, more than max_message_size {}; "
            "set max_message_size in --url",
            readable(channel), refused.messages, refused.bytes_max, udpm->message_bytes_max()));
      }
    }
  }
  return out;
}

void tell_end(const RecordArguments& arguments, const logs::SpoolReport& report,
              const bus::TransportStats& heard, const Losses& losses) {
  if (arguments.as_json) {
    print_json({{"path", report.path},
                {"files", report.files},
                {"events", report.events},
                {"bytes", report.bytes},
                {"events_lost", report.events_lost},
                {"kernel_drops", heard.kernel_drops},
                {"queue_overflows", heard.queue_overflows},
                {"incomplete_messages", losses.incomplete},
                {"oversized_messages", losses.oversized},
                {"malformed_datagrams", heard.malformed_datagrams},
                {"write_errors", report.write_errors},
                {"sync_errors", report.sync_errors},
                {"syncs_late", report.syncs_late},
                {"at_risk_worst_us", report.at_risk_worst_us}});
    return;
  }
  print_line(fmt::format("{}: {} events, {:.1f} MB{}", arguments.log, report.events,
                         static_cast<double>(report.bytes) * 1e-6,
                         report.files > 1 ? fmt::format(" in {} files", report.files) : ""));
  if (report.events_lost > 0) {
    print_line(fmt::format("record: {} events were lost", report.events_lost), stderr);
  }
  for (const std::string& sentence : losses.sentences) {
    print_line("record: " + sentence, stderr);
  }
}

int run(const RecordArguments& arguments) {
  check_room(arguments);
  const auto tell = [](const std::string& news) { print_line("record: " + news, stderr); };
  LifeSign life;
  const auto transport = bus::open_transport(url_for_log(arguments.url));
  logs::LogSpool spool(options_of(arguments));
  const bus::SteadyClock clock;
  logs::RecorderNode node(*transport, clock, spool,
                          logs::ChannelFilter(arguments.include, arguments.exclude), tell);
  bus::Bus bus(*transport, bus::random_run_id());
  bus.keep_time(clock);
  if (!arguments.scenario.empty()) {
    bus.secure(bus::auth::authenticator_for(scenario::load_scenario(arguments.scenario)), clock);
  }
  const Time start = clock.now();
  const auto is_over = [&] {
    return stop_requested() || (arguments.duration_s > 0.0 &&
                                clock.now() >= start + from_seconds(arguments.duration_s));
  };
  // Waits for the first message, so that the log begins with SCENARIO and not with this process's
  // health.
  while (!is_over() && node.heard() == 0 && clock.now() < start + kFirstPatience) {
    bus.handle(std::chrono::milliseconds(20));
  }
  RoomWatch room(arguments);
  const auto usage = [&] {
    auto counters = node.traffic();
    const auto of_process = bus::usage_counters();
    counters.insert(counters.end(), of_process.begin(), of_process.end());
    return counters;
  };
  bus::run_node(
      bus, node, clock,
      [&] {
        const logs::SpoolReport report = spool.report();
        room.look(report);
        return is_over() || report.is_full;
      },
      usage, &life);
  const Time give_up = clock.now() + kDrainPatience;
  while (bus.handle(std::chrono::microseconds(0)) > 0 && clock.now() < give_up) {
  }
  spool.close();
  node.tick(clock.now());
  const logs::SpoolReport report = spool.report();
  const Losses losses =
      losses_of(*transport, logs::ChannelFilter(arguments.include, arguments.exclude));
  if (!arguments.is_quiet) {
    tell_end(arguments, report, transport->stats(), losses);
  }
  return report.is_good() && losses.is_none() ? 0 : 1;
}

}  // namespace

void add_log_record_command(CLI::App& log, Runner& chosen) {
  CLI::App* command =
      log.add_subcommand("record", "Record a bus until Ctrl-C, losing 100 ms at most to anything.");
  auto arguments = std::make_shared<RecordArguments>();
  command->add_option("log", arguments->log, "LCM event log to write, a new file")->required();
  command->add_option("--url", arguments->url, "LCM URL; $LCM_DEFAULT_URL when not given");
  command->add_option("--scenario", arguments->scenario,
                      "sign HEALTH_RECORDER with the keys of this scenario's `security`");
  command->add_option("--channels", arguments->include, "the ones to record (whole names)");
  command->add_option("--without", arguments->exclude, "the ones not to record");
  command->add_flag("--append", arguments->appends, "go on with the log where there is one");
  command->add_option("--rotate-mib", arguments->rotate_mib,
                      "begin another file, NAME-2, NAME-3, … before one gets longer");
  command->add_option("--limit-mib", arguments->limit_mib,
                      "end, with exit code 1, before all files together get longer; with --append "
                      "those that are there count");
  command
      ->add_option("--free-mib", arguments->free_mib,
                   "what must be free to begin; what is left is told below that")
      ->capture_default_str();
  command->add_option("--duration-s", arguments->duration_s, "end after that")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", arguments->as_json, "print one JSON object at the end");
  command->add_flag("--quiet", arguments->is_quiet, "say nothing at the end");
  command->footer(
      "No log is deleted or written over. While the disk refuses (full, read-only) that is said "
      "at\n"
      "once and on HEALTH_RECORDER, and tried again; the file stays whole. Ctrl-C, SIGTERM and\n"
      "SIGHUP end it. Each file after the first begins with the newest SCENARIO. Messages of up "
      "to\n"
      "32 MiB are recorded; max_message_size=BYTES in --url sets another limit.\n"
      "Exit code 1 when anything was lost or the disk refused, 2 when it could not start.\n"
      "Examples:\n"
      "  vantage log record flight.lcmlog\n"
      "  vantage log record flight.lcmlog --rotate-mib 500 --without 'SCAN_.*'\n"
      "  vantage log record plans.lcmlog --channels 'PLAN_.*' SCENARIO --duration-s 60");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

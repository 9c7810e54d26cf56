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
#include "core/liveness.hpp"
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
  int sync_ms = 40;
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
  options.sync_period = std::chrono::milliseconds(arguments.sync_ms);
  return options;
}

void check_disk_space(const RecordArguments& arguments) {
  const auto free_bytes = logs::free_bytes_for(arguments.log);
  if (free_bytes && *free_bytes < arguments.free_mib * kMebi) {
    throw StartupError(fmt::format(
        "{}: only {} MiB are free on its disk, and --free-mib requires {}; free some space, or "
        "write to another disk",
        arguments.log, *free_bytes / kMebi, arguments.free_mib));
  }
}

/// Monitor of the free disk space. It prints once when the space falls below --free-mib, and once
/// when the space exceeds --free-mib again.
class DiskSpaceWatch {
 public:
  explicit DiskSpaceWatch(const RecordArguments& arguments) : arguments_(arguments) {}
  void update(const logs::SpoolReport& report) {
    const bool is_little = report.free_bytes && *report.free_bytes < arguments_.free_mib * kMebi;
    if (is_little != std::exchange(was_little_, is_little)) {
      print_line(fmt::format("record: {}, {} MiB of disk space are left for {}",
                             is_little ? "the disk is nearly full" : "the disk has space again",
                             report.free_bytes.value_or(0) / kMebi, report.path),
                 stderr);
    }
  }

 private:
  const RecordArguments& arguments_;
  bool was_little_ = false;
};

/// Messages that were sent but not recorded, as far as the transport can detect.
struct Losses {
  std::int64_t buffer_overflows = 0;
  std::int64_t incomplete = 0;
  std::int64_t oversized = 0;
  std::vector<std::string> sentences;
  [[nodiscard]] bool is_none() const { return sentences.empty(); }
};

Losses losses_of(const bus::Transport& transport, logs::ChannelFilter channels) {
  const bus::TransportStats stats = transport.stats();
  Losses out;
  out.buffer_overflows = stats.kernel_drops + stats.queue_overflows;
  out.incomplete = stats.incomplete_messages;
  if (out.buffer_overflows > 0) {
    out.sentences.push_back(
        fmt::format("{} datagrams or messages are not in the log: the receive buffers were full",
                    out.buffer_overflows));
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
            "{}: {} messages are not in the log: they have up to {} bytes, more than "
            "max_message_size {}; raise max_message_size in --url",
            readable(channel), refused.messages, refused.bytes_max, udpm->message_bytes_max()));
      }
    }
  }
  return out;
}

void print_summary(const RecordArguments& arguments, const logs::SpoolReport& report,
                   const bus::TransportStats& stats, const Losses& losses) {
  if (arguments.as_json) {
    print_json({{"path", report.path},
                {"files", report.files},
                {"events", report.events},
                {"bytes", report.bytes},
                {"events_lost", report.events_lost},
                {"kernel_drops", stats.kernel_drops},
                {"queue_overflows", stats.queue_overflows},
                {"incomplete_messages", losses.incomplete},
                {"oversized_messages", losses.oversized},
                {"malformed_datagrams", stats.malformed_datagrams},
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
    print_line(fmt::format("record: {} events were lost: they could not be written to the log",
                           report.events_lost),
               stderr);
  }
  for (const std::string& sentence : losses.sentences) {
    print_line("record: " + sentence, stderr);
  }
}

int run(const RecordArguments& arguments) {
  check_disk_space(arguments);
  const auto print_notice = [](const std::string& notice) {
    print_line("record: " + notice, stderr);
  };
  LivenessSender life;
  const auto transport = bus::open_transport(url_for_log(arguments.url));
  logs::LogSpool spool(options_of(arguments));
  const bus::SteadyClock clock;
  logs::RecorderNode node(*transport, clock, spool,
                          logs::ChannelFilter(arguments.include, arguments.exclude), print_notice);
  bus::Bus bus(*transport, bus::random_run_id());
  bus.use_clock(clock);
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
  while (!is_over() && node.received() == 0 && clock.now() < start + kFirstPatience) {
    bus.handle(std::chrono::milliseconds(20));
  }
  DiskSpaceWatch disk_space(arguments);
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
        disk_space.update(report);
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
    print_summary(arguments, report, transport->stats(), losses);
  }
  return report.is_good() && losses.is_none() ? 0 : 1;
}

}  // namespace

void add_log_record_command(CLI::App& log, Runner& chosen) {
  CLI::App* command =
      log.add_subcommand("record", "Record the messages of an LCM bus to a log until Ctrl-C.");
  auto arguments = std::make_shared<RecordArguments>();
  command
      ->add_option("log", arguments->log,
                   "LCM event log to write; the file must not exist unless --append is given")
      ->required();
  command->add_option("--url", arguments->url, "LCM URL of the bus; default: $LCM_DEFAULT_URL");
  command->add_option(
      "--scenario", arguments->scenario,
      "scenario file; HEALTH_RECORDER is signed with the keys of its `security` section");
  command->add_option(
      "--channels", arguments->include,
      "channels to record; regular expressions that match whole names; default: all");
  command->add_option("--without", arguments->exclude,
                      "channels not to record; regular expressions that match whole names");
  command->add_flag("--append", arguments->appends, "append to the log if it exists");
  command->add_option("--rotate-mib", arguments->rotate_mib,
                      "MiB; largest size of a file; the recording continues in NAME-2, NAME-3, …; "
                      "0 (default): no limit");
  command->add_option(
      "--limit-mib", arguments->limit_mib,
      "MiB; largest total size; the recording ends with exit code 1 before it is exceeded; "
      "with --append existing files count; 0 (default): no limit");
  command
      ->add_option(
          "--free-mib", arguments->free_mib,
          "free disk space required at the start, MiB; a warning is printed if less is left later")
      ->capture_default_str();
  command
      ->add_option(
          "--sync-ms", arguments->sync_ms,
          "pause between two syncs to the disk, ms; a power cut loses up to twice this time "
          "of events; larger values wear an SD card less")
      ->capture_default_str()
      ->check(CLI::Range(1, 60'000));
  command
      ->add_option("--duration-s", arguments->duration_s,
                   "end the recording after this time, s; default: at Ctrl-C")
      ->check(CLI::PositiveNumber);
  command->add_flag("--json", arguments->as_json, "print one JSON object at the end");
  command->add_flag("--quiet", arguments->is_quiet, "print no report at the end");
  command->footer(
      "Ctrl-C, SIGTERM and SIGHUP end the recording. Existing logs are never deleted or\n"
      "overwritten. If the disk rejects data (full, read-only), this is reported at once, also on\n"
      "HEALTH_RECORDER, and writing is tried again; the file stays valid. A power cut normally\n"
      "loses less than 100 ms (--sync-ms). With --rotate-mib each further file begins with the "
      "newest\n"
      "SCENARIO. Messages of up to 32 MiB are recorded; max_message_size=BYTES in --url sets\n"
      "another limit.\n"
      "Exit code 1: messages were lost or the disk rejected data; 2: it could not start.\n"
      "Examples:\n"
      "  vantage log record flight.lcmlog\n"
      "  vantage log record flight.lcmlog --rotate-mib 500 --without 'SCAN_.*'\n"
      "  vantage log record plans.lcmlog --channels 'PLAN_.*' SCENARIO --duration-s 60");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

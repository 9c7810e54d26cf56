#include "tools/up/up.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <csignal>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/flights.hpp"
#include "bus/node/process_usage.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "core/utf8.hpp"
#include "logs/record/append_file.hpp"
#include "logs/record/log_space.hpp"
#include "logs/record/recorder.hpp"
#include "tools/live/output.hpp"
#include "tools/live/trial_display.hpp"
#include "tools/up/host_board.hpp"
#include "tools/up/host_readiness.hpp"
#include "tools/up/landing.hpp"
#include "tools/up/pilot.hpp"
#include "tools/up/process_plan.hpp"
#include "tools/up/scenario_memory.hpp"
#include "tools/up/up_report.hpp"
#include "trial/observe/announcer.hpp"
#include "trial/observe/network_conflicts.hpp"
#include "trial/observe/observer.hpp"
#include "trial/robot_processes.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;

constexpr Duration kReportPeriod = std::chrono::seconds(1);
constexpr Duration kLogCheckPeriod = milliseconds(500);
// The times below let a trial end within 2 s. On a slow disk the end takes longer: each of the last
// two syncs of the log may take 2 s.
constexpr milliseconds kTeamPatience{1200};
constexpr Duration kDrainPatience = milliseconds(200);
constexpr Duration kFinishPatience = milliseconds(300);
constexpr milliseconds kLoggerPatience{5000};

bool is_zero(const models::ProcessHealth& health, const std::string& counter) {
  return std::any_of(health.counters.begin(), health.counters.end(),
                     [&](const auto& each) { return each.name == counter && each.count == 0; });
}

Time monotonic_now() { return from_utime(monotonic_ns() / 1'000); }

/// Clock of the trial. Its constructor exports the clock's offset to all child processes started
/// later.
struct SharedClock : bus::SteadyClock {
  SharedClock() { export_offset(); }
};

std::set<std::string> as_set(const std::vector<std::string>& names) {
  return {names.begin(), names.end()};
}

/// Makes `bus` sign and verify messages by the security settings of `scenario`. Returns `bus`.
bus::Bus& secured(bus::Bus& bus, const scenario::Scenario& scenario, const bus::Clock& clock) {
  bus.secure(bus::auth::authenticator_for(scenario), clock);
  return bus;
}

/// Prints conflicts that messages without a valid signature report. They do not prevent the start.
void print_unverified(const std::vector<std::string>& claims) {
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < std::min(claims.size(), kShown); ++i) {
    print_line("! ignored, since its signature is missing or wrong: " + claims[i], stderr);
  }
  if (claims.size() > kShown) {
    print_line(fmt::format("! … and {} more such messages", claims.size() - kShown), stderr);
  }
}

/// Running trial. The members are in the order of starting. Only the log's position matters: the
/// log starts before all processes and is destroyed after them, even if the constructor throws.
class Up {
 public:
  Up(const scenario::Scenario& scenario, const UpOptions& options);
  UpResult run(const std::function<bool()>& stop);

 private:
  [[nodiscard]] bool announces() const {
    return options_.host.empty() || scenario_.runs_on(options_.host, scenario::kLoggerPart);
  }
  void listen();
  void run_once();
  bool run_once_safely();
  void handle(const std::vector<SupervisorEvent>& events);
  [[nodiscard]] std::vector<SupervisedStatus> statuses() const;
  models::HostReport report(Time now);
  void watch_log(Time now);
  [[nodiscard]] std::vector<std::string> others_in_flight() const;
  [[nodiscard]] std::vector<std::string> vehicles_in_flight() const;
  [[nodiscard]] bool has_lost_vehicles() const;
  void land();
  void stop_all();
  void finish_log();
  void show_event(const std::optional<std::string>& words) {
    if (words && !words->empty()) {
      display_.show_event(*words);
    }
  }

  const scenario::Scenario& scenario_;
  const UpOptions& options_;
  const std::string host_;
  const std::unique_ptr<bus::Transport> transport_;
  bus::Bus bus_;
  const SharedClock clock_;
  trial::Announcer announcer_;
  const ScenarioMemory file_;
  const ProcessSettings settings_;
  std::unique_ptr<LogKeeper> keeper_;
  const Time start_;
  trial::TrialObserver observer_;
  HostBoard board_;
  UsageMeter meter_;
  logs::LogWatch log_watch_;
  bool is_log_refused_ = false;  ///< the recorder reports that the disk refuses the log
  Time next_log_check_{};
  Time next_log_health_{};
  TrialDisplay display_;
  std::unique_ptr<Pilot> pilot_;
  Supervisor team_;
  bus::Flights flights_;          ///< flight states of all vehicles with a driver, from VEHICLE_*
  std::set<std::string> drives_;  ///< vehicles with a driver on this host
  bool serves_flights_ = false;   ///< the simulator or the mocap driver runs here
  Time next_report_{};
  int requests_obeyed_ = 1;  ///< requests to end that were obeyed; further ones are urgent
  UpResult result_;
};

Up::Up(const scenario::Scenario& scenario, const UpOptions& options)
    : scenario_(scenario),
      options_(options),
      host_(options.host.empty() ? kOnlyHost : options.host),
      transport_(bus::open_transport(scenario.network.url)),
      bus_(*transport_, bus::random_run_id()),
      announcer_(secured(bus_, scenario, clock_), scenario, "up"),
      file_(scenario.source_text),
      settings_{options.executables,         file_.path(),
                scenario.network.url,        options.host,
                options.has_virtual_targets, options.firmware_folder,
                {file_.descriptor()},        options.driver_priority},
      keeper_(options.log_path.empty()
                  ? nullptr
                  : std::make_unique<LogKeeper>(
                        recorder_process(settings_, options.log_path, options.log_sync_ms),
                        options.log_path, options.restarts, announcer_, clock_)),
      start_(clock_.now()),
      observer_(bus_, scenario, start_),
      board_(scenario, host_, bus_.run_id(), start_),
      log_watch_(logs::kLogBytesPerRobotS * static_cast<double>(scenario.robots.size())),
      display_(form_of(options.quiet, options.live_table)),
      pilot_(options.fly ? std::make_unique<Pilot>(bus_, scenario, start_) : nullptr),
      team_(options.restarts),
      flights_(as_set(robots_with_driver(scenario))) {
  bus_.use_clock(clock_);
  listen();
  if (announces()) {
    announcer_.publish(start_);
  }
  for (const ProcessSpec& process : process_plan(scenario, settings_)) {
    team_.start(process, monotonic_ns());
    serves_flights_ = serves_flights_ || process.is_essential;
    if (!process.vehicle.empty()) {
      drives_.insert(process.vehicle);
    }
  }
}

void Up::listen() {
  bus_.subscribe<models::HostReport>(bus::host_channel("*"), [this](const auto& report) {
    show_event(board_.on_report(report, clock_.now()));
  });
  bus_.subscribe<models::ScenarioNotice>(bus::kScenario, [this](const auto& notice) {
    if (notice.yaml != scenario_.source_text && !std::exchange(result_.has_other_scenario, true)) {
      display_.show_event("another scenario file or other options are in use on this network (by " +
                          readable(notice.process) + ", version " + readable(notice.version) + ")");
    }
  });
  bus_.subscribe<models::VehicleStatus>(
      bus::vehicle_channel("*"),
      [this](const models::VehicleStatus& status) { flights_.on_status(status, clock_.now()); });
  bus_.subscribe<models::ProcessHealth>(bus::health_channel(logs::RecorderNode::kName),
                                        [this](const models::ProcessHealth& health) {
                                          is_log_refused_ = is_zero(health, "log.is_written");
                                        });
}

std::vector<SupervisedStatus> Up::statuses() const {
  const std::int64_t now_ns = monotonic_ns();
  std::vector<SupervisedStatus> out = team_.status(now_ns);
  if (keeper_) {
    const auto logger = keeper_->supervisor().status(now_ns);
    out.insert(out.end(), logger.begin(), logger.end());
  }
  return out;
}

models::HostReport Up::report(Time now) {
  models::HostReport report;
  report.stamp.time = now;
  report.host = host_;
  for (const SupervisedStatus& status : statuses()) {
    models::SupervisedProcess process{
        status.name, status.phase, status.restarts, status.down_s, 0.0, 0, status.last_end};
    std::optional<UsageMeter::Reading> reading;
    if (const auto usage = status.pid > 0 ? bus::usage_of(status.pid) : std::nullopt) {
      reading = UsageMeter::Reading{usage->cpu_us, usage->memory_bytes};
    }
    meter_.fill(status, reading, now, process);
    report.processes.push_back(std::move(process));
  }
  return report;
}

void Up::handle(const std::vector<SupervisorEvent>& events) {
  for (const SupervisorEvent& event : events) {
    display_.show_event(event.text);
    next_report_ = {};
    if (event.name == kSimProcess && event.kind == SupervisorEvent::Kind::kStarted) {
      ++result_.world_restarts;
      display_.show_event(
          "the simulator was restarted: robots and targets are back at their starts");
    }
  }
}

// Publishes and prints immediately that the log cannot be written. The flight continues.
void Up::watch_log(Time now) {
  if (!keeper_ || now < next_log_check_) {
    return;
  }
  next_log_check_ = now + kLogCheckPeriod;
  std::error_code error;
  const auto size = std::filesystem::file_size(options_.log_path, error);
  const bool was_written = log_watch_.is_written();
  const auto words = log_watch_.update(
      {error ? 0 : size, logs::free_bytes_for(options_.log_path), is_log_refused_},
      monotonic_now());
  show_event(words);
  if (words || now >= next_log_health_) {
    bus_.publish(bus::health_channel(logs::kLogHealth), log_watch_.health(now));
    next_log_health_ = now + kReportPeriod;
  }
  result_.log_was_unwritten |= was_written && !log_watch_.is_written();
}

// Polls the processes first, so that they are kept alive even if the network is not usable.
void Up::run_once() {
  handle(team_.poll(monotonic_ns()));
  if (keeper_) {
    handle(keeper_->poll(monotonic_ns()));
  }
  bus_.handle(milliseconds(pilot_ ? 10 : 50));
  const Time now = clock_.now();
  if (announces()) {
    announcer_.tick(now);
  }
  if (pilot_) {
    show_event(pilot_->tick(now));
  }
  for (const std::string& words : board_.fallen_silent(now)) {
    display_.show_event(words);
  }
  if (now >= next_report_) {
    bus_.publish(bus::host_channel(host_), report(now));
    next_report_ = now + kReportPeriod;
  }
  watch_log(now);
  if (display_.is_due(now)) {
    display_.show(now, scenario_, observer_.metrics(), to_seconds(now - start_), board_.table(now),
                  board_.line(now));
  }
}

// Catches errors of this program, so that vehicles are still landed and the result is reported.
bool Up::run_once_safely() {
  try {
    run_once();
    return true;
  } catch (const std::exception& error) {
    if (result_.broken.empty()) {
      result_.broken = error.what();
      display_.show_event(std::string("the trial ends because of an internal error: ") +
                          error.what());
    }
    // An error before the wait for messages would repeat thousands of times per second in land().
    std::this_thread::sleep_for(milliseconds(10));
    return false;
  }
}

// Returns the flying vehicles of other hosts, if they need the simulator or mocap driver of this
// host.
std::vector<std::string> Up::others_in_flight() const {
  std::vector<std::string> out = flights_.in_flight(clock_.now());
  std::erase_if(out, [this](const std::string& robot) { return drives_.count(robot) > 0; });
  return serves_flights_ ? out : std::vector<std::string>{};
}

std::vector<std::string> Up::vehicles_in_flight() const {
  std::vector<std::string> out = others_in_flight();
  for (const SupervisedStatus& process : team_.status(monotonic_ns())) {
    if (!process.vehicle.empty() && process.in_flight == InFlight::kYes) {
      out.push_back(process.vehicle);
    }
  }
  return out;
}

// True if the simulator was given up and all vehicles were simulated by it.
bool Up::has_lost_vehicles() const {
  return team_.lost_essential() == kSimProcess &&
         std::none_of(scenario_.robots.begin(), scenario_.robots.end(), [](const auto& robot) {
           return robot.device == scenario::DeviceSource::kReal;
         });
}

void Up::land() {
  if (pilot_) {
    pilot_->program().land_all();
  }
  if (!vehicles_in_flight().empty()) {
    display_.show_event(
        fmt::format("waiting for the landing of {}; one more Ctrl-C leaves it to their "
                    "autopilots",
                    fmt::join(vehicles_in_flight(), ", ")));
  }
  team_.end_drivers();
  Landing landing(clock_.now());
  bool is_hurried = false;
  const auto is_at_rest = [&] {
    return team_.have_drivers_ended() && (others_in_flight().empty() || is_hurried);
  };
  while (!has_lost_vehicles()) {
    const bool is_urgent = options_.stop_requests() > requests_obeyed_;
    const Landing::Step step = landing.step(is_at_rest(), is_urgent, clock_.now());
    if (step == Landing::Step::kOver) {
      break;
    }
    if (step == Landing::Step::kRequestAgain) {
      is_hurried = true;
      team_.end_drivers();
    }
    run_once_safely();
  }
  requests_obeyed_ = std::clamp(options_.stop_requests(), requests_obeyed_, 2);
  result_.left_flying = vehicles_in_flight();
  if (pilot_) {
    for (const std::string& robot : robots_with_driver(scenario_)) {
      if (pilot_->program().have_flown().count(robot) == 0) {
        result_.never_flown.push_back(robot);
      }
    }
  }
}

// Publishes a last message after all other processes have ended. A log that contains this message
// is complete.
void Up::finish_log() {
  const auto wire = bus::to_wire(bus_.publish(bus::host_channel(host_), report(clock_.now())));
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, wire.getEncodedSize());
  const Time give_up = clock_.now() + kFinishPatience;
  while (!keeper_->tail_contains(bytes) && clock_.now() < give_up) {
    bus_.handle(milliseconds(5));
  }
  for (std::string& name_killed : keeper_->stop(kLoggerPatience)) {
    result_.killed.push_back(std::move(name_killed));
  }
  result_.log = keeper_->outcome();
  result_.log.is_to_the_end = keeper_->tail_contains(bytes);
}

void Up::stop_all() {
  clear_echo();  // removes an echoed ^C before the last output of the processes
  const Time begin = clock_.now();
  result_.processes = statuses();
  bool is_hurried = false;
  if (!result_.left_flying.empty()) {
    // Processes that vehicles depend on obey the first request only after all landings
    // (bus::EndAfterFlights), but a second one immediately. This is the first request.
    team_.send_to_ours(SIGINT);
  }
  std::vector<std::string> killed = team_.stop_all(kTeamPatience, [&] {
    is_hurried = options_.stop_requests() > requests_obeyed_;
    return is_hurried;
  });
  (is_hurried ? result_.cut_short : result_.killed) = std::move(killed);
  const auto ended = team_.status(monotonic_ns());
  for (std::size_t i = 0; i < ended.size(); ++i) {
    const std::string& how = ended[i].last_end;
    const bool is_fine = how == "exit 0" || how == "signal 15" || how == "killed" ||
                         ended[i].name.starts_with("firmware ");
    const bool was_ended = result_.processes[i].pid > 0 ||
                           result_.processes[i].phase == models::SupervisedPhase::kEnded;
    if (was_ended && !is_fine) {
      result_.ended_badly.push_back(ended[i].name + " (" + how + ")");
    }
  }
  // Receives the last HEALTH of each process. The time is bounded because other hosts keep sending.
  const Time give_up = clock_.now() + kDrainPatience;
  while (bus_.handle(milliseconds(50)) > 0 && clock_.now() < give_up) {
  }
  if (keeper_) {
    finish_log();
  }
  result_.stop_s = to_seconds(clock_.now() - begin);
}

UpResult Up::run(const std::function<bool()>& stop) {
  const Time end = start_ + from_seconds(scenario_.duration_s);
  const auto is_over = [&] { return options_.ends_by_duration && clock_.now() >= end; };
  while (!stop() && !is_over() && !team_.lost_essential() && run_once_safely()) {
  }
  result_.summary = observer_.metrics().finish(clock_.now());
  land();
  stop_all();
  const logs::TrialMetrics& metrics = observer_.metrics();
  result_.summary.collisions = metrics.collisions();
  result_.summary.separation_violations = metrics.separation_violations();
  result_.contacts_unverified = contacts_unverified(bus_.counters());
  result_.summary.messages_lost =
      metrics.messages_lost() + bus_.messages_lost() + transport_->stats().queue_overflows;
  return std::move(result_);
}

}  // namespace

UpResult run_up(const scenario::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop) {
  if (const auto faults = device_faults(scenario); !faults.empty()) {
    throw StartupError(faults.front());
  }
  if (const auto faults = bus::auth::security_faults(scenario); !faults.empty()) {
    throw StartupError(faults.front());
  }
  if (options.fly) {
    bus::auth::require_operator(scenario);
  }
  if (!options.log_path.empty()) {
    const logs::LogSpaceCheck space =
        logs::check_log_space(scenario, options.log_path, logs::free_bytes_for(options.log_path));
    if (!space.is_enough) {
      throw StartupError(space.summary +
                         ": free disk space, write to another disk (--log), fly for a shorter "
                         "time (--duration-s), or do not record (--no-log)");
    }
  }
  const LoadMeter load;
  if (!options.ignore_others) {
    const auto transport = bus::open_transport(scenario.network.url);
    const auto authenticator = bus::auth::authenticator_for(scenario);
    const bus::SteadyClock clock;
    const trial::ActiveChannels active = trial::find_active_channels(
        *transport, trial::kListenTime, stop, authenticator.get(), clock);
    print_unverified(trial::conflicts_with_up(scenario, options.host, active.unverified));
    const auto conflicts = trial::conflicts_with_up(scenario, options.host, active.accepted);
    if (!conflicts.empty()) {
      throw StartupError(conflicts.front() +
                         ": end it, use another network (--url), or start anyway with "
                         "--ignore-others");
    }
  }
  const UpOptions granted = with_priority(scenario, options, load);
  const NonBlockingOutput output;
  return Up(scenario, granted).run(stop);
}

}  // namespace vantage::tools

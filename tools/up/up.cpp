#include "tools/up/up.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include <unistd.h>

#include "bus/bus.hpp"
#include "bus/clock.hpp"
#include "bus/transport.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "tools/console/console.hpp"
#include "tools/live/screen.hpp"
#include "tools/live/status_table.hpp"
#include "tools/observe/announcer.hpp"
#include "tools/observe/observer.hpp"
#include "tools/picture/picture.hpp"
#include "tools/up/flight_program.hpp"
#include "tools/up/process_plan.hpp"

namespace vantage::tools {
namespace {

using std::chrono::milliseconds;

constexpr auto kLandingPatience = std::chrono::seconds(60);

/// A scenario file that lives as long as the processes that read it.
class TemporaryScenario {
 public:
  explicit TemporaryScenario(const std::string& yaml) {
    const auto name = "vantage-" + std::to_string(::getpid()) + ".yaml";
    path_ = std::filesystem::temp_directory_path() / name;
    write_text(path_.string(), yaml);
  }
  ~TemporaryScenario() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryScenario(const TemporaryScenario&) = delete;
  TemporaryScenario& operator=(const TemporaryScenario&) = delete;
  TemporaryScenario(TemporaryScenario&&) = delete;
  TemporaryScenario& operator=(TemporaryScenario&&) = delete;
  [[nodiscard]] std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

// The logger writes what it hears, so it listens once its file is no longer empty; until then
// SCENARIO is repeated, which also makes it the first event.
void start_logger(Supervisor& logger, const std::string& url, const std::string& log_path,
                  Announcer& announcer, const bus::Clock& clock) {
  std::error_code error;
  std::filesystem::remove(log_path, error);
  logger.start(logger_process(url, log_path));
  constexpr auto kPatience = std::chrono::seconds(5);
  const Time give_up = clock.now() + kPatience;
  while (true) {
    announcer.publish(clock.now());
    if (const auto ended = logger.find("lcm-logger")->wait(milliseconds(50))) {
      throw StartupError("lcm-logger ended at once (" + ended->describe() + "); can it write " +
                         log_path + " and use " + url + "?");
    }
    const auto size = std::filesystem::file_size(log_path, error);
    if (!error && size > 0) {
      return;
    }
    if (clock.now() > give_up) {
      throw StartupError("lcm-logger hears nothing on " + url);
    }
  }
}

/// The operator of an unattended trial, on the bus.
class Pilot {
 public:
  Pilot(bus::Bus& bus, const std::vector<std::string>& robots, Time start)
      : desk_(bus, true, start), program_(robots) {
    bus.subscribe<models::VehicleStatus>(
        bus::quadrotor_channel("*"),
        [this](const models::VehicleStatus& status) { program_.on_status(status); });
    bus.subscribe<models::OperatorCommand>(
        bus::kCommand, [this, own = bus.run_id()](const models::OperatorCommand& command) {
          if (command.stamp.run_id != own) {
            program_.on_other_station(command);
          }
        });
  }

  void tick(Time now) {
    if (desk_.tick(now) && !desk_.station().beats()) {
      print_line(std::string("! operator: ") + explain(desk_.station().role()));
    }
    if (desk_.station().role() == Station::Role::kListening) {
      return;
    }
    for (const FlightProgram::Order& order : program_.due(now)) {
      desk_.send(now, order.action, order.robot);  // refused while another station is in charge
    }
  }
  [[nodiscard]] FlightProgram& program() { return program_; }

 private:
  OperatorDesk desk_;
  FlightProgram program_;
};

std::unique_ptr<Pilot> pilot_for(const models::Scenario& scenario, bus::Bus& bus, Time start) {
  for (const models::RobotSpec& robot : scenario.robots) {
    if (robot.device == models::DeviceSource::kReal) {
      throw StartupError("robot " + robot.name +
                         " is real: a person arms it, with `vantage console`, not --fly");
    }
  }
  return std::make_unique<Pilot>(bus, robots_with_driver(scenario), start);
}

}  // namespace

UpResult run_up(const models::Scenario& scenario, const UpOptions& options,
                const std::function<bool()>& stop) {
  if (const auto faults = device_faults(scenario); !faults.empty()) {
    throw StartupError(faults.front());
  }
  const std::string& url = scenario.network.url;
  const auto transport = bus::open_transport(url);
  bus::Bus bus(*transport, bus::random_run_id());
  const bus::SystemClock clock;
  Announcer announcer(bus, scenario, "up");
  const TemporaryScenario file(scenario.source_text);

  // Destroyed in reverse order, also when starting fails half-way: the logger is last to go.
  Supervisor logger(RestartPolicy{.restarts_max = 0});
  if (!options.log_path.empty()) {
    start_logger(logger, url, options.log_path, announcer, clock);
  }
  const Time start = clock.now();
  TrialObserver observer(bus, scenario, start);
  announcer.publish(start);
  const std::unique_ptr<Pilot> pilot = options.fly ? pilot_for(scenario, bus, start) : nullptr;
  Supervisor team(options.restarts);
  for (const ProcessSpec& process : process_plan(
           scenario, {options.executables, file.path(), url, options.has_virtual_targets})) {
    team.start(process);
  }

  const auto turn = [&] {
    bus.handle(milliseconds(pilot ? 10 : 50));
    announcer.tick(clock.now());
    if (pilot) {
      pilot->tick(clock.now());
    }
    for (const auto& events : {team.poll(monotonic_ns()), logger.poll(monotonic_ns())}) {
      for (const std::string& event : events) {
        print_line("! " + event);
      }
    }
  };
  const Time end = start + from_seconds(scenario.duration_s);
  Time next_line = start;
  while (!stop() && clock.now() < end) {
    turn();
    if (!options.quiet && clock.now() >= next_line) {
      print_line(status_line(observer.metrics(), to_seconds(clock.now() - start)));
      next_line += std::chrono::seconds(5);
    }
  }

  UpResult result;
  result.summary = observer.metrics().finish(clock.now());
  if (pilot) {
    FlightProgram& program = pilot->program();
    program.bring_down();
    const Time give_up = clock.now() + kLandingPatience;
    while (!program.is_down() && clock.now() < give_up) {
      turn();
    }
    result.left_flying = program.not_down();
    for (const std::string& robot : robots_with_driver(scenario)) {
      if (program.have_flown().count(robot) == 0) {
        result.never_flown.push_back(robot);
      }
    }
  }
  result.restarts = team.restarts();
  result.any_given_up = team.any_given_up() || logger.any_given_up();
  result.killed = team.stop_all(milliseconds(1500));
  while (bus.handle(milliseconds(50)) > 0) {  // the last HEALTH of each
  }
  for (const std::string& name : logger.stop_all(milliseconds(500))) {
    result.killed.push_back(name);
  }
  const logs::TrialMetrics& heard = observer.metrics();
  result.summary.collisions = heard.collisions();
  result.summary.separation_violations = heard.separation_violations();
  result.summary.messages_lost =
      heard.messages_lost() + bus.messages_lost() + transport->stats().queue_overflows;
  return result;
}

}  // namespace vantage::tools

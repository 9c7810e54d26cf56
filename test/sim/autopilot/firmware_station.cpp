#include "test/sim/autopilot/firmware_station.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/deadline.hpp"
#include "sim/firmware/ardupilot_link.hpp"
#include "sim/firmware/px4_link.hpp"
#include "tools/up/process_plan.hpp"

namespace vantage::test {
namespace {

constexpr const char* kDriverUrl = "udp://127.0.0.1:14540";
constexpr Duration kStartMax{30'000'000};
constexpr Duration kPatience{200'000};
constexpr int kUnansweredMax = 5'000;
constexpr Duration kGlance{15'000};
constexpr double kGustMps = 0.1;

std::unique_ptr<sim::FirmwareLink> link_to(models::AutopilotDialect dialect) {
  if (dialect == models::AutopilotDialect::kArdupilot) {
    return std::make_unique<sim::ArdupilotLink>(0);
  }
  return sim::Px4Link::listening(0);
}

sim::MultirotorParameters parameters() {
  sim::MultirotorParameters out;
  out.gust_sigma_mps = kGustMps;
  return out;
}

tools::ProcessSpec process_for(models::AutopilotDialect dialect, const std::string& binary,
                               const std::string& folder) {
  scenario::Scenario scenario;
  scenario::RobotSpec robot;
  robot.name = "FIRMWARE";
  robot.device = scenario::DeviceSource::kWire;
  robot.autopilot.emplace();
  robot.autopilot->dialect = dialect;
  robot.autopilot->url = kDriverUrl;
  robot.autopilot->system_id = 1;
  robot.firmware.emplace();
  robot.firmware->binary = binary;
  robot.firmware->instance = 0;
  scenario.robots.push_back(robot);
  tools::ProcessSettings settings;
  settings.firmware_folder = folder;
  for (const tools::ProcessSpec& process : tools::process_plan(scenario, settings)) {
    if (process.name == "firmware FIRMWARE") {
      return process;
    }
  }
  throw StartupError("no plan for the firmware");
}

}  // namespace

FirmwareStation::FirmwareStation(models::AutopilotDialect spoken, const std::string& binary,
                                 const std::string& folder, std::uint64_t seed)
    : ScriptedStation(spoken),
      link_(link_to(spoken)),
      port_(drivers::open_port(kDriverUrl)),
      body_(parameters(), seed, Pose2{}),
      board_(sim::SensorNoise{}, seed),
      begun_ns_(monotonic_ns()) {
  const tools::ProcessSpec process = process_for(spoken, binary, folder);
  std::filesystem::create_directories(process.folder);
  for (const auto& [name, text] : process.files) {
    std::ofstream(process.folder + "/" + name) << text;
  }
  for (const std::string& word : process.arguments) {
    command_line_ += (command_line_.empty() ? "" : " ") + word;
  }
  ChildOptions options;
  options.folder = process.folder;
  options.end_signal = SIGKILL;
  options.output = ::open((process.folder + "/output.txt").c_str(),
                          O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  Result<Child> child = Child::start(process.arguments, options);
  ::close(options.output);
  if (!child.ok()) {
    throw StartupError(child.error().message);
  }
  child_.emplace(std::move(child).value());
  // The clock of the drill starts with the first message of the firmware.
  while (!has_answered_) {
    if (monotonic_ns() - begun_ns_ > kStartMax.count() * 1'000) {
      throw StartupError("the firmware says nothing");
    }
    step();
  }
  begun_ns_ = monotonic_ns();
  elapsed_at_start_ = elapsed_;
  seen_ = body();
}

ScriptedStation::Body FirmwareStation::body() const {
  return {now, body_.world_from_body(), body_.velocity_world_mps()};
}

void FirmwareStation::step() {
  // PX4 does not answer sensor messages while it starts, or in Offboard without set-points.
  const bool is_expected = has_answered_ && unanswered_ == 0;
  const std::optional<sim::MotorCommand> command =
      link_->receive(is_expected ? kPatience : kGlance);
  unanswered_ = command ? 0 : unanswered_ + 1;
  if (has_answered_ && unanswered_ > kUnansweredMax) {
    throw std::runtime_error("the firmware has fallen silent");
  }
  if (command) {
    has_answered_ = true;
    throttles_ = command->throttles;
  }
  body_.step(throttles_, to_seconds(link_->period()));
  elapsed_ += link_->period();
  link_->send(board_.sample(body_, elapsed_));
}

void FirmwareStation::transmit(std::span<const std::uint8_t> bytes) { port_->write(bytes, now); }

void FirmwareStation::pass() {
  // Advances the body to `now`. The cameras see the body one step before the tick.
  const Duration until = elapsed_at_start_ + (now - kBoot);
  while (elapsed_ < until) {
    step();
    if (elapsed_ + link_->period() == until) {
      seen_ = {now - link_->period(), body_.world_from_body(), body_.velocity_world_mps()};
    }
  }
  const std::int64_t due_ns = begun_ns_ + (now - kBoot).count() * 1'000;
  if (const std::int64_t early_ns = due_ns - monotonic_ns(); early_ns > 0) {
    std::this_thread::sleep_for(std::chrono::nanoseconds(early_ns));
  }
  while (const std::size_t size = port_->read(buffer_, now)) {
    receive(std::span<const std::uint8_t>(buffer_.data(), size));
  }
}

}  // namespace vantage::test

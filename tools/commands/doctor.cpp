#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/process.hpp"
#include "scenario/mocap_spec.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/doctor/vicon_doctor.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct DoctorArguments {
  std::string device;
  std::string host;
  std::vector<int> ports;
  int udp_port = scenario::default_port(scenario::MocapProtocol::kObjectStream);
  double listen_s = 2.0;
  bool as_json = false;
};

nlohmann::ordered_json to_json(const std::vector<ViconPort>& ports) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const ViconPort& port : ports) {
    nlohmann::ordered_json entry{{"port", port.port},
                                 {"answers", port.answer == Answer::kSpeech},
                                 {"speaker", wire::vicon::name_of(port.speaker)}};
    if (port.observed) {
      entry["frames"] = port.observed->frames;
      entry["rate_hz"] = port.observed->rate_hz;
      entry["latency_s"] = port.observed->latency_s;
      for (const auto& [name, body] : port.observed->bodies) {
        entry["bodies"][name] = {{"frames", body.frames}, {"seen", body.seen}};
        if (body.rate_hz > 0.0) {
          entry["bodies"][name]["rate_hz"] = body.rate_hz;
        }
      }
      entry["troubles"] = port.observed->troubles;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

int run(const DoctorArguments& arguments) {
  if (arguments.device != "vicon") {
    throw StartupError("doctor: knows 'vicon', not '" + arguments.device + "'");
  }
  const std::vector<int> usual{scenario::default_port(scenario::MocapProtocol::kDataStream),
                               scenario::default_port(scenario::MocapProtocol::kVrpn)};
  const std::vector<ViconPort> ports =
      examine_vicon(arguments.host, arguments.ports.empty() ? usual : arguments.ports,
                    arguments.udp_port, from_seconds(arguments.listen_s), stop_requested);
  if (arguments.as_json) {
    print_json(nlohmann::ordered_json{
        {"host", arguments.host}, {"usable", is_usable(ports)}, {"ports", to_json(ports)}});
  } else {
    for (const std::string& line : describe(arguments.host, ports)) {
      print_line(line);
    }
  }
  if (stop_requested()) {
    fmt::print(stderr, "vantage: interrupted: not every port was listened to for {:g} s\n",
               arguments.listen_s);
    return 1;
  }
  return is_usable(ports) ? 0 : 1;
}

}  // namespace

void add_doctor_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand("doctor", "Say why there is no data from a device.");
  auto arguments = std::make_shared<DoctorArguments>();
  command->add_option("device", arguments->device, "what to examine: vicon")->required();
  command->add_option("host", arguments->host, "where it is")->required();
  command->add_option("--port", arguments->ports, "TCP ports to look at instead of 801 and 3883")
      ->check(number_between(1, 65535));
  command->add_option("--udp-port", arguments->udp_port, "of the object stream")
      ->check(number_between(1, 65535));
  command->add_option("--listen-s", arguments->listen_s, "to each stream")
      ->check(number_between(0.1, 60.0));
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Ctrl-C and SIGTERM end it at once; what it has heard by then is told.\n"
      "Exit code 0: some stream has bodies that are seen; 1: none, or interrupted; 2: no such "
      "host.\n"
      "Example:\n"
      "  vantage doctor vicon 192.168.1.10");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bus/node/clock.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "drivers/camera/folder_source.hpp"
#include "drivers/camera/image_source.hpp"
#include "drivers/natnet/natnet_session.hpp"
#include "drivers/qualisys/qtm_session.hpp"
#include "scenario/mocap_spec.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/text_file.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/doctor/camera_doctor.hpp"
#include "tools/doctor/vicon_doctor.hpp"
#include "tools/live/screen.hpp"

namespace vantage::tools {
namespace {

struct DoctorArguments {
  std::string device;
  std::string host;
  std::vector<int> ports;
  int udp_port = scenario::MocapProtocol::kObjectStream.default_port();
  double listen_s = 2.0;
  bool as_json = false;
  std::string calibration;  ///< path; only for a camera
  std::string family = "tag36h11";
  double size_m = 0.16;
};

nlohmann::ordered_json to_json(const CameraObservation& observed) {
  nlohmann::ordered_json out{{"usable", is_usable(observed)},   {"images", observed.images},
                             {"width", observed.width},         {"height", observed.height},
                             {"rate_hz", observed.rate_hz},     {"age_mean_s", observed.age_mean_s},
                             {"age_max_s", observed.age_max_s}, {"status", observed.status}};
  for (const auto& [id, tag] : observed.tags) {
    out["tags"][std::to_string(id)] = {{"images", tag.images}, {"distance_m", tag.distance_m}};
  }
  return out;
}

int run_camera(const DoctorArguments& arguments) {
  if (arguments.calibration.empty()) {
    throw StartupError(
        "doctor camera: the calibration is missing; expected --calibration FILE.yaml");
  }
  scenario::CameraSpec spec;
  spec.source = arguments.host;
  const models::CameraModel camera = scenario::parse_calibration(
      scenario::read_text_file(arguments.calibration), arguments.calibration);
  Result<std::unique_ptr<drivers::camera::TagDetector>> detector =
      drivers::camera::make_tag_detector(arguments.family);
  if (!detector.ok()) {
    throw StartupError(detector.error().message);
  }
  const std::string_view folder = scenario::kFolderSource;
  const bool is_folder = spec.source.starts_with(folder);
  const std::unique_ptr<drivers::camera::ImageSource> source =
      is_folder
          ? std::make_unique<drivers::camera::FolderSource>(spec.source.substr(folder.size()), true)
          : drivers::camera::open_source(spec, camera);
  CameraExamination examination;
  examination.size_m = arguments.size_m;
  examination.listen = from_seconds(arguments.listen_s);
  const bus::SteadyClock clock;
  const CameraObservation observed = examine_camera(
      *source, camera, *detector.value(), examination, [&] { return clock.now(); }, stop_requested);
  if (arguments.as_json) {
    print_json(to_json(observed));
  } else {
    for (const std::string& line : describe(camera, observed, !is_folder)) {
      print_line(line);
    }
  }
  return is_usable(observed) && !stop_requested() ? 0 : 1;
}

nlohmann::ordered_json to_json(const std::vector<ViconPort>& ports) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const ViconPort& port : ports) {
    nlohmann::ordered_json entry{{"port", port.port},
                                 {"answers", port.answer == Answer::kAccepted},
                                 {"speaker", wire::vicon::name_of(port.server_type)}};
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
      entry["troubles"] = port.observed->errors;
    }
    out.push_back(std::move(entry));
  }
  return out;
}

std::vector<ViconPort> examine_all_vicon(const DoctorArguments& arguments) {
  const std::vector<int> usual{scenario::MocapProtocol::kDataStream.default_port(),
                               scenario::MocapProtocol::kVrpn.default_port()};
  return examine_vicon(arguments.host, arguments.ports.empty() ? usual : arguments.ports,
                       arguments.udp_port, from_seconds(arguments.listen_s), stop_requested);
}

/// Examines one server at each of the given ports, or at the default port.
std::vector<ViconPort> examine_ports(const DoctorArguments& arguments,
                                     const drivers::vicon::SessionRow& row) {
  std::vector<ViconPort> out;
  for (const int port : arguments.ports.empty() ? std::vector<int>{0} : arguments.ports) {
    if (!stop_requested()) {
      out.push_back(examine_server(arguments.host, row, port, from_seconds(arguments.listen_s),
                                   stop_requested));
    }
  }
  return out;
}

std::vector<ViconPort> examine(const DoctorArguments& arguments) {
  if (arguments.device == "vicon") {
    return examine_all_vicon(arguments);
  }
  if (arguments.device == "natnet") {
    return examine_ports(arguments, drivers::natnet::natnet_row());
  }
  if (arguments.device == "qualisys") {
    return examine_ports(arguments, drivers::qualisys::qtm_row());
  }
  throw StartupError("doctor: unknown device '" + arguments.device +
                     "'; the devices are vicon, natnet, qualisys and camera");
}

int run(const DoctorArguments& arguments) {
  if (arguments.device == "camera") {
    return run_camera(arguments);
  }
  const std::vector<ViconPort> ports = examine(arguments);
  if (arguments.as_json) {
    print_json(nlohmann::ordered_json{
        {"host", arguments.host}, {"usable", is_usable(ports)}, {"ports", to_json(ports)}});
  } else {
    for (const std::string& line : describe(arguments.host, ports)) {
      print_line(line);
    }
  }
  if (stop_requested()) {
    fmt::print(stderr, "vantage: interrupted: some ports were observed for less than {:g} s\n",
               arguments.listen_s);
    return 1;
  }
  return is_usable(ports) ? 0 : 1;
}

}  // namespace

void add_doctor_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand("doctor", "Find out why no data arrives from a device.");
  auto arguments = std::make_shared<DoctorArguments>();
  command
      ->add_option("device", arguments->device,
                   "device to examine: vicon (or VRPN), natnet (OptiTrack), qualisys, camera")
      ->required();
  command
      ->add_option("host", arguments->host,
                   "host name or address of the device; of a camera: v4l2:DEVICE or folder:PATH")
      ->required();
  command
      ->add_option(
          "--port", arguments->ports,
          "ports to examine (default: vicon TCP 801 and 3883, natnet UDP 1510, qualisys TCP 22223)")
      ->check(number_between(1, 65535));
  command
      ->add_option("--udp-port", arguments->udp_port,
                   "UDP port of the Vicon object stream (default: 51001)")
      ->check(number_between(1, 65535));
  command
      ->add_option("--listen-s", arguments->listen_s,
                   "seconds to listen to each stream (default: 2)")
      ->check(number_between(0.1, 60.0));
  command->add_option("--calibration", arguments->calibration,
                      "camera only: calibration file of ROS or OpenCV");
  command->add_option("--family", arguments->family,
                      "camera only: family of the tags (default: tag36h11)");
  command
      ->add_option("--size-m", arguments->size_m,
                   "camera only: side of a tag's black square in metres (default: 0.16)")
      ->check(number_between(0.001, 10.0));
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Ctrl-C and SIGTERM end it at once; results up to then are printed.\n"
      "Exit code 0: a stream contains visible bodies, or a camera delivers images that fit its\n"
      "calibration; 1: otherwise, or interrupted; 2: unknown host or invalid calibration.\n"
      "Example:\n"
      "  vantage doctor vicon 192.168.1.10\n"
      "  vantage doctor natnet 192.168.1.20\n"
      "  vantage doctor camera v4l2:/dev/video0 --calibration left.yaml --size-m 0.2");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools

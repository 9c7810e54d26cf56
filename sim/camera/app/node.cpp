#include "sim/camera/app/node.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "core/write_file.hpp"
#include "models/exchange/counts.hpp"
#include "scenario/reader/camera_yaml.hpp"
#include "scenario/reader/localizer_yaml.hpp"

namespace vantage::sim {
namespace {

constexpr Duration kKept = std::chrono::seconds(2);
constexpr Duration kCleaning{500'000};

/// Creates `folder` and the folders above it that do not exist, and removes the images in it.
void prepare(const std::string& folder) {
  namespace fs = std::filesystem;
  const fs::path own = fs::path(folder).parent_path();
  if (::mkdir(own.c_str(), 0700) != 0 && errno != EEXIST) {
    throw StartupError(own.string() + ": cannot be created: " + std::strerror(errno));
  }
  struct stat state {};
  if (::lstat(own.c_str(), &state) != 0 || !S_ISDIR(state.st_mode) || state.st_uid != ::geteuid() ||
      (state.st_mode & 077U) != 0U) {
    throw StartupError(own.string() +
                       ": must be a folder that only this user can access; remove it");
  }
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) {
    throw StartupError(folder + ": cannot be created: " + std::strerror(errno));
  }
  std::error_code ignored;
  for (const fs::directory_entry& each : fs::directory_iterator(folder, ignored)) {
    fs::remove(each.path(), ignored);
  }
}

std::string pgm_of(const models::GrayImage& image) {
  std::string out =
      "P5\n" + std::to_string(image.width) + " " + std::to_string(image.height) + "\n255\n";
  out.append(image.pixels.begin(), image.pixels.end());
  return out;
}

}  // namespace

CameraEmulatorNode::CameraEmulatorNode(bus::Bus& bus, const bus::Clock& clock,
                                       std::unique_ptr<TagScene> scene)
    : clock_(clock),
      scene_(std::move(scene)),
      robot_(scene_->spec().robot),
      folder_(scene_->spec().simulated_folder),
      next_tick_(clock.now() + kCleaning) {
  prepare(folder_);
  bus.subscribe<models::TruthFrame>(bus::kTruth,
                                    [this](const models::TruthFrame& truth) { on_truth(truth); });
}

CameraEmulatorNode::~CameraEmulatorNode() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void CameraEmulatorNode::on_truth(const models::TruthFrame& truth) {
  const std::optional<models::GrayImage> image = scene_->image_of(truth);
  if (!image) {
    return;
  }
  const std::string path = folder_ + "/" + std::to_string(to_utime(truth.stamp.time)) + ".pgm";
  try {
    write_file(path, pgm_of(*image));
    written_.push_back({clock_.now(), path});
  } catch (const std::runtime_error&) {
    ++unwritten_;  // for example because the disk is full
  }
}

void CameraEmulatorNode::tick(Time now) {
  next_tick_ = now + kCleaning;
  while (!written_.empty() && now - written_.front().time > kKept) {
    std::error_code ignored;
    std::filesystem::remove(written_.front().path, ignored);
    written_.pop_front();
  }
}

std::vector<models::NamedCount> CameraEmulatorNode::counters() const {
  return models::nonzero({{"camera_emulator.images_unwritten", unwritten_}});
}

std::unique_ptr<bus::Node> start_camera_emulator(bus::Bus& bus, const bus::Clock& clock,
                                                 const scenario::Scenario& scenario,
                                                 const std::string& robot) {
  const std::optional<scenario::CameraSpec> spec = scenario::camera_of(scenario, robot);
  if (!spec || spec->source != scenario::kSimulatedSource) {
    throw StartupError(scenario.name + ": robot " + robot +
                       " has no camera with the source `simulated`");
  }
  const auto localizer = scenario::parse_localizer(scenario.source_text, scenario.name);
  return std::make_unique<CameraEmulatorNode>(
      bus, clock,
      std::make_unique<TagScene>(
          scenario, *spec, scenario::calibration_of(*spec),
          localizer ? localizer->landmarks : std::vector<scenario::LandmarkSpec>()));
}

}  // namespace vantage::sim

#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/write_file.hpp"
#include "logs/mrclam/mrclam_log.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "trial/observe/announcer.hpp"

namespace vantage::tools {
namespace {

struct ImportArguments {
  std::string folder;
  std::string output;
  bool force = false;
};

/// File with a temporary name, which is removed unless it is renamed.
class PartFile {
 public:
  explicit PartFile(std::string path) : path_(std::move(path)), part_(path_ + ".part") {}
  ~PartFile() {
    std::error_code error;
    std::filesystem::remove(part_, error);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  PartFile(PartFile&&) = delete;
  PartFile& operator=(PartFile&&) = delete;
  [[nodiscard]] const std::string& part() const { return part_; }
  /// Gives the file its final name. Returns an error, or "".
  [[nodiscard]] std::string keep() const {
    std::error_code error;
    std::filesystem::rename(part_, path_, error);
    return error ? path_ + ": cannot be written: " + error.message() : "";
  }

 private:
  std::string path_;
  std::string part_;
};

int import_mrclam(const ImportArguments& arguments) {
  std::error_code error;
  if (!arguments.force && std::filesystem::exists(arguments.output, error)) {
    throw StartupError(arguments.output +
                       ": exists already; choose another name, or overwrite it with --force");
  }
  require_writable(arguments.output);
  const logs::MrclamData data = [&] {
    const DefaultSignalScope reading;
    return logs::read_mrclam(arguments.folder);
  }();
  const PartFile file(arguments.output);
  OutputLog output(file.part(), {}, true);
  const std::int64_t events =
      logs::write_mrclam(data, trial::version(), output.sink(), stop_requested);
  std::string failure = output.finish();
  if (failure.empty() && stop_requested()) {
    failure = arguments.output + ": interrupted; the log was not written";
  }
  if (failure.empty()) {
    failure = file.keep();
  }
  if (!failure.empty()) {
    print_line("vantage: " + failure, stderr);
    return 1;
  }
  print_line(fmt::format("{}: {} events of {} robots and {} landmarks", arguments.output, events,
                         data.robots.size(), data.landmarks.size()));
  if (data.reordered > 0) {
    print_line(
        fmt::format("{} lines were out of order and have been sorted by time", data.reordered));
  }
  if (data.impossible > 0) {
    print_line(fmt::format("{} observations with an impossible range or bearing were left out",
                           data.impossible));
  }
  return 0;
}

}  // namespace

void add_log_import_command(CLI::App& log, Runner& chosen) {
  CLI::App* import = log.add_subcommand("import", "Convert recordings of other projects to logs.");
  import->require_subcommand(1);
  auto arguments = std::make_shared<ImportArguments>();
  CLI::App* command =
      import->add_subcommand("mrclam", "Convert a folder of the UTIAS MRCLAM data set to a log.");
  command
      ->add_option("folder", arguments->folder,
                   "folder with Barcodes.dat, Landmark_Groundtruth.dat, RobotN_Odometry.dat, "
                   "RobotN_Measurement.dat and RobotN_Groundtruth.dat")
      ->required();
  command->add_option("output", arguments->output, "log to write")->required();
  command->add_flag("--force", arguments->force, "overwrite the output file if it exists");
  command->footer(
      "The log contains the commands of robot N as ODOMETRY_RN, its observations as SIGHTINGS_RN\n"
      "(one message per camera frame), and the true poses as VICON. The landmarks are in the\n"
      "section localizer of the scenario. All times are those of the data set.\n"
      "Examples:\n"
      "  vantage log import mrclam MRCLAM_Dataset6 six.lcmlog\n"
      "  vantage log localize six.lcmlog --scenario mrclam");
  command->callback(
      [&chosen, arguments] { chosen = [arguments] { return import_mrclam(*arguments); }; });
}

}  // namespace vantage::tools

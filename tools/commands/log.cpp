#include "tools/commands/commands.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {

void add_log_command(CLI::App& root, Runner& run) {
  CLI::App* log = root.add_subcommand("log", "Inspect, repair, replay and convert LCM event logs.");
  log->require_subcommand(1);
  add_log_inspect_commands(*log, run);
  add_log_edit_commands(*log, run);
  add_log_metrics_commands(*log, run);
  add_log_fit_motion_command(*log, run);
  add_log_fit_ranges_command(*log, run);
  add_log_fit_sensor_command(*log, run);
  add_log_localize_command(*log, run);
  add_log_import_command(*log, run);
  add_log_replay_command(*log, run);
  add_log_export_command(*log, run);
  add_log_play_command(*log, run);
  add_log_record_command(*log, run);
}

}  // namespace vantage::tools

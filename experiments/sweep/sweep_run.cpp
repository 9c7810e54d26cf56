#include "experiments/sweep/sweep_run.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/child.hpp"
#include "core/cpu_time.hpp"
#include "core/write_file.hpp"
#include "experiments/sweep/report_page.hpp"
#include "experiments/sweep/row_files.hpp"
#include "experiments/sweep/worker_pool.hpp"

namespace vantage::experiments {
namespace {

// Runs the script with gnuplot. Returns a line that reports the result.
std::string draw(const std::string& directory, const std::string& script,
                 const std::function<bool()>& stop) {
  const std::string enter = "cd '" + directory + "'";
  const std::string path = std::filesystem::absolute(std::filesystem::path(directory) / script);
  Result<Child> child = Child::start({"gnuplot", "-e", enter, path});
  if (!child.ok()) {
    return "no figures: gnuplot is not installed (apt install gnuplot-nox)";
  }
  Child gnuplot = std::move(child).value();
  std::optional<ChildExit> ended;
  for (int tenths = 0; !ended && tenths < 1200 && !(stop && stop()); ++tenths) {
    ended = gnuplot.wait(std::chrono::milliseconds(100));
  }
  return ended && ended->is_success() ? "figures in " + directory
                                      : "no figures: gnuplot failed on " + path;
}

UnitRows run_unit(const Sweep& sweep, const Unit& unit, std::uint64_t seed) {
  const double start_s = thread_cpu_s();
  try {
    UnitRows rows = sweep.run(unit.setting, seed + static_cast<std::uint64_t>(unit.trial));
    rows.times_s.emplace_back("unit", thread_cpu_s() - start_s);
    return rows;
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("setting '{}', trial {}: {}",
                                         sweep.plan.settings[unit.setting].cells, unit.trial,
                                         error.what()));
  }
}

void write_tables(const Sweep& sweep, const Tables& tables, const std::string& directory) {
  for (const auto& [name, records] : tables) {
    write_file(directory + "/" + name + ".csv", csv_of(sweep.plan, name, records));
  }
}

std::vector<std::string> collect(const Sweep& sweep, const SweepIdentity& identity,
                                 const std::string& what, const std::string& directory,
                                 const std::function<bool()>& stop) {
  const StoredRows stored = read_rows(directory, sweep.plan, identity);
  const Tables tables = tables_of(sweep.plan, stored.done);
  const Summary summary = sweep.summarise(tables);
  write_tables(sweep, tables, directory);
  for (const auto& [name, text] : summary.files) {
    write_file(directory + "/" + name, text);
  }
  write_file(directory + "/report.md", report_page(identity, what, sweep.plan, summary));
  std::vector<std::string> lines = summary.lines;
  std::string times;
  for (const std::string& line : summary.time_lines) {
    lines.push_back(line);
    times += line + "\n";
  }
  write_file(directory + "/times.txt", times);
  finish_manifest(directory, identity, sweep.plan, stored.processes);
  if (!summary.figure_script.empty()) {
    const std::string script = identity.experiment + ".gp";
    write_file(directory + "/" + script, summary.figure_script);
    lines.push_back(draw(directory, script, stop));
  }
  lines.push_back(fmt::format("report in {}/report.md", directory));
  return lines;
}

void check_beginnings(const SweepPlan& plan, const std::vector<std::string>& beginnings) {
  for (const std::string& beginning : beginnings) {
    const auto is_begun = [&](const Setting& setting) {
      return begins_with_any(setting, {beginning});
    };
    if (std::ranges::none_of(plan.settings, is_begun)) {
      throw StartupError(
          fmt::format("no setting begins with '{}': columns are ({}), for example '{}'", beginning,
                      plan.setting_columns, plan.settings.front().cells));
    }
  }
}

// Returns the units of the share that are not yet in a file, and sets the progress.
std::vector<Unit> units_left(const Sweep& sweep, const SweepOptions& options,
                             const StoredRows& stored, SweepProgress& progress) {
  std::vector<Unit> left;
  for (const Unit& unit : units_of(sweep.plan, options.shard.value_or(Shard{}))) {
    if (!begins_with_any(sweep.plan.settings[unit.setting], options.only)) {
      continue;
    }
    ++progress.units;
    if (stored.done.contains(unit)) {
      ++progress.done;
    } else {
      left.push_back(unit);
    }
  }
  progress.done_before = progress.done;
  return left;
}

}  // namespace

SweepOutcome run_sweep(const Sweep& sweep, const SweepIdentity& identity, const std::string& what,
                       const SweepOptions& options) {
  check_beginnings(sweep.plan, options.only);
  claim_directory(options.directory, identity, sweep.plan);
  SweepOutcome outcome;
  SweepProgress& progress = outcome.progress;
  const std::vector<Unit> left =
      units_left(sweep, options, read_rows(options.directory, sweep.plan, identity), progress);
  if (!left.empty()) {
    RowWriter writer(options.directory, this_process(options.jobs, options.shard.value_or(Shard{})),
                     identity, sweep.plan);
    const auto start = std::chrono::steady_clock::now();
    const auto report_progress = [&] {
      progress.elapsed_s =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      progress.is_stopping = options.stop && options.stop();
      if (options.progress) {
        options.progress(progress);
      }
    };
    run_units(
        left, {options.jobs, options.stop, report_progress},
        [&](const Unit& unit) { return run_unit(sweep, unit, identity.seed); },
        [&](const Unit& unit, const UnitRows& rows) {
          writer.append(unit_line(sweep.plan, unit, rows));
          ++progress.done;
          report_progress();
        });
  }
  outcome.is_stopped = progress.done < progress.units;
  if (!outcome.is_stopped && !options.shard && !options.only.empty()) {
    const StoredRows stored = read_rows(options.directory, sweep.plan, identity);
    write_tables(sweep, tables_of(sweep.plan, stored.done), options.directory);
  } else if (!outcome.is_stopped && !options.shard) {
    outcome.lines = collect(sweep, identity, what, options.directory, options.stop);
  }
  return outcome;
}

}  // namespace vantage::experiments

#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/check.hpp"
#include "core/process.hpp"
#include "core/write_file.hpp"
#include "logs/file/message_visit.hpp"
#include "logs/motion/motion_fit.hpp"
#include "models/target/law.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_plot.hpp"
#include "tools/log/log_scenario.hpp"
#include "tools/log/motion_plot.hpp"

namespace vantage::tools {
namespace {

struct FitArguments {
  std::vector<std::string> logs;
  double fitted_share = 0.7;
  std::string picture;  ///< path of the picture; empty: none
  bool as_json = false;
};

/// Returns the courses of the scenario's targets as measured by motion capture.
std::vector<logs::TargetCourse> courses_of(const logs::IndexedLog& log,
                                           const scenario::Scenario& scenario) {
  std::map<std::string, std::size_t> targets;
  for (const scenario::TargetSpec& target : scenario.targets) {
    targets.emplace(target.name, targets.size());
  }
  std::vector<logs::TargetCourse> courses(targets.size());
  logs::LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    logs::visit_message(*event, [&]<class Message>(const Message& message) {
      if constexpr (std::is_same_v<Message, models::MocapFrame>) {
        for (const models::MocapBody& body : message.bodies) {
          const auto target = targets.find(body.name);
          if (target != targets.end() && !body.occluded) {
            courses[target->second].add(message.stamp.time,
                                        body.world_from_body.translation_m.head<2>());
          }
        }
      }
    });
  }
  return courses;
}

/// Returns the model as YAML for a scenario file.
std::string yaml_of(const models::TargetModel& model) {
  if (!model.kind.law().uses_oscillator) {
    return fmt::format("{{kind: {}, q: {:.3g}}}", model.kind.name(), model.q);
  }
  const models::DampedOscillator& around = model.oscillator;
  const auto pair = [](const Eigen::Vector2d& of) {
    return fmt::format("[{:.3g}, {:.3g}]", of.x(), of.y());
  };
  return fmt::format(
      "{{kind: {}, position_sigma_m: {}, velocity_sigma_mps: {}, damping_per_s: {}}}",
      model.kind.name(), pair(around.position_sigma_m), pair(around.velocity_sigma_mps),
      pair(around.damping_per_s));
}

void print(const std::vector<logs::FittedMotion>& fits) {
  std::string head = fmt::format("{:<18} {:>8} {:>10}", "model", "fitted", "held out");
  for (const double horizon_s : logs::kHorizons_s) {
    head += fmt::format(" {:>7}", fmt::format("{:g} s", horizon_s));
  }
  print_line(head);
  const logs::FittedMotion* best = &fits.front();
  for (const logs::FittedMotion& fit : fits) {
    std::string line = fmt::format("{:<18} {:>8.3f} {:>10.3f}", fit.model.kind.name(),
                                   fit.fitted.nats, fit.held_back.nats);
    for (const double nees : fit.held_back.nees) {
      line += fmt::format(" {:>7.2f}", nees);
    }
    print_line(line);
    best = fit.held_back.nats > best->held_back.nats ? &fit : best;
  }
  print_line("");
  for (const logs::FittedMotion& fit : fits) {
    print_line(fmt::format("target_model: {}{}", yaml_of(fit.model),
                           &fit == best ? "  # best on the held-out part of the recording" : ""));
  }
}

nlohmann::ordered_json fits_to_json(const std::vector<logs::FittedMotion>& fits) {
  nlohmann::ordered_json json;
  json["horizons_s"] = logs::kHorizons_s;
  for (const logs::FittedMotion& fit : fits) {
    nlohmann::ordered_json one = {{"kind", fit.model.kind.name()},
                                  {"fitted_nats", fit.fitted.nats},
                                  {"held_back_nats", fit.held_back.nats},
                                  {"held_back_nees", fit.held_back.nees}};
    if (fit.model.kind.law().uses_oscillator) {
      const models::DampedOscillator& around = fit.model.oscillator;
      const auto pair = [](const Eigen::Vector2d& of) { return std::vector{of.x(), of.y()}; };
      one["center_m"] = pair(around.center_m);
      one["position_sigma_m"] = pair(around.position_sigma_m);
      one["velocity_sigma_mps"] = pair(around.velocity_sigma_mps);
      one["damping_per_s"] = pair(around.damping_per_s);
    } else {
      one["q"] = fit.model.q;
    }
    json["models"].push_back(one);
  }
  return json;
}

bool draw(const std::vector<logs::FittedMotion>& fits, const std::string& picture) {
  const std::string script = std::filesystem::path(picture).replace_extension(".gp");
  const Result<std::string> drawn = draw_plot(
      motion_plot_script(fits, "displacement of the targets in the held-out part", picture), script,
      picture);
  if (!drawn.ok()) {
    print_line("vantage: " + drawn.error().message, stderr);
  }
  return drawn.ok();
}

int fit(const FitArguments& arguments) {
  if (!arguments.picture.empty()) {
    static_cast<void>(plot_terminal(arguments.picture));  // checks the name before reading logs
    require_writable(arguments.picture);
  }
  const DefaultSignalScope reading;
  std::vector<std::vector<logs::TargetCourse>> courses;
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();
  for (const std::string& path : arguments.logs) {
    const logs::IndexedLog log(path, progress_line("reading"));
    const scenario::Scenario scenario = scenario_of(log);
    const models::Rectangle& bounds = scenario.world.bounds;
    center_m = 0.5 * (bounds.min_m + bounds.max_m);
    courses.push_back(courses_of(log, scenario));
  }
  const std::vector<logs::FittedMotion> fits =
      logs::fit_motion(courses, center_m, arguments.fitted_share);
  if (arguments.as_json) {
    print_json(fits_to_json(fits));
  } else {
    print(fits);
  }
  return arguments.picture.empty() || draw(fits, arguments.picture) ? 0 : 1;
}

}  // namespace

void add_log_fit_motion_command(CLI::App& log, Runner& chosen) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* command = log.add_subcommand(
      "fit-motion",
      "Fit motion models to the targets' recorded motion, for estimator.target_model.");
  command
      ->add_option("log", arguments->logs,
                   "LCM event logs of the same world, with VICON and SCENARIO")
      ->required();
  command
      ->add_option(
          "--fitted-share", arguments->fitted_share,
          "share of each log's duration, from its start, used for the fit; the rest tests it")
      ->check(CLI::Range(0.1, 0.9))
      ->capture_default_str();
  command->add_option(
      "--out", arguments->picture,
      "also plot the measured and predicted displacement of the targets: .png, .svg or "
      ".pdf (needs gnuplot); the script is written next to it (.gp)");
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(
      "Each model predicts a target's position 0.5 to 8 s ahead from its position and velocity.\n"
      "'fitted' and 'held out' are the mean log likelihood of a position in nats (higher is\n"
      "better), in the time used for the fit and in the rest. The other columns are the NEES of\n"
      "predictions this far ahead in the rest; a consistent model has 2.\n"
      "Examples:\n"
      "  vantage log fit-motion flight.lcmlog --out motion.png\n"
      "  vantage log fit-motion trial_*.lcmlog --json");
  command->callback([&chosen, arguments] { chosen = [arguments] { return fit(*arguments); }; });
}

}  // namespace vantage::tools

#include <memory>

#include "core/process.hpp"
#include "logs/file/log_index.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/log/log_scenario.hpp"
#include "tools/log/log_text.hpp"

namespace vantage::tools {
namespace {

struct LookArguments {
  std::string log;
  bool as_json = false;
};

std::string flown_by(const logs::IndexedLog& log) {
  const auto notice = find_scenario_notice(log);
  return notice ? "version " + notice->version + ", " + notice->process : "";
}

int info(const LookArguments& arguments) {
  const DefaultSignalScope reading;
  const logs::IndexedLog log(arguments.log, progress_line("reading"));
  if (arguments.as_json) {
    nlohmann::ordered_json json = to_json(arguments.log, log.survey());
    json["flown_by"] = flown_by(log);
    print_json(json);
    return 0;
  }
  for (const std::string& line : describe_content(arguments.log, log.survey(), flown_by(log))) {
    print_line(line);
  }
  if (log.survey().scan.events == 0) {
    print_line("contains no event of an LCM log");
  } else if (!log.survey().is_whole()) {
    print_line("damaged; `vantage log check` lists the damage");
  }
  return 0;
}

int check(const LookArguments& arguments) {
  const DefaultSignalScope reading;
  const logs::MappedFile file(arguments.log);
  const logs::LogSurvey survey = logs::survey_log(file.bytes(), progress_line("reading"));
  if (arguments.as_json) {
    print_json(to_json(arguments.log, survey));
  } else {
    for (const std::string& line : describe_damage(survey)) {
      print_line(arguments.log + ": " + line);
    }
    print_line(std::string(survey.is_whole() ? "whole" : "damaged") + ", " +
               std::to_string(survey.scan.events) + " events");
  }
  return survey.is_whole() ? 0 : 1;
}

void add(CLI::App& log, Runner& chosen, const char* name, const char* what, const char* footer,
         int (*action)(const LookArguments&)) {
  CLI::App* command = log.add_subcommand(name, what);
  auto arguments = std::make_shared<LookArguments>();
  command->add_option("log", arguments->log, "LCM event log")->required();
  command->add_flag("--json", arguments->as_json, "print one JSON object");
  command->footer(footer);
  command->callback([&chosen, arguments, action] {
    chosen = [arguments, action] { return action(*arguments); };
  });
}

}  // namespace

void add_log_inspect_commands(CLI::App& log, Runner& run) {
  add(log, run, "info",
      "Show the content of a log: time span, version, and each channel's rate, gaps and size.",
      "The first command on a log reads all of it and writes the index LOG.index for later ones.\n"
      "Example:\n"
      "  vantage log info flight.lcmlog",
      info);
  add(log, run, "check", "Check a log for damage and list it.",
      "Exit code 0: intact; 1: damaged; 2: file cannot be read. Messages that were lost before\n"
      "they were logged are listed, but do not count as damage.\n"
      "Example:\n"
      "  vantage log check flight.lcmlog",
      check);
}

}  // namespace vantage::tools

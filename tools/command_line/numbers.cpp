#include "tools/command_line/numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scenario/reader/value.hpp"

namespace vantage::tools {
namespace {

std::optional<double> number_in(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  const bool is_number =
      error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_number ? std::optional(value) : std::nullopt;
}

template <class Rule>
CLI::Validator number_that(const std::string& what, Rule holds) {
  return CLI::Validator(
      [what, holds](const std::string& text) -> std::string {
        const std::optional<double> value = number_in(text);
        if (!value) {
          return "'" + text + "' is not a number";
        }
        return holds(*value) ? "" : "must be " + what + ", is " + text;
      },
      "NUMBER");
}

// Returns the command that `words` choose. Sets `used` to the number of words that name the
// command.
const CLI::App* chosen_command(const CLI::App& root, const std::vector<std::string>& words,
                               std::size_t& used) {
  const CLI::App* app = &root;
  for (used = 0; used < words.size(); ++used) {
    const auto commands = app->get_subcommands([](const CLI::App*) { return true; });
    const auto next = std::find_if(commands.begin(), commands.end(), [&](const CLI::App* each) {
      return each->check_name(words[used]);
    });
    if (next == commands.end()) {
      break;
    }
    app = *next;
  }
  return app;
}

std::string meant(const std::string& word, const std::vector<std::string>& known) {
  const std::vector<std::string_view> views(known.begin(), known.end());
  const std::string nearest = scenario::nearest_word(word, views);
  return nearest.empty() ? "available: " + scenario::comma_separated(views)
                         : "did you mean '" + nearest + "'?";
}

}  // namespace

CLI::Validator any_number() {
  return number_that("", [](double) { return true; });
}

CLI::Validator positive_number() {
  return number_that("above 0", [](double value) { return value > 0.0; });
}

CLI::Validator non_negative_number() {
  return number_that("0 or more", [](double value) { return value >= 0.0; });
}

CLI::Validator number_between(double min, double max) {
  return number_that(fmt::format("from {:.15g} to {:.15g}", min, max),
                     [min, max](double value) { return value >= min && value <= max; });
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return CLI::Validator(
      [words](const std::string& text) -> std::string {
        const bool is_known = std::find(words.begin(), words.end(), text) != words.end();
        return is_known ? "" : "unknown value '" + text + "'; " + meant(text, words);
      },
      fmt::format("{{{}}}", fmt::join(words, ",")));
}

CLI::Validator seed_number() {
  return CLI::Validator(
      [](const std::string& text) -> std::string {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        const bool is_seed = error == std::errc() && end == text.data() + text.size();
        return is_seed ? "" : "must be a whole number from 0 to 18446744073709551615, is " + text;
      },
      "SEED");
}

std::string unknown_command(const CLI::App& root, const std::vector<std::string>& words) {
  std::size_t used = 0;
  const CLI::App* app = chosen_command(root, words, used);
  std::vector<std::string> names;
  for (const CLI::App* each : app->get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
  }
  if (names.empty() || used == words.size() || words[used].starts_with('-')) {
    return "";
  }
  const std::string whole = app == &root ? "" : app->get_name() + " ";
  return fmt::format("unknown command '{}{}'; {}", whole, words[used], meant(words[used], names));
}

std::string unknown_option(const CLI::App& root, const std::vector<std::string>& words) {
  std::size_t used = 0;
  const CLI::App* app = chosen_command(root, words, used);
  std::vector<std::string> names;
  for (const CLI::Option* option : app->get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  for (; used < words.size() && words[used] != "--"; ++used) {
    const std::string word = words[used].substr(0, words[used].find('='));
    const bool is_option = word.starts_with("--");
    if (is_option && std::find(names.begin(), names.end(), word) == names.end()) {
      return fmt::format("'{}' has no option {}; {}", app->get_name(), word, meant(word, names));
    }
  }
  return "";
}

}  // namespace vantage::tools

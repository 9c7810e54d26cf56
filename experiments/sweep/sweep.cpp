#include "experiments/sweep/sweep.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

namespace vantage::experiments {

double Record::number(std::size_t column) const {
  const std::string text = column < cells.size() ? cells[column] : "";
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::runtime_error("a row contains '" + text + "' instead of a number");
  }
  return value;
}

std::vector<Unit> units_of(const SweepPlan& plan, const Shard& shard) {
  std::vector<Unit> units;
  for (int trial = 0; trial < plan.trials; ++trial) {
    std::size_t before = 0;  // number of units of the previous settings
    for (std::size_t setting = 0; setting < plan.settings.size(); ++setting) {
      const bool is_once = plan.settings[setting].is_once;
      const std::size_t number = before + static_cast<std::size_t>(trial);
      if ((!is_once || trial == 0) && number % static_cast<std::size_t>(shard.of) ==
                                          static_cast<std::size_t>(shard.number - 1)) {
        units.push_back({setting, trial});
      }
      before += is_once ? 1 : static_cast<std::size_t>(plan.trials);
    }
  }
  return units;
}

bool begins_with_any(const Setting& setting, const std::vector<std::string>& beginnings) {
  const std::string cells = setting.cells + ",";
  return beginnings.empty() || std::ranges::any_of(beginnings, [&](const std::string& beginning) {
           return cells.starts_with(beginning + ",");
         });
}

std::vector<std::string> cells_of(const std::string& text) {
  std::vector<std::string> cells(1);
  for (const char c : text) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

Tables tables_of(const SweepPlan& plan, const std::map<Unit, UnitRows>& done) {
  Tables tables;
  for (const auto& [name, columns] : plan.tables) {
    tables[name];
  }
  for (const auto& [unit, rows] : done) {
    for (const auto& [name, lines] : rows.tables) {
      for (const std::string& line : lines) {
        tables[name].push_back({unit, cells_of(line)});
      }
    }
    for (const auto& [part, cpu_s] : rows.times_s) {
      tables["times"].push_back({unit, {part, fmt::format("{:.6f}", cpu_s)}});
    }
  }
  return tables;
}

std::string csv_of(const SweepPlan& plan, const std::string& name,
                   const std::vector<Record>& records) {
  const auto columns = plan.tables.find(name);
  std::string text = fmt::format("{},trial,{}\n", plan.setting_columns,
                                 columns == plan.tables.end() ? "part,cpu_s" : columns->second);
  for (const Record& record : records) {
    text += fmt::format("{},{},{}\n", plan.settings[record.unit.setting].cells, record.unit.trial,
                        fmt::join(record.cells, ","));
  }
  return text;
}

}  // namespace vantage::experiments

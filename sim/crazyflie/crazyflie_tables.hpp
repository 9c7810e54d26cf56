#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "wire/crtp/tables.hpp"

namespace vantage::sim {

/// Parameter or log variable of an emulated Crazyflie.
struct CrazyflieVariable {
  const char* group = "";
  const char* name = "";
  wire::crtp::ValueType type = wire::crtp::ValueType::kU8;
  bool is_read_only = false;
  double value = 0.0;               ///< value of a parameter
  std::function<double()> measure;  ///< measures the value of a log variable
};

/// Parameters and log blocks of an emulated Crazyflie, with the replies of firmware 2026.08.
class CrazyflieTables {
 public:
  CrazyflieTables(std::vector<CrazyflieVariable> parameters, std::vector<CrazyflieVariable> logs)
      : parameters_(std::move(parameters)), logs_(std::move(logs)) {}

  /// Processes a packet for the ports of parameters and logs. Returns the reply; nullopt if the
  /// firmware sends none.
  std::optional<wire::crtp::Packet> receive(const wire::crtp::Packet& packet, Time now);
  /// Appends the log data that are due.
  void append_due(Time now, Time boot, std::vector<wire::crtp::Packet>& out);
  /// Deletes all log blocks, as the firmware does after radio silence.
  void forget_blocks() { blocks_.clear(); }

  /// Returns the value of a parameter.
  [[nodiscard]] double parameter(const std::string& full_name) const;
  void set_parameter(const std::string& full_name, double value);

 private:
  struct Block {
    std::vector<wire::crtp::LogVariable> variables;
    Duration period{};  ///< 0: stopped
    Time next{};
  };
  [[nodiscard]] std::optional<wire::crtp::Packet> table_reply(
      const wire::crtp::Packet& packet) const;
  std::optional<wire::crtp::Packet> parameter_reply(const wire::crtp::Packet& packet);
  std::uint8_t control_log(const wire::crtp::Packet& packet, Time now);
  std::uint8_t create_block(const wire::crtp::Packet& packet);
  std::uint8_t append_variables(const wire::crtp::Packet& packet, Block& block) const;

  std::vector<CrazyflieVariable> parameters_;
  std::vector<CrazyflieVariable> logs_;
  std::map<std::uint8_t, Block> blocks_;
};

}  // namespace vantage::sim

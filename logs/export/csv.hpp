#pragma once

#include <span>
#include <string>
#include <vector>

#include "bus/convert/wire_walk.hpp"
#include "core/time.hpp"

namespace vantage::logs {

/// Converter of messages of one type to lines of comma-separated values (RFC 4180).
///
/// A scalar is one column with its name. An array of constant size has one column per element
/// ("position_world_m_0"). The first array of structs of variable length becomes lines: one line
/// per element, with the member names after the array's name ("bodies.name") and the rest of the
/// message repeated. A message without elements is one line with these cells empty. Any other array
/// of variable length is one cell of JSON. The first column, log_utime, is the time at which the
/// message was logged. Non-finite numbers are empty cells.
class CsvTable {
 public:
  explicit CsvTable(const bus::WireSchema& schema);

  [[nodiscard]] std::string header() const;
  /// Returns the lines of one message (fingerprint included), each with a line end; empty if the
  /// data are not one message of this type.
  [[nodiscard]] std::string lines(Time logged, std::span<const std::uint8_t> data) const;

 private:
  const bus::WireSchema& schema_;
  const bus::WireField* rows_ = nullptr;  ///< field that becomes lines; null: none
};

}  // namespace vantage::logs

#pragma once

#include <span>
#include <string>
#include <vector>

#include "bus/convert/wire_walk.hpp"
#include "core/time.hpp"

namespace vantage::logs {

/// Messages of one type as lines of comma-separated values (RFC 4180).
///
/// A scalar is a column of its name, an array of constant size one column an element
/// ("position_world_m_0"). The first array of structs of changing length is laid out in lines: one
/// line an element, its members after its name ("bodies.name"), the rest of the message repeated; a
/// message without elements is one line with these cells empty. Any other array of changing length
/// is one cell of JSON. The first column, log_utime, is when the message was logged. What is not
/// finite is an empty cell.
class CsvTable {
 public:
  explicit CsvTable(const bus::WireSchema& schema);

  [[nodiscard]] std::string header() const;
  /// The lines of one message (fingerprint included), each with its end; empty when it is not one
  /// message of this type.
  [[nodiscard]] std::string lines(Time logged, std::span<const std::uint8_t> data) const;

 private:
  const bus::WireSchema& schema_;
  const bus::WireField* rows_ = nullptr;  ///< the field that is laid out in lines; may be none
};

}  // namespace vantage::logs

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bus/convert/wire_walk.hpp"
#include "core/time.hpp"

namespace vantage::logs {

/// Values of one field over all messages, in order. Integers of any width are std::int64_t,
/// floating-point numbers double, booleans and bytes std::uint8_t.
struct LogColumn {
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>,
                              std::vector<std::uint8_t>, std::vector<std::string>>;
  std::string name;         ///< path of the field: "cost", "segments.duration_s"
  bool is_boolean = false;  ///< true: the values are booleans
  /// Shape of the array in each row if its size is constant; empty: one value per row.
  std::vector<std::size_t> item_shape;
  int list = -1;  ///< index of the list with one element per row; −1: one row per message
  Values values;
};

/// List of variable length within messages.
struct LogList {
  std::string name;  ///< "segments", or the name of its only column
  int parent = -1;  ///< index of the list whose elements contain this list; −1: messages contain it
  /// Row i of the parent has the elements [offsets[i], offsets[i + 1]).
  std::vector<std::int64_t> offsets{0};
};

/// Messages of one type as columns. It uses layouts that are generated from lcmtypes/, so a new
/// type needs no code here. The lists of all messages are concatenated, with offsets to separate
/// them; two-dimensional lists are stored row by row.
class LogColumns {
 public:
  explicit LogColumns(const bus::WireSchema& schema);

  /// Adds the message in `data` (fingerprint included). Returns false and adds nothing if the data
  /// are not exactly one message of this type.
  bool add(Time logged, std::span<const std::uint8_t> data);

  [[nodiscard]] std::vector<LogColumn>& columns() { return columns_; }
  [[nodiscard]] std::vector<LogList>& lists() { return lists_; }
  /// Returns the time at which each message was logged.
  [[nodiscard]] std::vector<std::int64_t>& logged_utime() { return logged_utime_; }

 private:
  /// Destination of the values of one field.
  struct Field {
    const bus::WireField* wire = nullptr;
    int column = -1;  ///< column of a number or text; −1: none
    int list = -1;    ///< list of an array of variable length or of structs; −1: none
    std::vector<Field> nested;
  };
  class Reader;

  std::vector<Field> plan(const bus::WireSchema& schema, const std::string& prefix, int list);

  const bus::WireSchema& schema_;
  std::vector<LogColumn> columns_;
  std::vector<LogList> lists_;
  std::vector<Field> fields_;  ///< destinations of the message's fields, from plan()
  std::vector<std::int64_t> logged_utime_;
};

}  // namespace vantage::logs

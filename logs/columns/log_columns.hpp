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

/// The values of one field over all messages, one after the other. Whole numbers of any width are
/// std::int64_t, floats double, booleans and bytes std::uint8_t.
struct LogColumn {
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>,
                              std::vector<std::uint8_t>, std::vector<std::string>>;
  std::string name;                     ///< "cost", "segments.duration_s"
  bool is_truth = false;                ///< of booleans
  std::vector<std::size_t> item_shape;  ///< of an array of constant size; empty: one value a row
  int list = -1;                        ///< whose elements its rows are; −1: the messages
  Values values;
};

/// A list of changing length within messages.
struct LogList {
  std::string name;  ///< "segments", or that of the one column it has
  int parent = -1;   ///< whose elements have such a list each; −1: the messages
  /// Elements of row i of the parent: [offsets[i], offsets[i + 1]).
  std::vector<std::int64_t> offsets{0};
};

/// Messages of one type as columns, from the layouts that are generated from lcmtypes/: a new type
/// needs nothing here. Lists are laid end to end, with offsets; two-dimensional ones row by row.
class LogColumns {
 public:
  explicit LogColumns(const bus::WireSchema& schema);

  /// Adds the message in `data` (fingerprint included). False, and nothing added, when it is not
  /// exactly one message of this type.
  bool add(Time logged, std::span<const std::uint8_t> data);

  [[nodiscard]] std::vector<LogColumn>& columns() { return columns_; }
  [[nodiscard]] std::vector<LogList>& lists() { return lists_; }
  /// When each message was logged.
  [[nodiscard]] std::vector<std::int64_t>& logged_utime() { return logged_utime_; }

 private:
  /// Where the values of one field go.
  struct Field {
    const bus::WireField* wire = nullptr;
    int column = -1;  ///< of numbers and text
    int list = -1;    ///< of what has a changing length, and of structs in any array
    std::vector<Field> nested;
  };
  class Reader;

  std::vector<Field> plan(const bus::WireSchema& schema, const std::string& prefix, int list);

  const bus::WireSchema& schema_;
  std::vector<LogColumn> columns_;
  std::vector<LogList> lists_;
  std::vector<Field> fields_;  ///< after what plan() fills
  std::vector<std::int64_t> logged_utime_;
};

}  // namespace vantage::logs

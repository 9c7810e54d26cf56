#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::tools {

/// Quantity in a column of a table.
enum class Quantity {
  kTime,    ///< converted to s; the file may have s, ms, us, ns, min
  kLength,  ///< converted to m; the file may have m, cm, mm, km, ft, in
  kName,    ///< text, not converted
};

/// Column to read, identified by its heading. A unit may follow the heading: `range_cm`,
/// `Range [cm]`, `range (cm)`. Without a unit the values are seconds (`utime`: microseconds) or
/// metres.
struct ColumnSpec {
  Quantity quantity = Quantity::kLength;
  std::vector<std::string_view> names;  ///< accepted names in lower case; messages use the first
};

struct TableRow {
  std::string name;             ///< text of the column kName; empty if there is none
  std::vector<double> numbers;  ///< values of the other columns in their order, in s or m
};

struct Table {
  std::vector<TableRow> rows;   ///< complete rows, in the file's order
  std::int64_t not_finite = 0;  ///< rows left out because a number is nan, inf or missing
  bool is_torn = false;         ///< the last line is incomplete and left out
};

/// Reads a table of comma-, semicolon-, tab- or space-separated cells. `name` is the file's name in
/// messages. A first line without a number is the header; without a header the file must have
/// exactly `columns`, in that order. Skips other columns, empty lines, lines that begin with # or
/// %, repetitions of the header, and a byte order mark. Accepts CRLF. A quoted cell may contain
/// separators, ends of lines and doubled quotes (RFC 4180).
/// @throws StartupError "FILE:LINE: …" with the found and the expected content.
Table parse_table(std::string_view text, const std::string& name,
                  std::span<const ColumnSpec> columns);

/// Reads a table from a file. @throws StartupError also if the file cannot be read or exceeds
/// 256 MiB.
Table read_table(const std::string& path, std::span<const ColumnSpec> columns);

}  // namespace vantage::tools

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vantage::tools {

/// What a column of a table holds.
enum class Quantity {
  kTime,    ///< seconds here; in the file also ms, us, ns, min
  kLength,  ///< metres here; in the file also cm, mm, km, ft, in
  kName,    ///< text
};

/// A column that is read, by what it may be called. A unit may follow: `range_cm`, `Range [cm]`,
/// `range (cm)`; without one it is seconds, metres, and of `utime` microseconds.
struct ColumnSpec {
  Quantity quantity = Quantity::kLength;
  std::vector<std::string_view> names;  ///< in small letters; the first is said to people
};

struct TableRow {
  std::string name;             ///< of the column that is kName; else empty
  std::vector<double> numbers;  ///< of the others, in their order; s and m
};

struct Table {
  std::vector<TableRow> rows;   ///< those that are whole, in the file's order
  std::int64_t not_finite = 0;  ///< rows left out: a number is nan, inf or not there
  bool is_torn = false;         ///< the last line ends in the middle, and is left out
};

/// Reads a table of comma-, semicolon-, tab- or space-separated cells; `name` stands for the file
/// in messages. A first line without any number is the header; without one the columns are those of
/// `columns`, in that order. Empty lines, those that begin with # or % and the header once more are
/// passed over; a byte order mark and CRLF are read; other columns are not. A cell in quotes may
/// have separators, ends of lines and doubled quotes in it (RFC 4180).
/// @throws StartupError "FILE:LINE: what it is and what was expected".
Table parse_table(std::string_view text, const std::string& name,
                  std::span<const ColumnSpec> columns);

/// The same of a file. @throws StartupError also when it cannot be read or is over 256 MiB.
Table read_table(const std::string& path, std::span<const ColumnSpec> columns);

}  // namespace vantage::tools

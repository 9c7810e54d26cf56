#include "logs/export/csv.hpp"

#include <functional>

#include "logs/export/csv_file.hpp"
#include "logs/file/wire_check.hpp"
#include "logs/json/wire_json.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::ordered_json;
using bus::WireField;
using bus::WireSchema;

std::string cell(const Json& value) {
  if (value.is_null()) {
    return "";
  }
  return csv_cell(value.is_string() ? value.get<std::string>() : dumped(value));
}

bool has_constant_size(const WireField& field) {
  return field.dims[0].field < 0 && field.dims[1].field < 0 && field.kind != bus::WireKind::kStruct;
}

using Cell = std::function<void(const std::string& name, const Json& value)>;

/// Calls `visit` once per column of `field`. If `value` is null, all cells are null.
void for_each_cell(const WireField& field, const std::string& name, const Json& value,
                   const Cell& visit) {
  if (field.rank == 0 || !has_constant_size(field)) {
    visit(name, value);
    return;
  }
  const auto count = [&](std::size_t dim) {
    return static_cast<std::size_t>(field.dims[dim].constant);
  };
  for (std::size_t i = 0; i < count(0); ++i) {
    const std::string element = name + "_" + std::to_string(i);
    const Json& row = value.is_null() ? value : value[i];
    if (field.rank == 1) {
      visit(element, row);
      continue;
    }
    for (std::size_t j = 0; j < count(1); ++j) {
      visit(element + "_" + std::to_string(j), row.is_null() ? row : row[j]);
    }
  }
}

/// Calls `visit` once per column of the table. If `message` or `element` is null, its
/// cells are null.
void for_each_column(const WireSchema& schema, const WireField* rows, const Json& message,
                     const Json& element, const Cell& visit) {
  const Json nothing;
  for (const WireField& field : schema.fields) {
    const std::string name(field.name);
    if (&field != rows) {
      for_each_cell(field, name, message.is_null() ? nothing : message.at(name), visit);
      continue;
    }
    for (const WireField& inner : field.nested->fields) {
      const std::string inner_name(inner.name);
      for_each_cell(inner, name + "." + inner_name,
                    element.is_null() ? nothing : element.at(inner_name), visit);
    }
  }
}

}  // namespace

CsvTable::CsvTable(const WireSchema& schema) : schema_(schema) {
  for (const WireField& field : schema.fields) {
    if (field.kind == bus::WireKind::kStruct && field.rank == 1 &&
        field.nested->name != "input_ref_t") {
      rows_ = &field;
      return;
    }
  }
}

std::string CsvTable::header() const {
  std::string out = "log_utime";
  for_each_column(schema_, rows_, {}, {},
                  [&](const std::string& name, const Json&) { out.append(1, ',').append(name); });
  return out + "\r\n";
}

std::string CsvTable::lines(Time logged, std::span<const std::uint8_t> data) const {
  if (type_of(data) != &schema_) {
    return "";
  }
  const auto message = message_json(data);
  if (!message) {
    return "";
  }
  std::string out;
  const auto add_line = [&](const Json& element) {
    out += std::to_string(to_utime(logged));
    for_each_column(schema_, rows_, *message, element, [&](const std::string&, const Json& value) {
      out.append(1, ',').append(cell(value));
    });
    out += "\r\n";
  };
  const Json elements = rows_ == nullptr ? Json::array() : message->at(std::string(rows_->name));
  for (const Json& element : elements) {
    add_line(element);
  }
  if (elements.empty()) {
    add_line({});
  }
  return out;
}

}  // namespace vantage::logs

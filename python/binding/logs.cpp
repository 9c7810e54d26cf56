#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include <pybind11/stl.h>

#include "core/check.hpp"
#include "core/index.hpp"
#include "logs/columns/log_columns.hpp"
#include "logs/file/log_index.hpp"
#include "logs/file/wire_check.hpp"
#include "python/binding/bind.hpp"

namespace vantage::python {
namespace {

// Returns a numpy array that takes ownership of the vector's memory, without a copy.
template <class Number>
py::array owning_array(std::vector<Number>&& values, const std::vector<std::size_t>& item_shape,
                       const py::dtype& type) {
  auto* kept = new std::vector<Number>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Number>*>(p); });
  std::size_t item = 1;
  for (const std::size_t n : item_shape) {
    item *= n;
  }
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(item == 0 ? 0 : kept->size() / item)};
  for (const std::size_t n : item_shape) {
    shape.push_back(static_cast<py::ssize_t>(n));
  }
  return py::array(type, shape, kept->data(), owner);
}

py::object column_array(logs::LogColumn& column) {
  if (auto* doubles = std::get_if<std::vector<double>>(&column.values)) {
    return owning_array(std::move(*doubles), column.item_shape, py::dtype::of<double>());
  }
  if (auto* integers = std::get_if<std::vector<std::int64_t>>(&column.values)) {
    return owning_array(std::move(*integers), column.item_shape, py::dtype::of<std::int64_t>());
  }
  if (auto* bytes = std::get_if<std::vector<std::uint8_t>>(&column.values)) {
    return owning_array(std::move(*bytes), column.item_shape,
                        column.is_boolean ? py::dtype::of<bool>() : py::dtype::of<std::uint8_t>());
  }
  const auto& texts = std::get<std::vector<std::string>>(column.values);
  py::list list(texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    // Names from a network may not be UTF-8; surrogateescape preserves their bytes.
    list[i] = py::reinterpret_steal<py::object>(PyUnicode_DecodeUTF8(
        texts[i].data(), static_cast<py::ssize_t>(texts[i].size()), "surrogateescape"));
  }
  return py::module_::import("numpy").attr("array")(list, py::arg("dtype") = "object");
}

class Log {
 public:
  explicit Log(const std::string& path) : log_(path) {}

  // Returns by channel: (type name or None, number of messages, first utime, last utime). Reads the
  // complete log.
  py::dict channels() const {
    struct Seen {
      const bus::WireSchema* type = nullptr;
      std::int64_t messages = 0;
      std::int64_t first_utime = 0;
      std::int64_t last_utime = 0;
    };
    std::map<std::string, Seen, std::less<>> seen;
    {
      const py::gil_scoped_release release;
      logs::LogScan scan = log_.scan();
      while (const auto event = scan.next()) {
        auto found = seen.find(event->channel);
        if (found == seen.end()) {
          found = seen.emplace(std::string(event->channel), Seen{}).first;
          found->second.first_utime = to_utime(event->time);
        }
        Seen& channel = found->second;
        channel.type = channel.type == nullptr ? logs::type_of(event->data) : channel.type;
        ++channel.messages;
        channel.last_utime = to_utime(event->time);
      }
    }
    py::dict out;
    for (const auto& [name, channel] : seen) {
      py::dict entry;
      entry["type"] = channel.type == nullptr
                          ? py::object(py::none())
                          : py::object(py::str(std::string(channel.type->name)));
      entry["messages"] = channel.messages;
      entry["first_utime"] = channel.first_utime;
      entry["last_utime"] = channel.last_utime;
      out[py::str(name)] = entry;
    }
    return out;
  }

  // Returns (columns, offsets, parents, log_utime, type name, refused) of one channel.
  py::tuple read(const std::string& channel, std::optional<std::int64_t> from_utime_us,
                 std::optional<std::int64_t> to_utime_us) const {
    std::unique_ptr<logs::LogColumns> columns;
    const bus::WireSchema* type = nullptr;
    std::int64_t refused = 0;
    bool was_found = false;
    {
      const py::gil_scoped_release release;
      logs::LogScan scan = log_.scan();
      while (const auto event = scan.next()) {
        if (event->channel != channel) {
          continue;
        }
        was_found = true;
        if (columns == nullptr) {
          type = logs::type_of(event->data);
          if (type != nullptr) {
            columns = std::make_unique<logs::LogColumns>(*type);
          }
        }
        const std::int64_t at = to_utime(event->time);
        if ((from_utime_us && at < *from_utime_us) || (to_utime_us && at >= *to_utime_us)) {
          continue;
        }
        refused += columns != nullptr && columns->add(event->time, event->data) ? 0 : 1;
      }
    }
    if (!was_found) {
      throw py::key_error(log_.path() + ": no channel " + channel);
    }
    if (columns == nullptr) {
      throw StartupError(log_.path() + ": " + channel + ": not a vantage message type");
    }
    py::dict values;
    py::dict offsets;
    py::dict parents;
    for (logs::LogColumn& column : columns->columns()) {
      values[py::str(column.name)] = column_array(column);
    }
    for (const logs::LogColumn& column : columns->columns()) {
      parents[py::str(column.name)] =
          column.list < 0 ? py::object(py::none())
                          : py::object(py::str(columns->lists()[index(column.list)].name));
    }
    for (logs::LogList& list : columns->lists()) {
      offsets[py::str(list.name)] =
          owning_array(std::move(list.offsets), {}, py::dtype::of<std::int64_t>());
    }
    return py::make_tuple(
        values, offsets, parents,
        owning_array(std::move(columns->logged_utime()), {}, py::dtype::of<std::int64_t>()),
        std::string(type->name), refused);
  }

  [[nodiscard]] const std::string& path() const { return log_.path(); }
  [[nodiscard]] std::int64_t damaged_bytes() const {
    const py::gil_scoped_release release;
    logs::LogScan scan = log_.scan();
    while (scan.next()) {
    }
    return static_cast<std::int64_t>(scan.counts().bytes_damaged);
  }

 private:
  logs::IndexedLog log_;
};

}  // namespace

void bind_logs(py::module_& module) {
  py::class_<Log>(module, "_Log", "See vantage.Log.")
      .def(py::init([](const py::object& path) {
             const std::string name = path_text(path);
             const py::gil_scoped_release release;
             return std::make_unique<Log>(name);
           }),
           py::arg("path"))
      .def_property_readonly("path", &Log::path)
      .def("channels", &Log::channels)
      .def("damaged_bytes", &Log::damaged_bytes)
      .def("read", &Log::read, py::arg("channel"), py::arg("from_utime") = py::none(),
           py::arg("to_utime") = py::none());
}

}  // namespace vantage::python

#include "drivers/camera/folder_source.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/camera/image_file.hpp"

namespace vantage::drivers::camera {
namespace {

constexpr std::size_t kTimeDigitsMin = 10;
constexpr std::size_t kTimeDigitsMax = 18;
constexpr std::size_t kFileBytesMax = std::size_t{256} << 20U;
constexpr std::size_t kTimesMax = 1'000'000;
constexpr const char* kTimesName = "times.csv";

bool is_image_name(const std::string& name) {
  return name.ends_with(".pgm") || name.ends_with(".png");
}

std::optional<Time> time_of(const std::string& digits) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc{} && end == digits.data() + digits.size()
             ? std::optional(from_utime(value))
             : std::nullopt;
}

/// Returns the content of a regular file; nullopt if it cannot be read or is too large.
std::optional<std::vector<std::uint8_t>> bytes_of(const std::string& path) {
  // Without O_NONBLOCK, opening a pipe in the folder would block.
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file < 0) {
    return std::nullopt;
  }
  struct stat state {};
  std::optional<std::vector<std::uint8_t>> out;
  if (::fstat(file, &state) == 0 && S_ISREG(state.st_mode) && state.st_size > 0 &&
      static_cast<std::size_t>(state.st_size) <= kFileBytesMax) {
    out.emplace(static_cast<std::size_t>(state.st_size));
    std::size_t done = 0;
    while (done < out->size()) {
      const ssize_t count = ::read(file, out->data() + done, out->size() - done);
      if (count <= 0) {
        break;
      }
      done += static_cast<std::size_t>(count);
    }
    out->resize(done);
  }
  ::close(file);
  return out;
}

}  // namespace

std::optional<Time> time_in_name(const std::string& name) {
  std::optional<Time> out;
  std::string digits;
  for (std::size_t i = 0; i <= name.size(); ++i) {
    if (i < name.size() && std::isdigit(static_cast<unsigned char>(name[i])) != 0) {
      digits += name[i];
      continue;
    }
    if (digits.size() >= kTimeDigitsMin && digits.size() <= kTimeDigitsMax) {
      out = time_of(digits);
    }
    digits.clear();
  }
  return out;
}

FolderSource::FolderSource(std::string folder, bool reads_present)
    : folder_(std::move(folder)),
      reads_present_(reads_present),
      status_("folder " + folder_ + " is not open yet") {}

FolderSource::~FolderSource() { close(); }

void FolderSource::close() {
  if (inotify_ >= 0) {
    ::close(inotify_);
    inotify_ = -1;
  }
}

void FolderSource::open(Time now) {
  if (now < next_try_) {
    return;
  }
  next_try_ = now + kReopenPeriod;
  const int watcher = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  constexpr std::uint32_t kEvents =
      IN_CLOSE_WRITE | IN_MOVED_TO | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
  if (watcher < 0 || ::inotify_add_watch(watcher, folder_.c_str(), kEvents) < 0) {
    status_ = "folder " + folder_ + " cannot be read: " + std::strerror(errno) +
              "; create it, or correct `source`";
    if (watcher >= 0) {
      ::close(watcher);
    }
    return;
  }
  inotify_ = watcher;
  status_ = "folder " + folder_ + " is open";
  read_times();
  if (reads_present_) {
    add_present();
  }
}

void FolderSource::add(const std::string& name) {
  if (!is_image_name(name)) {
    return;
  }
  if (!reads_present_ && waiting_.size() == kWaitingMax) {
    waiting_.pop_front();
    ++counts_.lost;
  }
  waiting_.push_back(name);
}

void FolderSource::add_present() {
  std::set<std::string> names;
  std::error_code failed;
  for (std::filesystem::directory_iterator each(folder_, failed), end; !failed && each != end;
       each.increment(failed)) {
    names.insert(each->path().filename().string());
  }
  for (const std::string& name : names) {
    add(name);
  }
}

void FolderSource::read_times() {
  std::ifstream file(folder_ + "/" + kTimesName);
  for (std::string line; times_.size() < kTimesMax && std::getline(file, line);) {
    const std::size_t comma = line.find(',');
    if (comma != std::string::npos) {
      std::string digits = line.substr(comma + 1);
      digits.erase(digits.find_last_not_of(" \r") + 1);
      if (const std::optional<Time> time = time_of(digits)) {
        times_[line.substr(0, comma)] = *time;
      }
    }
  }
}

void FolderSource::read_events() {
  alignas(inotify_event) std::array<char, 64 * (sizeof(inotify_event) + NAME_MAX + 1)> buffer;
  ssize_t size = 0;
  bool is_gone = false;
  while ((size = ::read(inotify_, buffer.data(), buffer.size())) > 0) {
    for (std::size_t at = 0; at + sizeof(inotify_event) <= static_cast<std::size_t>(size);) {
      inotify_event event{};
      std::memcpy(&event, buffer.data() + at, sizeof event);
      if (event.len > 0) {
        add(std::string(buffer.data() + at + sizeof event));
      }
      if ((event.mask & IN_Q_OVERFLOW) != 0U) {
        ++counts_.lost;  // counts as one, since the number of lost files is unknown
      }
      is_gone =
          is_gone || (event.mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_IGNORED | IN_UNMOUNT)) != 0U;
      at += sizeof event + event.len;
    }
  }
  if (is_gone) {
    ++counts_.interruptions;
    status_ = "folder " + folder_ + " was removed";
    close();
  }
}

std::optional<CapturedImage> FolderSource::read(const std::string& name) {
  const auto listed = times_.find(name);
  const std::optional<Time> time =
      listed != times_.end() ? std::optional(listed->second) : time_in_name(name);
  if (!time) {
    ++counts_.unstamped;
    status_ =
        name + " has no time: write it into the name or into " + kTimesName + ", in µs since 1970";
    return std::nullopt;
  }
  const auto bytes = bytes_of(folder_ + "/" + name);
  Result<models::GrayImage> image =
      bytes ? decode_image(*bytes)
            : Result<models::GrayImage>(Error{"the file cannot be read, or is empty or too large"});
  if (!image.ok()) {
    ++counts_.undecodable;
    status_ = name + ": " + image.error().message;
    return std::nullopt;
  }
  return CapturedImage{*time, std::move(image).value()};
}

std::optional<CapturedImage> FolderSource::next(Time now) {
  if (inotify_ < 0) {
    open(now);
  }
  if (inotify_ >= 0) {
    read_events();
  }
  while (!waiting_.empty()) {
    const std::string name = std::move(waiting_.front());
    waiting_.pop_front();
    if (auto image = read(name)) {
      return image;
    }
  }
  return std::nullopt;
}

}  // namespace vantage::drivers::camera

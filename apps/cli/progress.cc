#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <utility>
#include <vector>

namespace rigfit::apps {
namespace {
using Clock = std::chrono::steady_clock;
thread_local const std::atomic<bool>* stop_of_thread = nullptr;

/// The one line of the terminal that progress is shown in.
struct ProgressLine {
  std::mutex mutex;
  std::vector<Progress*> shown;  ///< that live and may draw, newest last
  bool written = false;          ///< something stands in the line
  bool clock = false;            ///< a clock runs

  void write(const std::string& text) {
    if (text.empty() && !written) return;
    fmt::print(stderr, "\r\033[K{}", text);
    std::fflush(stderr);
    written = !text.empty();
  }
};
ProgressLine& progress_line() {
  static ProgressLine line;
  return line;
}

/// "label [####      ]  40 %  3 s left", or "label  2 s" before the first step.
std::string drawn(const std::string& label, double share, double elapsed_s) {
  constexpr int kWidth = 30;
  if (!(share > 0)) return fmt::format("{}  {:.0f} s", label, elapsed_s);
  return fmt::format("{} [{:<{}}] {:3.0f} %  {:.0f} s left", label,
                     std::string(static_cast<std::size_t>(share * kWidth), '#'), kWidth,
                     100 * share, elapsed_s * (1 - share) / share);
}

}  // namespace

void Progress::stops_by(const std::atomic<bool>* stop) { stop_of_thread = stop; }

void Progress::erase() {
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  line.write("");
}

Progress::Progress(std::string label, long total, bool quiet)
    : label_(std::move(label)),
      total_(std::max(1L, total)),
      stop_(stop_of_thread),
      start_(Clock::now()),
      enabled_(!quiet && ::isatty(STDERR_FILENO) == 1) {
  if (!enabled_) return;
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  line.shown.push_back(this);
}

Progress::~Progress() {
  if (!enabled_) return;
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  std::erase(line.shown, this);
  line.write("");
}

void Progress::advance(long steps) {
  if (stop_ != nullptr && *stop_) throw Stopped();
  done_ += steps;
}

ProgressClock::ProgressClock(std::string label, bool quiet) : whole_(std::move(label), 1, quiet) {
  if (!whole_.enabled_) return;
  progress_line().clock = true;
  thread_ = std::jthread([](const std::stop_token& stop) {
    auto& line = progress_line();
    std::condition_variable_any stopped;
    std::unique_lock lock(line.mutex);
    while (line.clock && !stop.stop_requested()) {
      stopped.wait_for(lock, stop, std::chrono::milliseconds(200), [] { return false; });
      if (!line.clock || line.shown.empty()) continue;
      const Progress& newest = *line.shown.back();
      const double elapsed = std::chrono::duration<double>(Clock::now() - newest.start_).count();
      const double share = static_cast<double>(newest.done_) / static_cast<double>(newest.total_);
      if (elapsed >= 1) line.write(drawn(newest.label_, std::min(1.0, share), elapsed));
    }
  });
}

ProgressClock::~ProgressClock() { end(); }

void ProgressClock::end() {
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  line.clock = false;
  line.write("");
}

int ResultBuffer::overflow(int c) {
  ProgressClock::end();
  return to_->sputc(static_cast<char>(c));
}

std::streamsize ResultBuffer::xsputn(const char* text, std::streamsize count) {
  ProgressClock::end();
  return to_->sputn(text, count);
}

int ResultBuffer::sync() { return to_->pubsync(); }

}  // namespace rigfit::apps

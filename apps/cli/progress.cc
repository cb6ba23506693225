#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <condition_variable>
#include <cstdio>
#include <utility>
#include <vector>

namespace rigfit::apps {
namespace {
using Clock = std::chrono::steady_clock;
double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }
thread_local const std::atomic<bool>* stop_of_thread = nullptr;

/// The one line of the terminal that progress is shown in.
struct ProgressLine {
  std::mutex mutex;
  std::vector<Progress*> shown;  ///< that live and may draw, newest last
  bool written = false;          ///< something stands in the line
  bool clock = false;            ///< a clock runs

  void erase() {
    if (!std::exchange(written, false)) return;
    fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
  }
};
ProgressLine& progress_line() {
  static ProgressLine line;
  return line;
}

}  // namespace

void Progress::stops_by(const std::atomic<bool>* stop) { stop_of_thread = stop; }

void Progress::erase() {
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  line.erase();
}

Progress::Progress(std::string label, long total, bool quiet)
    : label_(std::move(label)),
      total_(std::max(1L, total)),
      enabled_(!quiet && ::isatty(STDERR_FILENO) == 1),
      stop_(stop_of_thread),
      start_(Clock::now()),
      last_(start_) {
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
  line.erase();
}

void Progress::advance(long steps) {
  if (stop_ != nullptr && *stop_) throw Stopped();
  const long done = done_ += steps;
  if (!enabled_) return;
  const std::lock_guard lock(progress_line().mutex);
  const auto now = Clock::now();
  if (seconds(now - start_) < 1 || seconds(now - last_) < 0.1) return;
  last_ = now;
  draw(done);
}

void Progress::draw(long done) {
  constexpr int kWidth = 30;
  const double fraction = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
  const int full = static_cast<int>(fraction * kWidth);
  const double elapsed = seconds(last_ - start_);
  fmt::print(stderr, "\r\033[K{} [{}{}] {:3.0f} %  {:.0f} s left", label_, std::string(full, '#'),
             std::string(kWidth - full, ' '), 100 * fraction,
             fraction > 0 ? elapsed * (1 - fraction) / fraction : 0.0);
  std::fflush(stderr);
  drawn_ = progress_line().written = true;
}

ProgressClock::ProgressClock(std::string label, bool quiet) : whole_(std::move(label), 1, quiet) {
  if (!whole_.enabled_) return;
  progress_line().clock = true;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

ProgressClock::~ProgressClock() { end(); }

void ProgressClock::end() {
  auto& line = progress_line();
  const std::lock_guard lock(line.mutex);
  line.clock = false;
  line.erase();
}

void ProgressClock::run(const std::stop_token& stop) {
  auto& line = progress_line();
  std::condition_variable_any stopped;
  std::unique_lock lock(line.mutex);
  while (line.clock && !stop.stop_requested()) {
    stopped.wait_for(lock, stop, std::chrono::milliseconds(200), [] { return false; });
    if (!line.clock || line.shown.empty()) continue;
    const Progress& newest = *line.shown.back();
    const double elapsed = seconds(Clock::now() - newest.start_);
    if (newest.drawn_ || elapsed < 1) continue;
    fmt::print(stderr, "\r\033[K{}  {:.0f} s", newest.label_, elapsed);
    std::fflush(stderr);
    line.written = true;
  }
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

#include "apps/cli/progress.h"

#include "apps/describe/standard.h"

#include <unistd.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>

namespace rigfit::apps {
namespace {
using Clock = std::chrono::steady_clock;
thread_local const std::atomic<bool>* stop_of_thread = nullptr;

// The one line of the terminal that progress is shown in.
std::mutex mutex_of_line;
Progress* newest = nullptr;
bool written = false;  // something stands in the line

void write(const std::string& text) {
  if (text.empty() && !written) return;
  fmt::print(stderr, "\r\033[K{}", text);
  std::fflush(stderr);
  written = !text.empty();
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
  const std::lock_guard lock(mutex_of_line);
  write("");
}

Progress::Progress(std::string label, long total, bool quiet)
    : label_(std::move(label)),
      total_(std::max(1L, total)),
      stop_(stop_of_thread),
      start_(Clock::now()) {
  if (quiet || ::isatty(STDERR_FILENO) == 0) return;
  const std::lock_guard lock(mutex_of_line);
  below_ = std::exchange(newest, this);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    std::condition_variable_any stopped;
    std::unique_lock line(mutex_of_line);
    while (!stop.stop_requested()) {
      stopped.wait_for(line, stop, std::chrono::milliseconds(200), [] { return false; });
      const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
      const double share = static_cast<double>(done_) / static_cast<double>(total_);
      if (newest == this && elapsed >= 1) write(drawn(label_, std::min(1.0, share), elapsed));
    }
  });
}

Progress::~Progress() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
  const std::lock_guard lock(mutex_of_line);
  newest = below_;
  write("");
}

void Progress::advance(long steps) {
  if (stop_ != nullptr && *stop_) throw Stopped();
  done_ += steps;
}

}  // namespace rigfit::apps

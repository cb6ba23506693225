#include "apps/cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace rigfit::apps {
namespace {
using Clock = std::chrono::steady_clock;
double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }
thread_local const std::atomic<bool>* stop_of_thread = nullptr;
}  // namespace

void Progress::stops_by(const std::atomic<bool>* stop) { stop_of_thread = stop; }

Progress::Progress(std::string label, long total, bool quiet)
    : label_(std::move(label)),
      total_(std::max(1L, total)),
      enabled_(!quiet && ::isatty(STDERR_FILENO) == 1),
      stop_(stop_of_thread),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() {
  if (drawn_) fmt::print(stderr, "\r\033[K");
}

void Progress::advance(long steps) {
  if (stop_ != nullptr && *stop_) throw Stopped();
  const long done = done_ += steps;
  if (!enabled_) return;
  const std::lock_guard lock(mutex_);
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
  drawn_ = true;
}

}  // namespace rigfit::apps

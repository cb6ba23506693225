// A progress bar on standard error, shown only on a terminal and only once the work has taken a
// second.
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace rigfit::apps {

class Progress {
 public:
  /// `total` steps of what `label` says; nothing is drawn when `quiet` or without a terminal.
  Progress(std::string label, long total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// May be called from any thread.
  void advance(long steps = 1);

 private:
  void draw(long done);

  std::string label_;
  long total_;
  bool enabled_;
  bool drawn_ = false;
  std::atomic<long> done_{0};
  std::mutex mutex_;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace rigfit::apps

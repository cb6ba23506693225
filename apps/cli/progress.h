// Progress on standard error, shown only on a terminal and only once the work has taken a second: a
// bar where the steps are known, else the seconds passed. Where it advances, long work can be
// stopped too.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <thread>

namespace rigfit::apps {

/// Thrown out of work that somebody has stopped.
struct Stopped : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "stopped"; }
};

/// The newest of those that live is drawn.
class Progress {
 public:
  /// From now on every Progress made on this thread stops its work once `*stop` is true; null: none
  /// does. `*stop` outlives them.
  static void stops_by(const std::atomic<bool>* stop);

  /// `total` steps of what `label` says; nothing is drawn when `quiet` or without a terminal.
  Progress(std::string label, long total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// May be called from any thread. Throws Stopped.
  void advance(long steps = 1);

  /// Takes the line off the terminal before something else is written there.
  static void erase();

 private:
  std::string label_;
  long total_;
  const std::atomic<bool>* stop_;
  std::atomic<long> done_{0};
  std::chrono::steady_clock::time_point start_;
  Progress* below_ = nullptr;  ///< drawn again after this one
  std::jthread thread_;        ///< draws; none without a terminal
};

}  // namespace rigfit::apps

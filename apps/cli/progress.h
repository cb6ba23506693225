// Progress on standard error, shown only on a terminal and only once the work has taken a second: a
// bar where the steps are known, else the seconds passed. Where it advances, long work can be
// stopped too.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <streambuf>
#include <string>
#include <thread>

namespace rigfit::apps {

/// Thrown out of work that somebody has stopped.
struct Stopped : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "stopped"; }
};

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
  friend class ProgressClock;

  std::string label_;
  long total_;
  const std::atomic<bool>* stop_;
  std::atomic<long> done_{0};
  std::chrono::steady_clock::time_point start_;
  bool enabled_;
};

/// While it lives, on a terminal: the newest Progress that lives is drawn, a bar once it has
/// advanced, or else the seconds passed beside its label or, where there is none, beside `label`.
class ProgressClock {
 public:
  ProgressClock(std::string label, bool quiet);
  ~ProgressClock();
  ProgressClock(const ProgressClock&) = delete;
  ProgressClock& operator=(const ProgressClock&) = delete;

  /// No more from now on: results are being written.
  static void end();

 private:
  Progress whole_;
  std::jthread thread_;
};

/// Results on their way to a terminal: what progress shows is taken off before them.
class ResultBuffer : public std::streambuf {
 public:
  explicit ResultBuffer(std::streambuf* to) : to_(to) {}

 private:
  int overflow(int c) override;
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int sync() override;

  std::streambuf* to_;
};

}  // namespace rigfit::apps

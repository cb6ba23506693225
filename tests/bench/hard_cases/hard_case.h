// Cases in which methods of this kind break, each with what must happen: a result within its stated
// uncertainty or a derived tolerance, or a refusal for the right reason. Never a NaN, a hang or a
// number that means nothing.
//
// A case returns the worst figure it found and what was allowed for it; `Worst` and `Coverage`
// gather them. What it throws, and whatever is not finite, counts as failed.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rigfit::hard_cases {

enum class Verdict { held, refused, failed };

struct Outcome {
  Verdict verdict = Verdict::failed;
  std::string found;    ///< the worst figure, with its unit
  std::string allowed;  ///< what the stated uncertainty or the tolerance allows
};

struct HardCase {
  std::string area;  ///< such as "bending", "decay"
  std::string name;
  std::string must;                        ///< what must happen, and what the tolerance is made of
  std::function<Outcome(bool quick)> run;  ///< quick: a part of it, for slow builds
};

/// Held when `figure` is finite and not above `allowed`; `unit` is printed behind both.
[[nodiscard]] Outcome within(double figure, double allowed, std::string_view unit = "");

/// What must be so whatever the figures: the first that is not is named.
class Requirements {
 public:
  void require(bool holds, std::string_view what) {
    if (!holds && missing_.empty()) missing_ = what;
  }

 protected:
  std::string missing_;
};

/// The largest of figures over what is allowed for each.
class Worst : public Requirements {
 public:
  /// A figure that is not finite, or without a positive allowance, never holds.
  void add(double figure, double allowed);
  [[nodiscard]] Outcome outcome(std::string_view unit = "") const;

 private:
  double figure_ = 0, allowed_ = 0;
  bool finite_ = true;
};

/// How often stated intervals hold the truth, and the mean error over the stated std.
class Coverage : public Requirements {
 public:
  explicit Coverage(double stated = 0.95) : stated_(stated) {}
  void add(double value, double std, double low, double high, double truth);
  /// Held when the share is above the stated one less three binomial deviations and the mean
  /// error is below three of its own (three over the root of the number of trials) and `bias`.
  [[nodiscard]] Outcome outcome(double bias = 0.1) const;

 private:
  double stated_;
  int trials_ = 0, covered_ = 0;
  double sum_ = 0;
  bool finite_ = true;
};

/// Held as a refusal when `refused` and the reason has the `expected` words in it.
[[nodiscard]] Outcome refusal(bool refused, const std::string& reason, std::string_view expected);

[[nodiscard]] std::vector<HardCase> bending_cases();
[[nodiscard]] std::vector<HardCase> decay_cases();
[[nodiscard]] std::vector<HardCase> hit_cases();
[[nodiscard]] std::vector<HardCase> record_cases();
[[nodiscard]] std::vector<HardCase> cable_cases();
[[nodiscard]] std::vector<HardCase> beam_cases();
[[nodiscard]] std::vector<HardCase> mode_cases();
[[nodiscard]] std::vector<HardCase> motion_cases();
[[nodiscard]] std::vector<HardCase> fit_cases();

}  // namespace rigfit::hard_cases

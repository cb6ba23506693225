#include "tests/bench/hard_cases/hard_case.h"

#include <fmt/format.h>

#include <algorithm>

namespace rigfit::hard_cases {
namespace {

std::string number(double value, std::string_view unit) {
  return fmt::format("{:.2g}{}{}", value, unit.empty() ? "" : " ", unit);
}

}  // namespace

Outcome within(double figure, double allowed, std::string_view unit) {
  const bool held = std::isfinite(figure) && figure <= allowed;
  return {held ? Verdict::held : Verdict::failed, number(figure, unit), number(allowed, unit)};
}

void Worst::add(double figure, double allowed) {
  if (!std::isfinite(figure) || !(allowed > 0)) finite_ = false;
  // Zero over zero: the first one stands.
  if (allowed_ == 0 || figure * allowed_ > figure_ * allowed) {
    figure_ = figure;
    allowed_ = allowed;
  }
}

Outcome Worst::outcome(std::string_view unit) const {
  if (!missing_.empty()) return {Verdict::failed, missing_, number(allowed_, unit)};
  if (!finite_ || allowed_ == 0) return {Verdict::failed, "not finite", number(allowed_, unit)};
  return within(figure_, allowed_, unit);
}

void Coverage::add(double value, double std, double low, double high, double truth) {
  ++trials_;
  if (!std::isfinite(value + low + high) || !(std > 0)) {
    finite_ = false;
    return;
  }
  covered_ += low <= truth && truth <= high ? 1 : 0;
  sum_ += (value - truth) / std;
}

Outcome Coverage::outcome(double bias) const {
  if (!missing_.empty()) return {Verdict::failed, missing_, ""};
  if (!finite_ || trials_ == 0) return {Verdict::failed, "not finite", ""};
  const double n = trials_, share = covered_ / n, mean = sum_ / n;
  const double least = stated_ - 3 * std::sqrt(stated_ * (1 - stated_) / n);
  const double most = std::max(bias, 3 / std::sqrt(n));
  const bool held = share >= least && std::abs(mean) <= most;
  return {held ? Verdict::held : Verdict::failed,
          fmt::format("{:.1f} % of {}, bias {:+.2f} std", 100 * share, trials_, mean),
          fmt::format("{:.1f} %, {:.2f} std", 100 * least, most)};
}

Outcome refusal(bool refused, const std::string& reason, std::string_view expected) {
  if (!refused) return {Verdict::failed, "not refused", std::string(expected)};
  const bool right = reason.find(expected) != std::string::npos;
  std::string line = right ? std::string(expected) : reason;
  return {right ? Verdict::refused : Verdict::failed, line, "this reason"};
}

}  // namespace rigfit::hard_cases

// Measured modes against a list of modelled ones, and the search for assignments.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "ident/tension/tension_posterior.h"

namespace rigfit::ident {
namespace {

constexpr double kSearchStd = 0.01;  // relative: the grids of EI and springs are coarse
constexpr double kTwin = 0.005;      // modes of both planes closer than this are seen as one
constexpr std::size_t kShortlist = 16;

/// Highest order of the modelled modes: 40 or twice the number of measured ones, the larger.
int highest_order(const TensionData& data) {
  return std::max<int>(40, 2 * static_cast<int>(data.modes.size()));
}

using Listed = TensionData::Listed;

/// The best assignment in rising order: measured against listed modes.
class Alignment {
 public:
  Alignment(const TensionData& data, const std::vector<Listed>& listed) {
    const std::size_t n = data.modes.size(), m = listed.size();
    width_ = m + 1;
    best_.assign((n + 1) * width_, 0);
    step_.assign((n + 1) * width_, Step::skip_listed);
    for (std::size_t i = 0; i <= n; ++i) {
      for (std::size_t j = 0; j <= m; ++j) {
        if (i == 0 && j == 0) continue;
        double best = -std::numeric_limits<double>::infinity();
        Step step = Step::pair;
        if (j > 0) {
          best = best_[i * width_ + j - 1] + listed[j - 1].ln_unseen;
          step = Step::skip_listed;
        }
        if (const double left_out =
                i > 0 ? best_[(i - 1) * width_ + j] + data.ln_false_of(i - 1) : best;
            left_out > best || (i > 0 && j == 0)) {
          best = left_out;
          step = Step::skip_measured;
        }
        if (i > 0 && j > 0) {
          const double variance = data.variance[i - 1] + kSearchStd * kSearchStd;
          const double r = data.ln_hz[i - 1] - listed[j - 1].ln_hz;
          const double paired = best_[(i - 1) * width_ + j - 1] +
                                data.ln_pair(i - 1, listed[j - 1]) - 0.5 * r * r / variance -
                                0.5 * std::log(2 * std::numbers::pi * variance);
          if (paired > best) {
            best = paired;
            step = Step::pair;
          }
        }
        best_[i * width_ + j] = best;
        step_[i * width_ + j] = step;
      }
    }
    std::vector<double> beyond(n + 1, 0);  // measured ones from i on are false
    for (std::size_t i = n; i-- > 0;) beyond[i] = beyond[i + 1] + data.ln_false_of(i);
    score_ = beyond[0];
    for (std::size_t i = 1; i <= n; ++i) {  // the last pair
      for (std::size_t j = 1; j <= m; ++j) {
        const double score = best_[i * width_ + j] + beyond[i];
        if (step_[i * width_ + j] != Step::pair || score < score_) continue;
        score_ = score;
        last_measured_ = i;
        last_listed_ = j;
      }
    }
  }

  [[nodiscard]] double score() const { return score_; }

  [[nodiscard]] std::vector<AssignedMode> modes(std::size_t measured,
                                                const std::vector<Listed>& listed) const {
    std::vector<AssignedMode> found(measured);
    std::size_t i = last_measured_, j = last_listed_;
    while (i > 0 || j > 0) {
      const Step step = step_[i * width_ + j];
      if (step == Step::pair) found[i - 1] = listed[j - 1].mode;
      if (step != Step::skip_listed) --i;
      if (step != Step::skip_measured) --j;
    }
    return found;
  }

 private:
  enum class Step : unsigned char { pair, skip_measured, skip_listed };
  std::size_t width_ = 0;
  std::vector<double> best_;
  std::vector<Step> step_;
  double score_ = 0;
  std::size_t last_measured_ = 0, last_listed_ = 0;  // the last pair, from 1
};

/// Frequencies at a tension between two others: ln f linear in ln T.
CableFrequencies between(const CableFrequencies& a, const CableFrequencies& b, double share) {
  const auto mix = [share](const std::vector<double>& from, const std::vector<double>& to) {
    std::vector<double> values(std::min(from.size(), to.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = from[i] * std::pow(to[i] / from[i], share);
    }
    return values;
  };
  return {mix(a.in_hz, b.in_hz), mix(a.out_hz, b.out_hz)};
}

class Search {
 public:
  Search(const CableModel& model, const TensionData& data) : model_(model), data_(data) {}

  /// One course of the tension from `high` down to `low` with a factor of EA, EI and springs.
  void descend(double ln_high, double ln_low, double step, double EA, const CableShape& shape) {
    EA_ = EA, shape_ = shape;
    const double limit = 1.3 * data_.highest_hz;
    for (double ln_upper = ln_high; ln_upper > ln_low;) {
      const double ln_lower = std::max(ln_low, ln_upper - step);
      const auto lower =
          model_.frequencies(state_at(ln_lower), highest_order(data_), limit, &roots_);
      // As many modes of the upper tension as of the lower one.
      const auto count = static_cast<int>(std::max(lower.in_hz.size(), lower.out_hz.size()));
      const auto upper = model_.frequencies(state_at(ln_upper), count,
                                            std::numeric_limits<double>::infinity(), &roots_);
      hypotheses(lower, upper, ln_lower, ln_upper);
      data_.list(lower, listed_);
      if (bound() < best_score_ - 30) return;  // and below there are only more modes not seen
      ln_upper = ln_lower;
    }
  }

  [[nodiscard]] std::vector<Assignment> best() const {
    std::vector<Assignment> all;
    for (const auto& [key, assignment] : found_) all.push_back(assignment);
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    while (!all.empty() && (all.size() > kShortlist || all.back().score < all.front().score - 25)) {
      all.pop_back();
    }
    return all;
  }

 private:
  [[nodiscard]] CableState state_at(double ln_tension) const {
    auto state = state_of(model_.cable(), shape_, std::exp(ln_tension));
    state.EA = EA_;
    return state;
  }

  void hypotheses(const CableFrequencies& lower, const CableFrequencies& upper, double ln_lower,
                  double ln_upper) {
    for (const bool in : {true, false}) {
      const auto& from = in ? lower.in_hz : lower.out_hz;
      const auto& to = in ? upper.in_hz : upper.out_hz;
      for (std::size_t j = 0; j < std::min(from.size(), to.size()); ++j) {
        if (!in && j < lower.in_hz.size() && lower.in_hz[j] == from[j]) continue;
        for (const double ln_hz : data_.ln_hz) {
          const double a = std::log(from[j]), b = std::log(to[j]);
          // A symmetric in-plane mode of a sagging cable may fall with the tension.
          const double share = (ln_hz - a) / (b - a);
          if (!(share >= 0 && share <= 1)) continue;
          data_.list(between(lower, upper, share), listed_);
          if (bound() < best_score_ - 30) continue;
          keep(Alignment(data_, listed_), ln_lower + share * (ln_upper - ln_lower));
        }
      }
    }
  }

  /// Upper bound of the score of any assignment to the listed frequencies.
  [[nodiscard]] double bound() const {
    double unseen = 0, least = 0, pairs = 0, best = -std::numeric_limits<double>::infinity();
    std::size_t j = 0;
    for (std::size_t i = 0; i < data_.ln_hz.size(); ++i) {  // measured i is the last pair
      for (; j < listed_.size() && listed_[j].ln_hz < data_.ln_hz[i]; ++j) {
        unseen += listed_[j].ln_unseen;
        least = std::min(least, listed_[j].ln_unseen);
      }
      const auto beyond = static_cast<double>(data_.ln_hz.size() - 1 - i);
      best = std::max(best, std::min(0.0, unseen - static_cast<double>(i + 1) * least) +
                                beyond * data_.ln_false);
    }
    for (const double variance : data_.variance) {
      pairs -= 0.5 * std::log(2 * std::numbers::pi * (variance + kSearchStd * kSearchStd));
    }
    return pairs + best;
  }

  void keep(const Alignment& alignment, double ln_tension) {
    if (alignment.score() < best_score_ - 30) return;
    best_score_ = std::max(best_score_, alignment.score());
    auto modes = alignment.modes(data_.modes.size(), listed_);
    std::vector<int> key;
    key.reserve(modes.size() + 1);
    for (const auto& mode : modes)
      key.push_back(2 * mode.order + (mode.plane == model::ModePlane::in));
    // With sag the same orders can have several tensions.
    const double T = std::exp(ln_tension);
    key.push_back(model_.lambda_squared(T) > 0.5 ? static_cast<int>(std::floor(5 * ln_tension))
                                                 : 0);
    auto& kept = found_[key];
    if (!kept.modes.empty() && kept.score >= alignment.score()) return;
    kept = {std::move(modes), alignment.score(), ln_tension, EA_, shape_};
  }

  const CableModel& model_;
  const TensionData& data_;
  std::vector<Listed> listed_;
  CableRoots roots_;
  std::map<std::vector<int>, Assignment> found_;
  double EA_ = 1;
  CableShape shape_;
  double best_score_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

TensionData::TensionData(std::vector<MeasuredMode> measured, const TensionOptions& options)
    : modes(std::move(measured)), options_(options) {
  std::stable_sort(modes.begin(), modes.end(), [](const auto& a, const auto& b) {
    return a.frequency_hz.value < b.frequency_hz.value;
  });
  for (const auto& mode : modes) {
    const auto& f = mode.frequency_hz;
    const bool known = std::isfinite(f.std) && f.std > 0;
    stated = stated && known;
    ln_hz.push_back(std::log(f.value));
    variance.push_back(known ? f.std * f.std / (f.value * f.value) : 0);
    any_ = any_ || !mode.plane;
    in_ = in_ || mode.plane == model::ModePlane::in;
    out_ = out_ || mode.plane == model::ModePlane::out;
  }
  lowest_hz = modes.front().frequency_hz.value;
  highest_hz = modes.back().frequency_hz.value;
  // A false mode lies anywhere in ln f, within the band and an octave beside it.
  ln_false = std::log(options.false_mode / (std::log(highest_hz / lowest_hz) + 0.7));
}

void TensionData::list(const CableFrequencies& frequencies, std::vector<Listed>& listed) const {
  listed.clear();
  const double missed = std::log(options_.missed), seen = std::log(1 - options_.missed);
  const double leak = options_.leaked * (1 - options_.missed);
  const auto add = [&](const std::vector<double>& values, model::ModePlane plane, bool asked) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      Listed one{std::log(values[i]), {plane, static_cast<int>(i)}, seen, missed};
      const auto& other = plane == model::ModePlane::in ? frequencies.out_hz : frequencies.in_hz;
      const bool twin = i < other.size() && std::abs(std::log(other[i] / values[i])) < kTwin;
      if (any_ && twin && plane == model::ModePlane::out) {
        one.ln_seen = std::log(0.5);
        one.ln_unseen = 0;
      } else if (any_ && !twin) {  // the direction of the test may hide either
        one.ln_seen = one.ln_unseen = std::log(0.5);
      } else if (!any_ && !asked) {
        one.ln_seen = std::log(leak);
        one.ln_unseen = twin ? 0 : std::log(1 - leak);
      }
      listed.push_back(one);
    }
  };
  add(frequencies.in_hz, model::ModePlane::in, in_);
  add(frequencies.out_hz, model::ModePlane::out, out_);
  std::stable_sort(listed.begin(), listed.end(),
                   [](const auto& a, const auto& b) { return a.ln_hz < b.ln_hz; });
  int in = 0, out = 0;
  for (auto& one : listed) one.rank = ++(one.mode.plane == model::ModePlane::in ? in : out);
}

double TensionData::ln_false_of(std::size_t i) const {
  return modes[i].order > 0 ? -std::numeric_limits<double>::infinity() : ln_false;
}

double TensionData::ln_pair(std::size_t i, const Listed& listed) const {
  if (modes[i].order > 0 && modes[i].order != listed.rank) {
    return -std::numeric_limits<double>::infinity();
  }
  const auto& plane = modes[i].plane;
  const bool crossed = plane && *plane != listed.mode.plane && ((in_ && out_) || any_);
  return std::log(1 - options_.false_mode) + listed.ln_seen +
         (crossed ? std::log(options_.leaked) : 0);
}

double TensionData::ln_assigned(const std::vector<AssignedMode>& assigned,
                                const std::vector<Listed>& listed) const {
  double ln = 0, last = -std::numeric_limits<double>::infinity();
  std::vector<bool> taken(listed.size(), false);
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    if (assigned[i].order < 0) {
      ln += ln_false_of(i);
      continue;
    }
    last = ln_hz[i];
    const auto found = std::find_if(listed.begin(), listed.end(),
                                    [&](const auto& one) { return one.mode == assigned[i]; });
    if (found == listed.end()) {  // beyond the list: as the last of it
      auto beyond = listed.back();
      beyond.rank = assigned[i].order + 1;
      ln += ln_pair(i, beyond);
      continue;
    }
    taken[static_cast<std::size_t>(found - listed.begin())] = true;
    ln += ln_pair(i, *found);
  }
  for (std::size_t j = 0; j < listed.size(); ++j) {
    if (!taken[j] && listed[j].ln_hz < last) ln += listed[j].ln_unseen;
  }
  return ln;
}

namespace {

/// Factors of EA from which a fit reaches everything that its uncertainty allows: beyond a tenth,
/// the orders of modes of a sagging cable change with it.
std::vector<double> searched_EA(const CableDescription& cable, const CableModel& model,
                                double slack_N) {
  for (const auto& input : uncertain_inputs(cable, false)) {
    if (input.factor != &CableState::EA || input.std < 0.1) continue;
    if (!(slack_N > 0) || model.lambda_squared(slack_N) < 0.1) continue;
    return {std::exp(-1.5 * input.std), 1, std::exp(1.5 * input.std)};
  }
  return {1};
}

}  // namespace

std::vector<Assignment> search_assignments(const CableModel& model, const TensionData& data) {
  const auto& cable = model.cable();
  const double L = cable.length_m.value, m = cable.mass_per_length.value;
  const auto string = [&](double hz) { return 4 * m * hz * hz * L * L; };
  // The lowest mode of the cable is at most in the middle of the measured ones.
  const double top_hz = data.modes[data.modes.size() / 2].frequency_hz.value;
  // A parabola needs T > w L / 6 or so.
  const double slack = model.weight_across() * L / 6;
  constexpr std::array<double, 3> kSprings = {0, 1, std::numeric_limits<double>::infinity()};
  Search search(model, data);
  for (const double EA : searched_EA(cable, model, slack)) {
    for (const double q : kSprings) {
      if (cable.EI_Nm2) {
        const double high = 1.2 * string(top_hz);
        const double low = std::max(slack, 1e-6 * high);
        if (low < high) search.descend(std::log(high), std::log(low), 0.15, EA, {1, q});
        continue;
      }
      for (const double x :
           {2.0,  2.5,  3.0,  3.7,  4.5,  5.5,  6.7,  8.2,   10.0,  12.5,  15.0,
            18.0, 22.0, 27.0, 35.0, 45.0, 60.0, 80.0, 120.0, 200.0, 400.0, 1500.0}) {
        // At a given x frequencies go with sqrt(T), but for the sag.
        const double guess = string(top_hz);
        const auto at = model.frequencies(state_of(cable, {x, q}, guess), highest_order(data),
                                          std::numeric_limits<double>::infinity());
        const double high = 1.1 * guess * std::pow(top_hz / at.out_hz.front(), 2);
        const double low =
            std::max(slack, 0.9 * guess * std::pow(data.lowest_hz / at.out_hz.back(), 2));
        if (!(low < high)) continue;
        const bool sags = model.lambda_squared(low) > 1e-3;
        search.descend(std::log(high), std::log(low), sags ? 0.15 : 2.0, EA, {x, q});
      }
    }
  }
  return search.best();
}

}  // namespace rigfit::ident

#include <fmt/ranges.h>

#include <numeric>
#include <set>

#include "signal/ambient/ambient_modes.h"
#include "signal/estimation/groups.h"
#include "signal/estimation/robust.h"
#include "signal/recording/add_note.h"

namespace rigfit::signal {
namespace {

using Indices = std::vector<Index>;

constexpr double kSetupsDiffer = 0.01;  // chance of a scatter or a gain where set-ups agree

/// Set-up and its mode.
using Matched = std::map<std::size_t, const AmbientMode*>;

struct Setups {
  std::span<const AmbientResult> results;
  std::vector<std::string> channels;  ///< every one
  std::vector<Indices> places;        ///< by set-up: its channels among all
  std::vector<Indices> references;    ///< by set-up: of its channels

  /// Components of a shape of set-up k at the references.
  [[nodiscard]] VectorXcd at_references(std::size_t k, const VectorXcd& shape) const {
    return shape(references[k]);
  }
};

Setups setups_of(std::span<const AmbientResult> results, std::vector<std::string> references) {
  const auto place = [](const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) - names.begin();
  };
  Setups all{results, {}, {}, {}};
  std::vector<std::string> common = results.front().channels;
  for (const auto& result : results) {
    std::erase_if(common, [&](const std::string& name) {
      return place(result.channels, name) == std::ssize(result.channels);
    });
    all.places.emplace_back();
    for (const auto& name : result.channels) {
      if (place(all.channels, name) == std::ssize(all.channels)) all.channels.push_back(name);
      all.places.back().push_back(place(all.channels, name));
    }
  }
  const std::string remedy =
      common.empty() ? "no channel is in all set-ups: give common channels the same names"
                     : "channels in all set-ups: " + listed(common);
  if (references.empty()) references = common;
  if (references.empty()) {
    throw RecordingError({"set-ups"}, "they have no channel in common", remedy);
  }
  for (std::size_t k = 0; k < results.size(); ++k) {
    all.references.emplace_back();
    for (const auto& name : references) {
      const Index at = place(results[k].channels, name);
      if (at == std::ssize(results[k].channels)) {
        throw RecordingError({fmt::format("set-up {}", k + 1), 0, 0, name},
                             "the reference is missing", remedy);
      }
      all.references.back().push_back(at);
    }
  }
  return all;
}

/// Whether two modes may be one: within their uncertainties and two bandwidths, by which warmth and
/// mass shift a structure between set-ups.
bool may_be_one(const IdentifiedMode& a, const IdentifiedMode& b) {
  const auto &f = a.frequency_hz, &g = b.frequency_hz;
  const double widths = 2 * (f.value * a.damping_ratio.value + g.value * b.damping_ratio.value);
  return std::abs(f.value - g.value) <= 3 * std::hypot(f.std, g.std) + widths;
}

std::vector<Matched> matched_modes(const Setups& setups) {
  std::vector<Matched> sets;
  for (std::size_t k = 0; k < setups.results.size(); ++k) {
    for (const AmbientMode& one : setups.results[k].modes) {
      if (one.mode.doubtful) continue;
      const auto apart = [&](const Matched& set) {
        return std::abs(set.begin()->second->mode.frequency_hz.value - one.mode.frequency_hz.value);
      };
      Matched* best = nullptr;
      for (Matched& set : sets) {
        const auto& [k0, other] = *set.begin();
        if (set.contains(k) || !may_be_one(other->mode, one.mode) ||
            (best && apart(*best) < apart(set))) {
          continue;
        }
        if (mac(setups.at_references(k0, other->mode.shape),
                setups.at_references(k, one.mode.shape)) > 0.5)
          best = &set;
      }
      if (best) {
        (*best)[k] = &one;
      } else {
        sets.push_back({{k, &one}});
      }
    }
  }
  return sets;
}

struct Merged {
  double value, std, factor;  ///< factor: of the 95 % interval
  bool differ;
};

/// Mean over set-ups: weights of variances that have few degrees of freedom themselves raise its
/// variance by 1 + 4 sum w (1 - w) / degrees (Meier, Biometrics 9 (1953) 59).
Merged mean_of(const std::vector<double>& x, const std::vector<double>& variances,
               const std::vector<double>& degrees) {
  const GroupMean mean = mean_over_groups(x, variances);
  if (mean.chance < kSetupsDiffer) {
    return {mean.mean, std::sqrt(mean.variance), coverage_factor(0.95, mean.degrees), true};
  }
  double weights = 0, sum = 0, unsure = 1, freedom = 0;
  for (const double v : variances) weights += 1 / v;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double w = 1 / variances[k] / weights;
    sum += w * x[k];
    unsure += 4 * w * (1 - w) / degrees[k];
    freedom += degrees[k];
  }
  return {sum, std::sqrt(unsure / weights), coverage_factor(0.95, freedom), false};
}

/// Shapes by set-up, scaled to the first one by the references; the largest component 1.
VectorXcd joined_shape(const Setups& setups, const std::map<std::size_t, VectorXcd>& shapes) {
  const auto& [first, first_shape] = *shapes.begin();
  const VectorXcd base = setups.at_references(first, first_shape);
  const auto n = static_cast<Index>(setups.channels.size());
  VectorXcd sum = VectorXcd::Zero(n);
  VectorXd count = VectorXd::Zero(n);
  for (const auto& [k, shape] : shapes) {
    const VectorXcd u = setups.at_references(k, shape);
    const Complex scale = u.dot(base) / u.squaredNorm();
    sum(setups.places[k]) += scale * shape;
    count(setups.places[k]).array() += 1;
  }
  return sum.cwiseQuotient(count.cwiseMax(1).cast<Complex>());
}

AmbientMode merged_mode(const Setups& setups, const Matched& set, std::vector<Note>& notes) {
  AmbientMode merged = *set.begin()->second;
  std::vector<double> f, f_var, log_zeta, zeta_var, degrees;
  std::map<std::size_t, VectorXcd> shapes;
  merged.decay_times = 0;
  for (const auto& [k, one] : set) {
    const auto& mode = one->mode;
    f.push_back(mode.frequency_hz.value);
    f_var.push_back(mode.frequency_hz.std * mode.frequency_hz.std);
    log_zeta.push_back(std::log(mode.damping_ratio.value));
    zeta_var.push_back(one->log_damping_std * one->log_damping_std);
    degrees.push_back(one->degrees);
    merged.decay_times += one->decay_times;
    merged.mode.presence = std::min(merged.mode.presence, mode.presence);
    shapes[k] = mode.shape;
  }
  merged.degrees = std::accumulate(degrees.begin(), degrees.end(), 0.0);
  const Merged hz = mean_of(f, f_var, degrees), log = mean_of(log_zeta, zeta_var, degrees);
  IdentifiedMode& mode = merged.mode;
  const double zeta = std::exp(log.value);
  set_pole(mode, kTwoPi * hz.value * std::complex(-zeta, std::sqrt(1 - zeta * zeta)), 0);
  mode.frequency_hz.std = hz.std;
  mode.damping_ratio.std = zeta * log.std;
  merged.log_damping_std = log.std;
  merged.frequency_95 = {hz.value - hz.factor * hz.std, hz.value + hz.factor * hz.std};
  merged.damping_95 = {zeta * std::exp(-log.factor * log.std),
                       zeta * std::exp(log.factor * log.std)};
  if (hz.differ || log.differ) {
    add_note(notes, "groups_differ", fmt::format("{:.4g} Hz", hz.value),
             "check temperature and mass between set-ups: {} of the mode differs between {} of "
             "them by more than its uncertainty",
             hz.differ ? "the frequency" : "the damping", set.size());
  }
  std::vector<std::size_t> lacking;
  std::set<Index> known;
  for (std::size_t k = 0; k < setups.results.size(); ++k) {
    if (!set.contains(k)) lacking.push_back(k + 1);
    if (set.contains(k)) known.insert(setups.places[k].begin(), setups.places[k].end());
  }
  const bool whole = known.size() == setups.channels.size();
  if (!lacking.empty()) {
    add_note(notes, "setup_lacks_mode", fmt::format("{:.4g} Hz", hz.value),
             "check references (direction, place) and what changed between set-ups: set-up {} has "
             "no such mode free of doubt{}",
             fmt::join(lacking, ", "), whole ? "" : "; the mode is listed without a shape");
  }
  const VectorXcd shape = joined_shape(setups, shapes);
  Index top = 0;
  shape.cwiseAbs().maxCoeff(&top);
  mode.shape = shape / shape[top];
  mode.shape_std.setZero(shape.size(), 2);
  for (const auto& [k, one] : set) {
    const MatrixXcd& without = one->without_group;
    MatrixXcd d(shape.size(), without.cols());
    for (Index g = 0; g < without.cols(); ++g) {
      auto changed = shapes;
      changed[k] = without.col(g);
      const VectorXcd all = joined_shape(setups, changed);
      d.col(g) = all / all[top];
    }
    d.colwise() -= d.rowwise().mean().eval();
    const double factor = 1 - 1.0 / static_cast<double>(d.cols());
    mode.shape_std.col(0) += factor * d.real().rowwise().squaredNorm();
    mode.shape_std.col(1) += factor * d.imag().rowwise().squaredNorm();
  }
  mode.shape_std = mode.shape_std.cwiseSqrt();
  mode.modal_phase_collinearity = modal_phase_collinearity(mode.shape);
  // A part of a shape is no shape: what is not known is not 0.
  if (!whole) mode.shape.resize(0), mode.shape_std.resize(0, 2);
  return merged;
}

/// References whose ratio to the first reference changed alike in all modes.
void find_gain_changes(const Setups& setups, const std::vector<Matched>& sets,
                       std::vector<Note>& notes) {
  const auto ratio = [&](const Matched& set, std::size_t k, std::size_t j) {
    const VectorXcd u = setups.at_references(k, set.at(k)->mode.shape);
    return std::log(std::abs(u[static_cast<Index>(j)] / u[0]));
  };
  for (std::size_t k = 1; k < setups.results.size(); ++k) {
    for (std::size_t j = 1; j < setups.references[k].size(); ++j) {
      std::vector<double> changes;
      for (const Matched& set : sets) {
        if (set.contains(0) && set.contains(k))
          changes.push_back(ratio(set, k, j) - ratio(set, 0, j));
      }
      if (changes.size() < 3) continue;
      const double middle = median(changes), n = static_cast<double>(changes.size());
      const double std = robust_std(changes, middle) / std::sqrt(n);
      if (std::abs(middle) < coverage_factor(1 - kSetupsDiffer, n - 1) * std + 0.01) continue;
      const auto name = [&](std::size_t r) {
        return setups.results[k].channels[static_cast<std::size_t>(setups.references[k][r])];
      };
      add_note(notes, "gain_changed", fmt::format("set-up {}", k + 1),
               "check the sensitivities of {} and {}: their ratio is {:.3f}({:.3f}) times that of "
               "the first set-up in all modes",
               name(j), name(0), std::exp(middle), std::exp(middle) * std);
    }
  }
}

}  // namespace

AmbientResult merge_setups(std::span<const AmbientResult> results,
                           std::vector<std::string> references) {
  if (results.size() == 1) return results.front();
  const Setups setups = setups_of(results, std::move(references));
  AmbientResult merged;
  merged.channels = setups.channels;
  merged.low_hz = results.front().low_hz, merged.high_hz = results.front().high_hz;
  for (const auto& result : results) {
    merged.low_hz = std::min(merged.low_hz, result.low_hz);
    merged.high_hz = std::max(merged.high_hz, result.high_hz);
    merged.lag_s = std::max(merged.lag_s, result.lag_s);
    merged.duration_s += result.duration_s;
    merged.tones.insert(merged.tones.end(), result.tones.begin(), result.tones.end());
    merged.notes.insert(merged.notes.end(), result.notes.begin(), result.notes.end());
    merged.spectra.insert(merged.spectra.end(), result.spectra.begin(), result.spectra.end());
    auto& diagram = merged.stabilisation;
    const auto& poles = result.stabilisation.poles;
    diagram.poles.insert(diagram.poles.end(), poles.begin(), poles.end());
    diagram.orders_solved = std::max(diagram.orders_solved, result.stabilisation.orders_solved);
  }
  const std::vector<Matched> sets = matched_modes(setups);
  for (const Matched& set : sets) merged.modes.push_back(merged_mode(setups, set, merged.notes));
  find_gain_changes(setups, sets, merged.notes);
  for (const auto& result : results) {  // doubtful ones that no set-up is sure of
    for (AmbientMode one : result.modes) {
      if (!one.mode.doubtful || std::ranges::any_of(merged.modes, [&](const auto& known) {
            return may_be_one(known.mode, one.mode);
          })) {
        continue;
      }
      one.mode.shape.resize(0), one.mode.shape_std.resize(0, 2);
      merged.modes.push_back(std::move(one));
    }
  }
  std::ranges::sort(merged.modes, {}, [](const auto& one) { return one.mode.frequency_hz.value; });
  return merged;
}

}  // namespace rigfit::signal

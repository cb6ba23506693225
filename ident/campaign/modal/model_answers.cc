#include "ident/campaign/modal/model_answers.h"

#include <algorithm>
#include <cmath>

#include "ident/statistics/in_parallel.h"
#include "signal/modes/modal_synthesis.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;
constexpr double kLongest_s = 10;  // longest simulated answer
constexpr double kAlike_s = 0.5;   // over which record and answer are brought together

/// The columns of a set at its lines from `first` to `last`.
signal::FrfSet part_of(const signal::FrfSet& frfs, Index first, Index last) {
  signal::FrfSet part = frfs;
  const Index n = last - first + 1;
  part.frequency_hz = frfs.frequency_hz.segment(first, n);
  part.H = frfs.H.middleRows(first, n);
  if (frfs.H_std.size() > 0) part.H_std = frfs.H_std.middleRows(first, n);
  if (frfs.coherence.size() > 0) part.coherence = frfs.coherence.middleRows(first, n);
  return part;
}

/// Where the model's answer starts in the record: the shift at which they are most alike over the
/// model's first `length` samples.
Index best_shift(const Eigen::VectorXd& record, const Eigen::VectorXd& model, Index length) {
  const Index n = std::min({length, record.size(), model.size()});
  Index best = 0;
  double most = -1;
  const Eigen::VectorXd head = model.head(n).array() - model.head(n).mean();
  for (Index shift = 0; shift + n <= record.size(); ++shift) {
    const auto part = record.segment(shift, n);
    // Where the model starts, the record moves most: alike in size as well as in shape.
    const double product = (part.array() - part.mean()).matrix().dot(head);
    if (product > most) most = product, best = shift;
  }
  return best;
}

}  // namespace

FrfComparison compare_frfs(const ModalTestState& recorded,
                           const std::vector<ModelVersion>& versions, Index most_lines) {
  const auto& frfs = recorded.hammer.frfs;
  const auto& f = frfs.frequency_hz;
  Index first = 0;
  while (first < f.size() && (f[first] < recorded.modal->low_hz || f[first] <= 0)) ++first;
  Index last = first - 1;
  while (last + 1 < f.size() && f[last + 1] <= recorded.modal->high_hz) ++last;

  FrfComparison result;
  result.test = part_of(frfs, first, last);
  const Eigen::VectorXd lines = result.test.frequency_hz;
  if (frfs.exponential_decay_rate_1_s > 0 && recorded.has_modes() && lines.size() > 0) {
    result.rebuilt = true;
    result.test = signal::synthesised(recorded.modal->model, lines, frfs.form, 0);
    result.test.unit = frfs.unit;
  }
  const Index every = 1 + lines.size() / most_lines;
  result.lines_hz.resize((lines.size() + every - 1) / every);
  for (Index k = 0; k < result.lines_hz.size(); ++k) result.lines_hz[k] = lines[k * every];
  for (const auto& version : versions) {
    result.versions.push_back(model::synthesize_frfs(version.scene, result.lines_hz));
  }
  return result;
}

Eigen::VectorXd filled(const Eigen::VectorXd& samples) {
  double sum = 0, count = 0;
  for (const double v : samples) {
    if (std::isfinite(v)) sum += v, ++count;
  }
  return samples.unaryExpr([&](double v) { return std::isfinite(v) ? v : sum / count; });
}

std::vector<ReleaseAnswer> release_answers(const ChannelDecays& decays,
                                           const signal::DecayOptions& options,
                                           const std::vector<ModelVersion>& versions, int threads) {
  const Eigen::VectorXd record = filled(decays.samples);
  const double rate = decays.sample_rate_hz;
  std::vector<ReleaseAnswer> answers(versions.size());
  in_parallel(versions.size(), threads, [&](std::size_t k) {
    const auto& version = versions[k];
    model::ResponseOptions response;
    response.sampling.rate_hz = rate;
    response.sampling.duration_s = std::min(kLongest_s, static_cast<double>(record.size()) / rate);
    ReleaseAnswer& answer = answers[k];
    answer.label = version.label;
    answer.response = model::simulate_response(version.scene, response);
    if (!answer.response.completed || answer.response.samples.rows() < 16) {
      answer.failure = "the model gives no answer: " + answer.response.reason;
      return;
    }
    const Eigen::VectorXd model = answer.response.samples.col(0);
    answer.start = best_shift(record, model, static_cast<Index>(std::lround(kAlike_s * rate)));
    // The same stretch of the motion as in the record: a large motion's frequency falls with it.
    const Index first = std::max<Index>(0, decays.strongest.start - answer.start);
    const Index last = std::min(model.size(), decays.strongest.end - answer.start);
    if (last - first < 16) {
      answer.failure = "the record was analysed where the model has ended";
      return;
    }
    signal::DecayOptions same = options;
    same.choose_window = same.trim_start = false;
    answer.found = signal::estimate_decay(model.segment(first, last - first), rate, same);
  });
  return answers;
}

const signal::DecayMode* same_oscillation(const signal::DecayMode& mode,
                                          const ReleaseAnswer& answer) {
  const auto off = [&](const signal::DecayMode& other) {
    return std::abs(std::log(other.frequency_hz.value / mode.frequency_hz.value));
  };
  const signal::DecayMode* nearest = nullptr;
  for (const auto& other : answer.found.modes) {
    if (off(other) < 0.15 && (!nearest || off(other) < off(*nearest))) nearest = &other;
  }
  return nearest;
}

}  // namespace rigfit::ident

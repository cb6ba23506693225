#include "ident/campaign/modal/model_answers.h"

#include <algorithm>
#include <cmath>

#include "ident/statistics/in_parallel.h"

namespace rigfit::ident {
namespace {

using Eigen::Index;
constexpr double kLongest_s = 10;  // longest simulated answer
constexpr double kAlike_s = 0.5;   // over which record and answer are brought together

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
    const Index first = std::max<Index>(0, decays.result.start - answer.start);
    const Index last = std::min(model.size(), decays.result.end - answer.start);
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

#include "apps/campaign_file/load_deflection.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <streambuf>
#include <utility>
#include <vector>

#include "apps/campaign_file/recording_description.h"
#include "apps/cli/at_hand.h"

namespace rigfit::apps {
namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const signal::Channel* channel_like(const signal::Recording& recording,
                                    const std::vector<std::string>& beginnings) {
  for (const auto& beginning : beginnings) {
    for (const auto& channel : recording.channels) {
      if (lower(channel.name).starts_with(beginning)) return &channel;
    }
  }
  return nullptr;
}

/// Correlation of two channels without missing samples; 0: something is missing or constant.
double correlation(const Eigen::VectorXd& x, const Eigen::VectorXd& y) {
  const Eigen::ArrayXd a = x.array() - x.mean(), b = y.array() - y.mean();
  const double r = (a * b).sum() / std::sqrt(a.square().sum() * b.square().sum());
  return std::isfinite(r) ? std::abs(r) : 0;
}

/// Standard deviation over mean.
double relative_change(const Eigen::VectorXd& x) {
  const double mean = std::abs(x.mean());
  return mean > 0 ? std::sqrt((x.array() - x.mean()).square().mean()) / mean : 1e300;
}

class NullBuffer : public std::streambuf {
  int overflow(int c) override { return c; }
};

}  // namespace

std::optional<LoadDeflection> load_deflection(const signal::Recording& recording) {
  LoadDeflection found;
  std::vector<const signal::Channel*> forces;
  const signal::Channel* way = channel_like(recording, {"deflection", "displacement", "lvdt"});
  for (const auto& channel : recording.channels) {
    const bool grams = channel.source_unit == "g" && channel_like(recording, {"load"}) == &channel;
    if (channel.quantity == signal::Quantity::force || channel.unit == "kg" || grams ||
        lower(channel.name).starts_with("mass")) {
      forces.push_back(&channel);
    } else if (channel.quantity == signal::Quantity::displacement && way == nullptr) {
      way = &channel;
    } else if (channel.quantity == signal::Quantity::displacement && way != &channel) {
      return std::nullopt;
    }
  }
  const auto* const named_tension = channel_like(recording, {"tension", "preload"});
  const auto* const named_load = channel_like(recording, {"load", "force", "q"});
  if (named_tension != nullptr && named_load != nullptr && way != nullptr) {
    return LoadDeflection{named_tension->name, named_load->name, way->name};
  }
  if (way == nullptr || forces.empty() || forces.size() > 2 || !way->samples.allFinite()) return {};
  const auto& d = way->samples;
  int crossings = 0;
  const double middle = d.mean();
  for (Eigen::Index i = 1; i < d.size(); ++i) crossings += (d[i - 1] < middle) != (d[i] < middle);
  constexpr int kMostTurns = 20;  // a bending test has fewer; a vibration has more
  if (crossings >= kMostTurns || d.size() < 3) return std::nullopt;
  for (const auto* force : forces) {
    if (!force->samples.allFinite()) return std::nullopt;
  }
  const signal::Channel *load = forces.front(), *tension = nullptr;
  if (forces.size() == 2) {
    tension = forces.back();
    const double r_load = correlation(load->samples, d), r_other = correlation(tension->samples, d);
    const double c_load = relative_change(load->samples),
                 c_other = relative_change(tension->samples);
    const bool steady = std::min(c_load, c_other) < 0.2 * std::max(c_load, c_other);
    if (steady ? c_load < c_other : r_load < r_other) std::swap(load, tension);
    if (!steady && std::min(r_load, r_other) > 0.7 * std::max(r_load, r_other)) return std::nullopt;
  }
  if (correlation(load->samples, d) < 0.8) return std::nullopt;
  return LoadDeflection{tension == nullptr ? "" : tension->name, load->name, way->name};
}

signal::Recording load_untold(const std::filesystem::path& path, VerbContext& context,
                              const signal::ReadOptions& options) {
  NullBuffer nothing;
  std::ostream sink(&nothing);
  VerbContext own(sink);
  own.quiet = context.quiet || context.silent;
  own.silent = true;
  own.hashes_inputs = false;
  own.reading = context.reading;
  own.at_hand = context.at_hand;
  if (recording_at_hand(path.string(), context)) return load_recording(path, own, options);
  context.input(path.string());
  for (const auto& file : {signal::description_of_folder(path), signal::description_beside(path)}) {
    if (file && *file != path) context.input(file->string());
  }
  return load_recording(path, own, options);
}

}  // namespace rigfit::apps

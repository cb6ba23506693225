#include "signal/poles/pole_clusters.h"

#include <tuple>

#include "signal/estimation/robust.h"

namespace rigfit::signal {
namespace {

/// Smallest share of the upper half of the orders in which a cluster must have a pole.
constexpr double kFewestOrders = 0.4;
constexpr int kMostMissed = 3;  // orders that a track may miss in between

/// Distance and participation vectors (MAC) allow for one mode.
bool linked(Complex p, const VectorXcd& a, Complex q, const VectorXcd& b, double spacing) {
  return apart(p, q, 0, spacing) < kClusterRadius &&
         (a.size() == 0 || b.size() == 0 || std::norm(a.dot(b)) > 0.8);
}

struct Track {
  std::vector<Complex> poles;  ///< from the highest order down
  std::vector<int> orders;
  VectorXcd participation;  ///< that the last pole linked has
  VectorXcd first;          ///< that the highest order's pole has
};

/// Links the poles of each order, from the highest down, to the nearest track end; each track takes
/// at most one pole of an order, nearest pairs first.
std::vector<Track> track_poles(const LscfResult& stabilisation, double spacing) {
  std::vector<Track> tracks;
  const auto& all = stabilisation.poles;
  std::size_t end = all.size();
  while (end > 0) {
    const int order = all[end - 1].order;
    std::size_t begin = end;
    while (begin > 0 && all[begin - 1].order == order) --begin;

    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
      if (tracks[t].orders.back() - order > kMostMissed + 1) continue;
      for (std::size_t i = begin; i < end; ++i) {
        const Complex p = tracks[t].poles.back(), q = all[i].pole_rad_s;
        if (linked(p, tracks[t].participation, q, all[i].participation, spacing)) {
          pairs.emplace_back(apart(p, q, 0, spacing), t, i);
        }
      }
    }
    std::ranges::sort(pairs);
    std::vector<bool> taken(end - begin, false);
    for (const auto& [d, t, i] : pairs) {
      if (taken[i - begin] || tracks[t].orders.back() == order) continue;
      taken[i - begin] = true;
      tracks[t].poles.push_back(all[i].pole_rad_s);
      tracks[t].orders.push_back(order);
      tracks[t].participation = all[i].participation;
    }
    for (std::size_t i = begin; i < end; ++i) {
      if (!taken[i - begin]) {
        const auto& vector = all[i].participation;
        tracks.push_back({{all[i].pole_rad_s}, {order}, vector, vector});
      }
    }
    end = begin;
  }
  return tracks;
}

}  // namespace

std::vector<PoleCluster> cluster_poles(const LscfResult& stabilisation, double line_spacing_hz) {
  const double spacing = 2 * std::numbers::pi * line_spacing_hz;
  const int top = stabilisation.orders_solved;
  const int half = top / 2;  // orders above this count
  std::vector<PoleCluster> clusters;
  for (const Track& track : track_poles(stabilisation, spacing)) {
    std::vector<double> real, imag;
    for (std::size_t i = 0; i < track.poles.size() && track.orders[i] > half; ++i) {
      real.push_back(track.poles[i].real());
      imag.push_back(track.poles[i].imag());
    }
    if (real.empty()) continue;
    PoleCluster cluster;
    cluster.presence = static_cast<double>(real.size()) / static_cast<double>(top - half);
    if (cluster.presence < kFewestOrders) continue;
    cluster.pole_rad_s = {median(real), median(imag)};
    cluster.participation = track.first;
    double sum = 0;
    for (std::size_t i = 0; i < real.size(); ++i) {
      sum += std::norm(Complex(real[i], imag[i]) - cluster.pole_rad_s);
    }
    cluster.scatter =
        std::sqrt(sum / static_cast<double>(real.size())) / std::abs(cluster.pole_rad_s.real());
    clusters.push_back(cluster);
  }
  // Pieces of one track, or two tracks of one mode: the one that is there more often stands for
  // both.
  std::ranges::sort(clusters, [](const auto& a, const auto& b) { return a.presence > b.presence; });
  std::vector<PoleCluster> kept;
  for (const PoleCluster& cluster : clusters) {
    const bool again = std::ranges::any_of(kept, [&](const PoleCluster& other) {
      return linked(cluster.pole_rad_s, cluster.participation, other.pole_rad_s,
                    other.participation, spacing);
    });
    if (!again) kept.push_back(cluster);
  }
  std::ranges::sort(kept, {}, [](const auto& one) { return one.pole_rad_s.imag(); });
  return kept;
}

}  // namespace rigfit::signal

#include "signal/modal/modal_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

#include "signal/estimation/robust.h"
#include "signal/modes/modal_synthesis.h"
#include "signal/numerics/numbers.h"

namespace rigfit::signal {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;

namespace {

/// Rows of lines from `low` to `high` that are finite in all of `H`.
std::vector<Index> usable_rows(const FrfSet& frfs, double low, double high, Index& unusable) {
  std::vector<Index> rows;
  for (Index k = 0; k < frfs.frequency_hz.size(); ++k) {
    const double f = frfs.frequency_hz[k];
    if (!(f > 0) || f < low || f > high) continue;
    if (!rows.empty() && !(f > frfs.frequency_hz[rows.back()])) {
      throw std::invalid_argument(
          f == frfs.frequency_hz[rows.back()]
              ? fmt::format(
                    "identify_modes: {} Hz is there twice: the table holds several FRFs one "
                    "below the other; give each its own column",
                    f)
              : fmt::format("identify_modes: frequencies do not rise at {} Hz", f));
    }
    if (frfs.H.row(k).allFinite()) {
      rows.push_back(k);
    } else {
      ++unusable;
    }
  }
  return rows;
}

void set_groups(const FrfSet& frfs, const std::vector<Index>& alive, ModalData& data) {
  const auto inputs = static_cast<Index>(frfs.inputs.size());
  data.inputs_vary = inputs > 1 && inputs * inputs >= frfs.H.cols();
  std::map<Index, std::vector<Index>> groups;
  for (const Index c : alive) groups[data.inputs_vary ? c % inputs : c / inputs].push_back(c);
  for (const auto& [member, columns] : groups) {
    data.begin.push_back(static_cast<Index>(data.frf.size()));
    data.member.push_back(member);
    data.frf.insert(data.frf.end(), columns.begin(), columns.end());
  }
  data.begin.push_back(static_cast<Index>(data.frf.size()));
}

}  // namespace

Complex ModalData::line_correlation(Index d) const {
  if (d == 0) return 1;
  if (!(correlation_lines > 0)) return 0;
  const auto lines = static_cast<double>(d);
  return std::polar(1.0, kTwoPi * lines * lead) /
         Complex(1, 0.5 * kTwoPi * lines / correlation_lines);
}

double ModalData::lines_a_value() const {
  return correlation_lines > 0 ? correlation_lines / std::tanh(correlation_lines) : 1;
}

ModalData modal_data(const FrfSet& frfs, double low_hz, double high_hz, std::vector<Note>& notes) {
  const auto inputs = static_cast<Index>(frfs.inputs.size());
  const Index columns = static_cast<Index>(frfs.responses.size()) * inputs;
  if (columns == 0 || frfs.H.cols() != columns || frfs.H.rows() != frfs.frequency_hz.size()) {
    throw std::invalid_argument("identify_modes: no FRFs, or sizes that do not fit");
  }
  const double last = frfs.frequency_hz.maxCoeff();
  ModalData data;
  data.low_hz = low_hz;
  data.high_hz = high_hz > 0 ? std::min(high_hz, last) : last;
  const double beside = 0.25 * (data.high_hz - data.low_hz);
  Index unusable = 0;
  std::vector<Index> rows =
      usable_rows(frfs, data.low_hz - beside, data.high_hz + beside, unusable);
  const auto in_band = std::count_if(rows.begin(), rows.end(), [&](Index k) {
    return frfs.frequency_hz[k] >= data.low_hz && frfs.frequency_hz[k] <= data.high_hz;
  });
  if (unusable > 0) {
    notes.push_back({"lines_left_out",
                     fmt::format("{} lines with values that are not finite are left out", unusable),
                     ""});
  }
  if (in_band < 8) {
    throw std::invalid_argument(
        fmt::format("{} usable lines in the band, at least 8 are needed", in_band));
  }
  const bool kept = frfs.by_hit.size() > 1 && inputs == 1;
  if (kept) {
    // Hits are kept to a little beyond the band that was analysed.
    const Index lines = frfs.by_hit.front().rows();
    while (!rows.empty() && rows.back() >= lines) rows.pop_back();
    data.hits = static_cast<Index>(rows.size()) > 8 &&
                frfs.frequency_hz[rows.back()] >=
                    data.high_hz - 2 * (last / static_cast<double>(frfs.H.rows()));
    if (!data.hits) {
      rows = usable_rows(frfs, data.low_hz - beside, data.high_hz + beside, unusable);
    }
  }
  const auto count = static_cast<Index>(rows.size());
  data.frequency_hz.resize(count);
  for (Index i = 0; i < count; ++i) {
    data.frequency_hz[i] = frfs.frequency_hz[rows[static_cast<std::size_t>(i)]];
  }
  std::vector<Index> alive;
  for (Index c = 0; c < columns; ++c) {
    double power = 0;
    for (const Index k : rows) power += std::norm(frfs.H(k, c));
    if (power > 0) {
      alive.push_back(c);
    } else {
      notes.push_back({"dead_frf", "this FRF is zero throughout and was left out",
                       frfs.responses[static_cast<std::size_t>(c / inputs)].name});
    }
  }
  if (data.hits) {
    for (std::size_t h = 0; h < frfs.by_hit.size(); ++h) {
      data.begin.push_back(static_cast<Index>(data.frf.size()));
      data.member.push_back(static_cast<Index>(h));
      data.frf.insert(data.frf.end(), alive.begin(), alive.end());
    }
    data.begin.push_back(static_cast<Index>(data.frf.size()));
  } else {
    set_groups(frfs, alive, data);
  }
  data.Y.resize(count, static_cast<Index>(data.frf.size()));
  for (Index g = 0; g < data.groups(); ++g) {
    const MatrixXcd& H = data.hits ? frfs.by_hit[static_cast<std::size_t>(g)] : frfs.H;
    for (Index c = data.begin[static_cast<std::size_t>(g)];
         c < data.begin[static_cast<std::size_t>(g) + 1]; ++c) {
      const Index frf = data.frf[static_cast<std::size_t>(c)];
      for (Index i = 0; i < count; ++i) data.Y(i, c) = H(rows[static_cast<std::size_t>(i)], frf);
    }
  }
  std::vector<double> steps;
  for (Index i = 1; i < count; ++i) {
    steps.push_back(data.frequency_hz[i] - data.frequency_hz[i - 1]);
  }
  data.spacing_hz = median(std::move(steps));
  data.window = frfs.exponential_decay_rate_1_s;
  data.correlation_lines = data.window / data.spacing_hz;
  data.lead = frfs.pre_trigger_s * data.spacing_hz;
  data.s = laplace_lines(data.frequency_hz, data.window);
  return data;
}

MatrixXcd averages_at(const ModalData& data, const FrfSet& frfs) {
  MatrixXcd H(data.frequency_hz.size(), frfs.H.cols());
  Index k = 0;
  for (Index i = 0; i < data.frequency_hz.size(); ++i) {
    while (frfs.frequency_hz[k] != data.frequency_hz[i]) ++k;
    H.row(i) = frfs.H.row(k);
  }
  return H;
}

}  // namespace rigfit::signal

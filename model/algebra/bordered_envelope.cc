#include "model/algebra/bordered_envelope.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rigfit::model {
namespace {

double product_of(const double* x, const double* y, int n) {
  double s0 = 0, s1 = 0;
  int k = 0;
  for (; k + 1 < n; k += 2) {
    s0 += x[k] * y[k];
    s1 += x[k + 1] * y[k + 1];
  }
  return k < n ? s0 + s1 + x[k] * y[k] : s0 + s1;
}

}  // namespace

BorderedEnvelope::BorderedEnvelope(std::shared_ptr<const Envelope> envelope,
                                   const std::vector<BorderRun>& runs)
    : inner_(std::move(envelope)) {
  const int n = inner_->size, k = static_cast<int>(runs.size());
  const auto last = [&](int i) {
    const BorderRun& run = runs[static_cast<std::size_t>(i)];
    return run.first + static_cast<int>(run.column.size()) - 1;
  };
  std::vector<int> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return last(a) < last(b); });
  place_.resize(static_cast<std::size_t>(n));
  border_place_.resize(runs.size());
  int passed = 0;
  const auto put_border = [&](int before) {  // those whose run ends before this unknown
    for (; passed < k && last(order[static_cast<std::size_t>(passed)]) < before; ++passed) {
      border_place_[static_cast<std::size_t>(order[static_cast<std::size_t>(passed)])] =
          before + passed;
    }
  };
  for (int j = 0; j < n; ++j) {
    put_border(j);
    place_[static_cast<std::size_t>(j)] = j + passed;
  }
  put_border(n);
  std::vector<int> first(static_cast<std::size_t>(n + k));
  for (int j = 0; j < n; ++j) {
    const auto row = static_cast<std::size_t>(j);
    first[static_cast<std::size_t>(place_[row])] =
        place_[static_cast<std::size_t>(inner_->first[row])];
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    int& begin = first[static_cast<std::size_t>(border_place_[i])];
    begin = border_place_[i];
    if (runs[i].column.size() > 0) begin = place_[static_cast<std::size_t>(runs[i].first)];
  }
  whole_ = Envelope::from_rows(std::move(first));
}

bool BorderedEnvelope::factor(const EnvelopeMatrix& k, const std::vector<BorderRun>& runs,
                              double singular) {
  const int n = whole_->size;
  lower_.setZero(whole_->entries);
  for (int j = 0; j < inner_->size; ++j) {
    const auto row = static_cast<std::size_t>(j);
    double* to = lower_.data() + whole_->offset[static_cast<std::size_t>(place_[row])];
    const double* from = k.values().data() + inner_->offset[row];
    for (int c = inner_->first[row]; c <= j; ++c) to[place_[static_cast<std::size_t>(c)]] = from[c];
  }
  upper_ = lower_;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const BorderRun& run = runs[i];
    const int here = border_place_[i];
    const long offset = whole_->offset[static_cast<std::size_t>(here)];
    for (Eigen::Index c = 0; c < run.column.size(); ++c) {
      const int place = place_[static_cast<std::size_t>(run.first + c)];
      lower_[offset + place] = run.row[c];
      upper_[offset + place] = run.column[c];
    }
    upper_[offset + here] = run.diagonal;
  }
  pivot_.resize(n);
  for (int p = 0; p < n; ++p) {
    const auto row = static_cast<std::size_t>(p);
    const int begin = whole_->first[row];
    double* l = lower_.data() + whole_->offset[row];
    double* u = upper_.data() + whole_->offset[row];
    double pivot = u[p], scale = std::abs(pivot);
    for (int j = begin; j < p; ++j) {
      const auto other = static_cast<std::size_t>(j);
      const int from = std::max(begin, whole_->first[other]);
      const double* lj = lower_.data() + whole_->offset[other];
      const double* uj = upper_.data() + whole_->offset[other];
      u[j] -= product_of(lj + from, u + from, j - from);
      l[j] = (l[j] - product_of(l + from, uj + from, j - from)) / pivot_[j];
      const double term = l[j] * u[j];
      pivot -= term;
      scale = std::max(scale, std::abs(term));
    }
    if (!(std::abs(pivot) > singular * scale)) return false;
    pivot_[p] = pivot;
  }
  return true;
}

void BorderedEnvelope::solve_in_place(Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  const int n = whole_->size;
  work_.resize(n);
  for (std::size_t j = 0; j < place_.size(); ++j) work_[place_[j]] = x[Eigen::Index(j)];
  for (std::size_t i = 0; i < border_place_.size(); ++i) {
    work_[border_place_[i]] = y[Eigen::Index(i)];
  }
  for (int p = 0; p < n; ++p) {
    const auto row = static_cast<std::size_t>(p);
    const int begin = whole_->first[row];
    work_[p] -=
        product_of(lower_.data() + whole_->offset[row] + begin, work_.data() + begin, p - begin);
  }
  for (int p = n - 1; p >= 0; --p) {
    const auto column = static_cast<std::size_t>(p);
    const double value = work_[p] /= pivot_[p];
    const double* u = upper_.data() + whole_->offset[column];
    for (int j = whole_->first[column]; j < p; ++j) work_[j] -= u[j] * value;
  }
  for (std::size_t j = 0; j < place_.size(); ++j) x[Eigen::Index(j)] = work_[place_[j]];
  for (std::size_t i = 0; i < border_place_.size(); ++i) {
    y[Eigen::Index(i)] = work_[border_place_[i]];
  }
}

}  // namespace rigfit::model

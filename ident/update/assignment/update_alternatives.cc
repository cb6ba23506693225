#include "ident/update/assignment/update_alternatives.h"

#include <Eigen/Cholesky>

#include "ident/statistics/in_parallel.h"
#include "signal/numerics/factorisations.h"

namespace rigfit::ident {
namespace {

constexpr double kSearchError = 0.05;  // the model's, while looking around
// The cost to a thousandth is ln(evidence) to a hundredth or so; what is kept is fitted anew.
constexpr double kSearched = 1e-3;
// Model error while assigning: the planes of a taut cable agree to 1e-5, its segments err by more.
constexpr double kLeastStd = 2e-3;
constexpr double kSure = 12;       // see the header
constexpr std::size_t kSeeds = 8;  // local fits from all over the range
constexpr int kRounds = 6;
constexpr double kDampingRange = 4.605;  // ln(100): range of an unpaired damping ratio

double width_of(const UpdateCoordinate& coordinate) {
  return coordinate.logarithmic ? std::log(10.0) : 0.1;
}

/// Relative errors of the model and their prior probability.
std::vector<std::pair<double, double>> model_errors() {
  constexpr int kCount = 10;
  std::vector<std::pair<double, double>> errors{{0, 0.5}};
  for (int k = 0; k < kCount; ++k) errors.emplace_back(1e-4 * std::pow(10, k / 3.0), 0.5 / kCount);
  return errors;
}

bool close(double a, double b) { return std::abs(a - b) <= 1e-12 + 0.5 * b; }

double log_sum(double a, double b) {
  if (a < b) std::swap(a, b);
  return std::isfinite(b) ? a + std::log1p(std::exp(b - a)) : a;
}

class Search {
 public:
  explicit Search(const UpdateProblem& problem) : problem_(problem), options_(problem.options()) {}

  std::vector<UpdateAnswer> run(int& fits, std::string& failure) {
    std::vector<UpdateAnswer> answers;
    VectorXd start = problem_.start();
    // Two that start alike would stay so: their difference has no slope there.
    for (const auto& [what, exchange] : exchanges()) {
      for (const auto& [i, j] : exchange) {
        if (start[i] == start[j]) start[i] -= kSearchError, start[j] += kSearchError;
      }
    }
    start = within_bounds(std::move(start));
    const auto settle = [&](std::vector<UpdateAnswer> seeds, int threads) {
      in_parallel(seeds.size(), threads,
                  [&](std::size_t k) { seeds[k] = settled(std::move(seeds[k])); });
      if (fits == 0 && !seeds.empty()) failure = seeds.back().failure;
      fits += static_cast<int>(seeds.size());
      merge(std::move(seeds), answers);
    };
    settle(seeds_at(start, failure), 1);
    const bool sure = !answers.empty() && explained(answers.front());
    if (options_.starts > 1 && !sure) settle(look_around(), options_.threads);
    std::vector<UpdateAnswer> heaviest = std::exchange(answers, {});
    in_parallel(heaviest.size(), options_.threads, [&](std::size_t k) {
      if (!negligible(heaviest[k], heaviest)) leave_out_false(heaviest[k]);
    });
    merge(std::move(heaviest), answers);
    std::erase_if(answers, [&](const UpdateAnswer& one) { return negligible(one, answers); });
    add_exchanged(answers);
    return answers;
  }

 private:
  static bool negligible(const UpdateAnswer& one, const std::vector<UpdateAnswer>& all) {
    return one.log_evidence < all.front().log_evidence - kNegligible;
  }

  // The answers stay in order of evidence; of two that are one the heavier stays.
  static void merge(std::vector<UpdateAnswer> found, std::vector<UpdateAnswer>& answers) {
    for (auto& one : found) {
      if (one.q.size() > 0) answers.push_back(std::move(one));
    }
    std::ranges::stable_sort(answers, std::greater{}, &UpdateAnswer::log_evidence);
    for (auto& other : std::exchange(answers, {})) {
      const bool known = std::ranges::any_of(answers, [&](const UpdateAnswer& kept) {
        return other.matches.matches == kept.matches.matches || near(kept, other);
      });
      if (!known) answers.push_back(std::move(other));
    }
  }

  static bool near(const UpdateAnswer& heavier, const UpdateAnswer& other) {
    const VectorXd d = heavier.q - other.q;
    return d.dot(heavier.hessian * d) < 9;
  }

  VectorXd within_bounds(VectorXd q) const {
    for (Index j = 0; j < q.size(); ++j) {
      const auto& coordinate = problem_.coordinate_at(j);
      q[j] = std::clamp(q[j], coordinate.low, coordinate.high);
    }
    return q;
  }

  // What the data may not tell apart: pairs of positive parameters of one quantity, at two owners
  // (the springs of both ends) or about two axes (the planes of a beam); all of two at once.
  using Exchange = std::vector<std::pair<Index, Index>>;
  std::map<std::pair<std::string, std::string>, Exchange> exchanges() const {
    const auto& coordinates = problem_.coordinates();
    const auto names = problem_.names();
    const auto parts = [&](Index i) {  // owner, quantity, axis
      std::string name = names[static_cast<std::size_t>(i)];
      if (coordinates[static_cast<std::size_t>(i)].state >= 0) name.resize(name.find(" ["));
      const auto dot = name.rfind('.') + 1, size = name.size();
      const auto end = size > 2 && name[size - 2] == '_' ? size - 2 : size;
      return std::array{name.substr(0, dot), name.substr(dot, end - dot), name.substr(end)};
    };
    std::map<std::pair<std::string, std::string>, Exchange> all;
    for (Index i = 0; i < problem_.parameter_count(); ++i) {
      for (Index j = 0; j < i; ++j) {
        const auto &one = coordinates[static_cast<std::size_t>(i)],
                   &other = coordinates[static_cast<std::size_t>(j)];
        if (one.parameter == other.parameter || one.state != other.state ||
            !(one.logarithmic && other.logarithmic))
          continue;
        const auto a = parts(i), b = parts(j);
        if (a[1] != b[1] || (a[0] == b[0]) == (a[2] == b[2])) continue;
        const std::size_t by = a[0] == b[0] ? 2 : 0;
        all[std::minmax(a[by], b[by])].emplace_back(j, i);
      }
    }
    return all;
  }

  // Modes are assigned anew: planes change theirs.
  void add_exchanged(std::vector<UpdateAnswer>& answers) const {
    for (std::size_t k = 0, found = answers.size(); k < found; ++k) {
      for (const auto& [what, exchange] : exchanges()) {
        VectorXd q = answers[k].q;
        for (const auto& [i, j] : exchange) std::swap(q[i], q[j]);
        std::string failure;
        for (auto& seed : seeds_at(within_bounds(std::move(q)), failure)) {
          UpdateAnswer other = settled(std::move(seed));
          const auto same = [&](const UpdateAnswer& one) { return near(one, other); };
          if (other.q.size() == 0 || negligible(other, answers) ||
              std::ranges::any_of(answers, same))
            continue;
          answers.push_back(std::move(other));
        }
      }
    }
  }

  // A positive parameter that the data leave free stays near q: the prior of the evidence.
  static UpdateProblem held_about(const VectorXd& q, UpdateProblem problem) {
    for (Index j = 0; j < q.size(); ++j) {
      const auto& coordinate = problem.coordinate_at(j);
      if (coordinate.prior_std == 0 && coordinate.logarithmic)
        problem.set_prior(j, q[j], width_of(coordinate));
    }
    return problem;
  }

  // Fitted and assigned anew until the assignment stays; of those that were seen the best.
  UpdateAnswer settled(UpdateAnswer from, double error = kSearchError) const {
    UpdateAnswer best{.failure = "no measured mode lies near any modelled one",
                      .log_evidence = -std::numeric_limits<double>::infinity()};
    std::vector<std::vector<UpdateMatch>> seen;
    for (int round = 0; round < kRounds; ++round) {
      if (std::ranges::all_of(from.matches.matches, &UpdateMatch::cross_plane)) break;
      UpdateAnswer here{from.q, from.matches};
      here.converged =
          minimise(held_about(from.q, problem_.with_model_std(error, kDampingErrors * error)),
                   from.matches.matches, here.q, here.cost, kSearched);
      if (!weigh(problem_, here)) break;
      auto& found = here.matches;
      found = problem_.with_model_std(std::max(here.error, kLeastStd)).assign(here.q, here.failure);
      if (!here.failure.empty()) {
        best.failure = here.failure;
        break;
      }
      const bool same = found.matches == from.matches.matches;
      const bool again =
          !same && (round + 1 == kRounds || std::ranges::count(seen, found.matches) > 0);
      const bool done = same && close(here.error, error);
      if (same) here.log_evidence += found.without_densities() - from.matches.without_densities();
      here.converged = here.converged && same;
      from = {here.q, found}, error = here.error;
      const bool usable = same || (again && best.q.size() == 0 && weigh(problem_, here));
      if (usable && (done || here.log_evidence > best.log_evidence)) best = std::move(here);
      if (done || again) break;
      if (!same) seen.push_back(from.matches.matches);
    }
    return best;
  }

  // Whether chance cannot have made the answer fit.
  bool explained(const UpdateAnswer& answer) const {
    const UpdateProblem plain = problem_.with_model_std(0);
    VectorXd r;
    if (!plain.residuals(answer.q, answer.matches.matches, r, nullptr)) return false;
    double squares = 0;
    const auto rows = plain.frequency_rows(answer.matches.matches);
    for (const auto& row : rows) {
      const auto& match = answer.matches.matches[row.match];
      squares += std::pow(r[row.row] * plain.relative_std(match.state, match.measured), 2);
    }
    const double degrees = static_cast<double>(rows.size()) +
                           static_cast<double>(problem_.prior_count()) -
                           static_cast<double>(problem_.size());
    const double error =
        std::max(1e-6, std::sqrt(squares / std::max<double>(1, static_cast<double>(rows.size()))));
    const double lost = -answer.matches.log_missed - answer.matches.log_false;
    return degrees * std::log(0.1 / error) - lost > kSure;
  }

  // Assignments at q, with its frequencies as they are and scaled; none without a model there.
  std::vector<UpdateAnswer> seeds_at(const VectorXd& q, std::string& failure) const {
    const UpdateProblem wide = problem_.with_model_std(kSearchError);
    std::string here;
    std::vector<UpdateAnswer> seeds{{q, wide.assign(q, here)}, {q, wide.assign(q, here, true)}};
    if (!here.empty()) {
      failure = here;
      return {};
    }
    if (seeds[0].matches.matches == seeds[1].matches.matches) seeds.pop_back();
    return seeds;
  }

  // Points all over the range, at the same places whatever the start: see the header.
  std::vector<VectorXd> places() const {
    const auto& coordinates = problem_.coordinates();
    const auto parameters = static_cast<std::size_t>(problem_.parameter_count());
    std::vector<int> dimension(parameters);  // values of one parameter in all states: one
    int dimensions = 0;
    for (std::size_t j = 0; j < parameters; ++j) {
      const bool next = j == 0 || coordinates[j].parameter != coordinates[j - 1].parameter;
      if (next) ++dimensions;
      dimension[j] = dimensions - 1;
    }
    const double reach = std::log(dimensions <= 2 ? 100.0 : 10.0);
    const int each = dimensions == 1 ? 27 : 8;
    const int count = dimensions == 1 ? each : 64;
    std::vector<VectorXd> all;
    for (int k = 0; k < count; ++k) {
      VectorXd q = problem_.start();
      for (Index j = 0; j < problem_.parameter_count(); ++j) {
        const auto& coordinate = coordinates[static_cast<std::size_t>(j)];
        const int d = dimension[static_cast<std::size_t>(j)];
        // -1 .. 1: of a lattice, or of Kronecker's sequence with the roots of primes.
        constexpr double kRoots[] = {1.4142135623730951, 1.7320508075688772, 2.23606797749979,
                                     2.6457513110645907, 3.3166247903554,    3.605551275463989};
        const double u = dimensions <= 2 ? 2.0 * ((d == 0 ? k % each : k / each) + 0.5) / each - 1
                                         : 2 * std::fmod((k + 1) * kRoots[d % 6], 1.0) - 1;
        double width = coordinate.logarithmic ? reach : 0.1;
        if (coordinate.prior_std > 0) width = std::min(width, 2.5 * coordinate.prior_std);
        double to = q[j] + width * u;
        if (dimensions <= 2 && coordinate.logarithmic && width == reach) {
          const double step = 2 * reach / each;
          to = step * std::round(to / step);  // the same from every start
        }
        q[j] = std::clamp(to, coordinate.low, coordinate.high);
      }
      all.push_back(std::move(q));
    }
    return all;
  }

  std::vector<UpdateAnswer> look_around() const {
    const auto points = places();
    std::vector<std::vector<UpdateAnswer>> found(points.size());
    in_parallel(points.size(), options_.threads, [&](std::size_t k) {
      std::string failure;
      found[k] = seeds_at(points[k], failure);
    });
    std::vector<UpdateAnswer> seeds;
    for (auto& some : found) {
      for (auto& seed : some) seeds.push_back(std::move(seed));
    }
    std::ranges::stable_sort(seeds, std::greater{},
                             [](const UpdateAnswer& one) { return one.matches.log_likelihood; });
    std::vector<UpdateAnswer> best;
    for (auto& seed : seeds) {
      const bool known = std::ranges::any_of(best, [&](const UpdateAnswer& other) {
        return other.matches.matches == seed.matches.matches;
      });
      if (known || best.size() == kSeeds) continue;
      best.push_back(std::move(seed));
    }
    return best;
  }

  // A false mode that has a partner and high leverage holds all others off. Pairs whose loss takes
  // most off the misfit, r_i^2 / (1 - h_ii), are left out as long as the evidence rises: at most a
  // fifth of them, or a wrong model would be left with what it can follow.
  void leave_out_false(UpdateAnswer& answer) const {
    const std::size_t most_out = std::max<std::size_t>(1, answer.matches.matches.size() / 5);
    for (std::size_t out = 0; out < most_out && answer.q.size() > 0 && answer.error > kLeastStd;
         ++out) {
      const UpdateProblem here =
          problem_.with_model_std(answer.error, kDampingErrors * answer.error);
      VectorXd r;
      MatrixXd J;
      const auto& all = answer.matches.matches;
      if (!here.residuals(answer.q, all, r, &J) || J.rows() < J.cols()) return;
      const MatrixXd Q = signal::thin_qr(J).Q;
      double most = 0, sum = 0;
      bool dampings = false;
      std::size_t worst = all.size();
      const auto rows = here.frequency_rows(all);
      for (const auto& row : rows) {
        const double free = 1 - Q.row(row.row).squaredNorm(), square = r[row.row] * r[row.row];
        const double gained = square / std::max(free, 1e-6);
        sum += square;
        dampings |= row.damping >= 0;
        if (gained > most) most = gained, worst = row.match;
      }
      if (worst == all.size()) return;
      // The model's error falls with the misfit, in all other pairs; a false mode costs more.
      const double left = std::max(1e-9, 1 - most / sum);
      const double gain = -0.5 * static_cast<double>(rows.size()) * std::log(left);
      if (!dampings && gain < -std::log(options_.assignment.false_mode)) return;
      UpdateAnswer rest{answer.q, answer.matches};
      rest.matches.matches.erase(rest.matches.matches.begin() + static_cast<std::ptrdiff_t>(worst));
      UpdateAnswer without = settled(std::move(rest), answer.error);
      if (without.q.size() == 0 || without.log_evidence <= answer.log_evidence) return;
      answer = std::move(without);
    }
  }

  const UpdateProblem& problem_;
  const UpdateOptions& options_;
};

}  // namespace

bool weigh(const UpdateProblem& problem, UpdateAnswer& answer) {
  const UpdateProblem plain = problem.with_model_std(0);
  const UpdateMatches& found = answer.matches;
  VectorXd r;
  MatrixXd J;
  if (!plain.residuals(answer.q, found.matches, r, &J)) return false;
  const auto rows = plain.frequency_rows(found.matches);
  answer.log_evidence = -std::numeric_limits<double>::infinity();
  double best = answer.log_evidence;
  for (const auto& [error, probability] : model_errors()) {
    VectorXd w = VectorXd::Ones(r.size());
    double log_likelihood = found.without_densities() + std::log(probability);
    const auto weigh = [&](Index row, double std, double own, double range) {
      const double all = std::hypot(std, own);
      w[row] = std / all;
      log_likelihood -= std::log(all * std::sqrt(2 * M_PI) / range);
    };
    for (const auto& row : rows) {
      const auto& match = found.matches[row.match];
      weigh(row.row, plain.relative_std(match.state, match.measured), error, 1);
      if (row.damping < 0) continue;
      weigh(row.damping, plain.damping_relative_std(match.state, match.measured),
            kDampingErrors * error, kDampingRange);
    }
    log_likelihood -= 0.5 * w.cwiseProduct(r).squaredNorm();
    const MatrixXd K = w.asDiagonal() * J;
    MatrixXd H = K.transpose() * K;
    for (Index j = 0; j < H.cols(); ++j) {
      const auto& coordinate = problem.coordinate_at(j);
      const bool prior = coordinate.prior_std > 0;
      const double width = prior ? coordinate.prior_std : width_of(coordinate);
      log_likelihood -= std::log(width);  // the roots of 2 pi of prior and integral cancel
      if (!prior) H(j, j) += 1 / (width * width);
    }
    const Eigen::LDLT<MatrixXd> factored(H);
    const double log_det = factored.vectorD().cwiseAbs().array().max(1e-300).log().sum();
    const double log_part = log_likelihood - 0.5 * log_det;
    if (log_part > best) {
      best = log_part;
      answer.error = error;
      answer.hessian = H;
    }
    answer.log_evidence = log_sum(answer.log_evidence, log_part);
  }
  return true;
}

std::vector<UpdateAnswer> find_answers(const UpdateProblem& problem, int& fits,
                                       std::string& failure) {
  // Pairs are sought on chains of fewer segments where a scene gives more; with half of these, high
  // modes lie so low that wrong pairs fit (a test of FindAnswers). Values are those of the full
  // chain, at whose minimum an answer is settled and weighed.
  const UpdateProblem coarse = problem.with(&UpdateVariant::coarse, true);
  return Search(coarse).run(fits, failure);
}

}  // namespace rigfit::ident

// The least-squares problem behind `update_model`: coordinates of the unknowns, the modes of every
// state with their derivatives by them, pairs, residuals, and its minimum with given pairs by
// Ceres. For the fit and its checks, not for users.
#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <type_traits>

#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// A frequency, damping ratio or standard uncertainty that was given.
[[nodiscard]] inline bool known(double value) { return std::isfinite(value) && value > 0; }

/// One unknown as it is fitted: q = ln(value) where the value is positive by nature, else
/// value / scale.
struct UpdateCoordinate {
  std::string name;
  int parameter = -1;  ///< index into the free parameters; -1: known to an uncertainty, in units q
  int state = -1;      ///< -1: shared
  /// What it is the value of (times `change`), or moves by `change` where it is no free parameter.
  std::vector<UncertainInput::Effect> effects = {};
  /// Noise of the hammer at one delay, in all lines of a load (update_nuisances.cc); std 0: none.
  struct Force {
    int state = 0;
    std::size_t load = 0;
    double std = 0, delay_s = 0;
  } force = {};
  bool logarithmic = true;
  double scale = 1;
  double start = 0, low = 0, high = 0;  ///< q
  double prior = 0, prior_std = 0;      ///< q; prior_std 0: none

  [[nodiscard]] double value(double q) const;
  [[nodiscard]] double derivative(double q) const;  ///< d value / d q
  [[nodiscard]] double coordinate(double value) const;
  /// Whether a bound is no further from q than `reach`.
  [[nodiscard]] bool at_bound(double q, double reach = 1e-9) const {
    return q - reach <= low || q + reach >= high;
  }
};

/// `visibility`: response at a sensor to a load of the scene; 0: none there.
struct UpdateModelMode : PairingMode {
  double damping_ratio = 0;
  VectorXd dlog_frequency, dlog_damping;  ///< by coordinate
};

/// What damping ratios err by, relative to frequencies.
inline constexpr double kDampingErrors = 10;

struct UpdateStateModes {
  std::string failure;  ///< empty: there are modes
  std::vector<UpdateModelMode> modes;
  /// `order` from 0.
  [[nodiscard]] const UpdateModelMode* find(model::ModePlane plane, int order) const;
};

struct UpdateMatches : AssignmentLikelihood {
  std::vector<UpdateMatch> matches;
  std::vector<UpdatedPair> unpaired;

  /// Those of another state.
  void append(const UpdateMatches& other) {
    matches.insert(matches.end(), other.matches.begin(), other.matches.end());
    unpaired.insert(unpaired.end(), other.unpaired.begin(), other.unpaired.end());
    add(other);
  }
};

/// Error of ln f with the segments that there are, by plane and order (from 1) of the modes.
using SegmentErrors = std::map<std::pair<model::ModePlane, int>, double>;

/// What problems of one fit differ by.
struct UpdateVariant {
  /// Whether the modes of a scene are the same.
  [[nodiscard]] bool solves_as(const UpdateVariant& other) const {
    return segment_factor == other.segment_factor && coarse == other.coarse &&
           segment_errors == other.segment_errors;
  }

  int held_out = -1;  ///< a state that takes no part; -1: none
  int only = -1;      ///< the state that alone takes part; -1: all
  /// Times the segments of the scenes (at least 8, where there are as many).
  double segment_factor = 1;
  /// No member has more than twice the segments of "auto", or of the modes that may pair.
  bool coarse = false;
  std::pair<double, double> model_std = {};  ///< in frequencies, in damping ratios
  double frf_model_std = 0;                  ///< a further relative error of the model in FRFs
  /// Noisy lines of FRFs by their difference instead of its logarithm (update_frfs.cc).
  bool frf_differences = false;
  /// By state, taken off the frequencies that count as data; null or empty: nothing.
  std::shared_ptr<const std::vector<SegmentErrors>> segment_errors;
};

class UpdateProblem {
 public:
  UpdateProblem(const std::vector<UpdateState>& states, const std::vector<FreeParameter>& free,
                const UpdateOptions& options);

  [[nodiscard]] const UpdateOptions& options() const { return options_; }
  [[nodiscard]] const std::vector<UpdateCoordinate>& coordinates() const { return coordinates_; }
  [[nodiscard]] const UpdateCoordinate& coordinate_at(Index j) const {
    return coordinates_[static_cast<std::size_t>(j)];
  }
  [[nodiscard]] Index size() const { return static_cast<Index>(coordinates_.size()); }
  /// Coordinates that are free parameters: the first.
  [[nodiscard]] Index parameter_count() const { return parameters_; }
  [[nodiscard]] VectorXd start() const;
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] const std::vector<UpdateState>& states() const { return states_; }
  [[nodiscard]] const UpdateState& state_at(int s) const {
    return states_[static_cast<std::size_t>(s)];
  }
  [[nodiscard]] bool takes_part(int state) const {
    return state != variant_.held_out && (variant_.only < 0 || state == variant_.only);
  }
  /// A copy that differs in one thing: `problem.with(&UpdateVariant::segment_factor, 2.0)`.
  template <typename T>
  [[nodiscard]] UpdateProblem with(T UpdateVariant::*what, std::type_identity_t<T> value) const {
    UpdateProblem other = *this;
    other.variant_.*what = std::move(value);
    return other;
  }
  [[nodiscard]] const UpdateVariant& variant() const { return variant_; }
  /// A further relative error of the model, of its own in every frequency and damping ratio.
  [[nodiscard]] UpdateProblem with_model_std(double frequency, double damping = 0) const {
    return with(&UpdateVariant::model_std, {frequency, damping});
  }
  /// This problem with the error of "auto" segments, found at q, taken off the frequencies that
  /// count as data (update_segments.cc); `given`: of segments that a scene gives as well.
  [[nodiscard]] UpdateProblem with_resolved_modes(const VectorXd& q, bool given = false) const;
  /// Whether `finer` changes the residuals at q by less than a tenth of their standard deviation,
  /// all together: no parameter by more of its own.
  [[nodiscard]] bool resolved_as(const UpdateProblem& finer,
                                 const std::vector<UpdateMatch>& matches, const VectorXd& q) const;
  /// This problem with so many segments of its "auto" members that twice as many change nothing.
  [[nodiscard]] UpdateProblem with_resolving_segments(const std::vector<UpdateMatch>& matches,
                                                      const VectorXd& q) const;
  [[nodiscard]] bool is_resolved(int state) const;
  /// This problem with place and force of the hits of FRFs as further coordinates, each with its
  /// normal prior (update_nuisances.cc); q becomes a place in it.
  [[nodiscard]] UpdateProblem with_hits(VectorXd& q) const;
  /// Lines of one FRF that are fitted: two residuals each, from row `first` on.
  struct FrfRows {
    int state = 0;
    const MeasuredFrf* frf = nullptr;
    Index first = 0;
    std::vector<Index> line = {};
    std::vector<double> relative_std = {};
    std::vector<char> difference = {};  ///< 1: residual H / H_measured - 1, else their logarithm
  };
  [[nodiscard]] std::vector<FrfRows> frf_rows() const;
  [[nodiscard]] model::Scene scene_at(int state, const VectorXd& q) const;
  /// `matches`: modes are asked for that these need; null: all that may pair.
  [[nodiscard]] UpdateStateModes modes(int state, const VectorXd& q, bool derivatives,
                                       const std::vector<UpdateMatch>* matches = nullptr) const;

  /// Pairs for lists of every state that takes part; `failure` says why there are none.
  [[nodiscard]] UpdateMatches match(const VectorXd& q, std::string& failure) const;

  /// Residuals over their standard deviations: FRFs, frequencies and dampings of the fitted pairs
  /// in order, then priors. False when some state has no modes or a pair's mode is gone.
  [[nodiscard]] bool residuals(const VectorXd& q, const std::vector<UpdateMatch>& matches,
                               VectorXd& residuals, MatrixXd* jacobian) const;
  [[nodiscard]] Index residual_count(const std::vector<UpdateMatch>& matches) const;
  [[nodiscard]] bool has_modes() const;
  [[nodiscard]] bool has_frfs() const;
  /// Rms of |ln(H_model / H_measured)| over the fitted lines of the states that take part; NaN
  /// without any or without a model.
  [[nodiscard]] double rms_log_frf_error(const VectorXd& q) const;
  [[nodiscard]] Index frf_lines() const;
  /// So many residuals less the unknowns, and those of FRF lines that share their noise with
  /// others and say nothing of their own.
  [[nodiscard]] double degrees_of_freedom(Index residuals) const;
  [[nodiscard]] Index prior_count() const { return priors_; }
  [[nodiscard]] std::vector<UpdatedPair> pairs(const VectorXd& q,
                                               const std::vector<UpdateMatch>& matches) const;

  /// The assignment of the largest likelihood (mode_assignment.h) in every state that takes part;
  /// `scaled`: with all frequencies of a state times one factor of up to two either way.
  [[nodiscard]] UpdateMatches assign(const VectorXd& q, std::string& failure,
                                     bool scaled = false) const;

  /// Rows of the residuals that are frequencies of fitted pairs, with their match.
  struct FrequencyRow {
    Index row = 0, damping = -1;  ///< its damping ratio's row, where it is fitted
    std::size_t match = 0;
  };
  [[nodiscard]] std::vector<FrequencyRow> frequency_rows(
      const std::vector<UpdateMatch>& matches) const;
  [[nodiscard]] bool modes_only() const { return has_modes() && !has_frfs(); }
  /// The same without FRFs, with modes that only lead as data.
  [[nodiscard]] UpdateProblem modes_alone() const;

  [[nodiscard]] double relative_std(int state, int measured) const;
  [[nodiscard]] double damping_relative_std(int state, int measured) const;
  /// Factor on a state's measured frequencies where the inputs change its sample rate at q.
  [[nodiscard]] double measured_factor(int state, const VectorXd& q) const;
  [[nodiscard]] bool uncertainties_known() const { return uncertainties_known_; }

  /// A prior where there was none.
  void set_prior(Index coordinate, double q, double std) {
    auto& at = coordinates_[static_cast<std::size_t>(coordinate)];
    at.prior = q, at.prior_std = std;
    ++priors_;
  }

 private:
  struct Targets {
    std::vector<model::ParameterAccess> access;
    std::vector<std::pair<Index, double>> owner;  // coordinate, factor
  };

  // Modes asked of the model for fixed pairs, by plane; none: all that may pair.
  struct ModeNeed {
    int in = 0, out = 0;
    bool operator==(const ModeNeed&) const = default;
  };
  // The modes that were asked for last, a list by state; copies of a problem share them.
  struct LastModes {
    struct Solved {
      VectorXd q;
      bool derivatives;
      ModeNeed need;
      UpdateVariant variant;
      UpdateStateModes modes;
    };
    std::mutex mutex;
    std::map<int, std::deque<Solved>> by_state;
  };
  [[nodiscard]] ModeNeed need_of(int state, const std::vector<UpdateMatch>* matches) const;
  [[nodiscard]] UpdateStateModes solved_modes(int state, const VectorXd& q, bool derivatives,
                                              const ModeNeed& need) const;
  [[nodiscard]] UpdateMatches assign_state(int state, const UpdateStateModes& modelled) const;
  [[nodiscard]] const MeasuredMode& measured(int state, int mode) const;
  [[nodiscard]] bool damping_fitted(const MeasuredMode& mode) const {
    return damping_free_ && known(mode.damping_ratio.value);
  }
  [[nodiscard]] int mode_count(int state) const;  // that may pair
  [[nodiscard]] Targets targets_of(int state) const;
  /// With one for all targets of a coordinate that can be moved together.
  [[nodiscard]] Targets targets_together(int state, const model::Scene& scene) const;
  /// Whether one of the first `count` coordinates moves a scene parameter of that state.
  [[nodiscard]] bool is_moved(int state, const std::string& target, Index count) const;
  /// Changes of a state's sample rate by one standard uncertainty of each coordinate; empty: none.
  [[nodiscard]] std::vector<std::pair<Index, double>> rate_changes(int state) const;
  void add_places_of_hits(const VectorXd& q);
  void add_forces();
  void add_nuisance(UpdateCoordinate coordinate);
  void add_force_noise(const VectorXd& q, const std::vector<FrfRows>& all, VectorXd& r,
                       MatrixXd* jacobian) const;
  [[nodiscard]] bool fixed_scene(int state, const VectorXd& q, model::Scene& scene,
                                 std::string& failure) const;
  [[nodiscard]] FrfRows rows_of(int state, const MeasuredFrf& frf) const;
  [[nodiscard]] bool frf_residuals(const VectorXd& q, const std::vector<FrfRows>& all, VectorXd& r,
                                   MatrixXd* jacobian) const;

  std::vector<UpdateState> states_;
  UpdateOptions options_;
  std::vector<UpdateCoordinate> coordinates_;
  Index parameters_ = 0, priors_ = 0;
  bool uncertainties_known_ = true, damping_free_ = false, damping_ = false, joint_dampers_ = false;
  UpdateVariant variant_;
  // By copies of a problem too: asking for the paired modes alone has not failed yet.
  std::shared_ptr<std::atomic<bool>> narrow_ = std::make_shared<std::atomic<bool>>(true);
  std::shared_ptr<LastModes> last_ = std::make_shared<LastModes>();
};

/// Root mean square of the relative errors of pairs that are no leakage; NaN without any.
[[nodiscard]] double rms_of_pairs(const std::vector<UpdatedPair>& pairs);

/// An assignment of the modes, and the minimum with it.
struct UpdateAnswer {
  VectorXd q = {};  ///< empty: there is none, see `failure`
  UpdateMatches matches = {};
  double cost = std::numeric_limits<double>::infinity();
  bool converged = false;
  std::string failure = {};
  double error = 0;  ///< tau of largest posterior probability (update_alternatives.h)
  double log_evidence = 0;
  MatrixXd hessian = {};  ///< second derivatives of -ln(posterior), by coordinate
  double weight = 1;
};

/// With fixed pairs, from q, which becomes the answer, until the cost changes by less than
/// `tolerance` of it. False when it did not converge. `held`: a coordinate that stays as it is; -1:
/// none.
[[nodiscard]] bool minimise(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                            VectorXd& q, double& cost, double tolerance = 1e-9, int held = -1);

/// Half the sum of squares; false when there is no model.
[[nodiscard]] bool cost_of(const UpdateProblem& problem, const std::vector<UpdateMatch>& matches,
                           const VectorXd& q, double& cost);

}  // namespace rigfit::ident

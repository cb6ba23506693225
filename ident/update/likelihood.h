// The likelihood of an update: what is unknown (the user's parameters and nuisances), the scenes at
// any values of it, and the residuals of all data with their derivatives.
//
//   r = [frequencies, damping ratios, shapes of pairs; FRFs; priors] over their standard deviations
//
// Nuisances are what a fit takes as known to an uncertainty: stated inputs (readings, lengths,
// clocks), the place of the hits, the noise of their force. Each is one more coordinate in its
// standard uncertainties, with a prior of 0 +- 1, and is integrated out with the rest: nothing is
// added to a result afterwards. Frequencies are those of as many segments as `mesh` says. A copy
// with other settings is a variant of the same problem. For the fit and its checks, not for users.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ident/update/coordinate.h"
#include "ident/update/problem/update_data.h"
#include "ident/update/problem/update_options.h"
#include "ident/update/problem/update_result.h"

namespace rigfit::ident {

/// A frequency, damping ratio or standard uncertainty that was given.
[[nodiscard]] inline bool known(double value) { return std::isfinite(value) && value > 0; }

struct UpdateModelMode {
  double frequency_hz = 0, damping_ratio = 0;
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;  ///< among those of its plane
  Eigen::VectorXcd shape;
  double visibility = 0;  ///< response at a sensor to a load of the scene; 0: none there
  Eigen::VectorXd dlog_frequency, dlog_damping;  ///< by coordinate
  Eigen::MatrixXd dshape;                        ///< sensors x coordinates; empty: not asked for
};

struct UpdateStateModes {
  std::string failure;  ///< empty: there are modes
  std::vector<UpdateModelMode> modes;
  [[nodiscard]] const UpdateModelMode* find(model::ModePlane plane, int order) const;
};

/// A measured mode and the modelled one it is fitted to.
struct UpdateMatch {
  int state = 0, measured = 0;
  model::ModePlane plane = model::ModePlane::in;
  int order = 0;
  double mac = 0;
  bool cross_plane = false;  ///< listed, not fitted
  bool operator==(const UpdateMatch& other) const {
    return state == other.state && measured == other.measured && plane == other.plane &&
           order == other.order && cross_plane == other.cross_plane;
  }
};

struct UpdateMatches {
  std::vector<UpdateMatch> matches;
  std::vector<UpdatedUnpaired> unpaired;
  int unpaired_measured = 0;
  double log_likelihood = 0, log_detected = 0, log_false = 0, log_missed = 0;  ///< of an assignment
};

/// What counts as data: first the modes alone, then everything (modes that only lead drop out).
enum class UpdateStage { lead, full };

/// Relative errors of the model beside what is stated: of its own in every frequency, damping
/// ratio, line of an FRF.
struct ModelErrors {
  double frequency = 0, damping = 0, frf = 0;
};

/// Segments of the scenes' members. Frequencies of members that leave them to the program are those
/// of `auto_segments`, moved by what that number costs them (`errors`, of ln f).
struct Mesh {
  struct ModeError {
    model::ModePlane plane;
    int order;
    double of_log;
  };
  int auto_segments = 30;
  double factor = 1;  ///< times the segments of all members, at least 8 where there are as many
  std::shared_ptr<const std::vector<std::vector<ModeError>>> errors = nullptr;  ///< by state
};

class Likelihood {
 public:
  /// `held_out`: a state that takes no part; -1: none.
  Likelihood(std::vector<UpdateState> states, std::vector<FreeParameter> free,
             UpdateOptions options, int held_out = -1);

  Mesh mesh;
  ModelErrors errors;
  bool frf_differences = false;  ///< noisy lines by their difference, not its logarithm

  // What is unknown: first the parameters, then the nuisances.
  [[nodiscard]] const std::vector<UpdateCoordinate>& coordinates() const { return coordinates_; }
  [[nodiscard]] Eigen::Index size() const { return static_cast<Eigen::Index>(coordinates_.size()); }
  [[nodiscard]] Eigen::Index parameters() const { return parameters_; }
  [[nodiscard]] Eigen::Index priors() const;
  [[nodiscard]] Eigen::VectorXd start() const;
  [[nodiscard]] std::vector<std::string> names() const;  ///< of all coordinates
  void set_prior(Eigen::Index coordinate, double q) {
    coordinates_[static_cast<std::size_t>(coordinate)].prior = q;
  }
  /// Adds nuisances: an input, then for hits of which nothing is said their mean place, as far off
  /// as the FRFs' error bars allow, and the noise of their force.
  void add_input(const UncertainInput& input);
  void add_hits(const Eigen::VectorXd& q);
  /// Whether a scene parameter is fitted or moved by an input in that state.
  [[nodiscard]] bool is_stated(int state, const std::string& target) const;

  // States and their models.
  [[nodiscard]] std::vector<UpdateState>& states() { return states_; }
  [[nodiscard]] const std::vector<UpdateState>& states() const { return states_; }
  [[nodiscard]] const UpdateOptions& options() const { return options_; }
  [[nodiscard]] bool takes_part(int state) const { return state != held_out_; }
  [[nodiscard]] bool has_modes() const;
  [[nodiscard]] bool has_frfs() const;
  [[nodiscard]] bool modes_only() const { return has_modes() && !has_frfs(); }
  [[nodiscard]] bool stated() const { return stated_; }  ///< all uncertainties came with the data
  [[nodiscard]] int fewest_segments() const;             ///< of any member
  [[nodiscard]] model::Scene scene_at(int state, const Eigen::VectorXd& q) const;
  /// `matches`: modes are asked for that these need; null: all that may pair.
  [[nodiscard]] UpdateStateModes modes(int state, const Eigen::VectorXd& q, bool derivatives,
                                       const std::vector<UpdateMatch>* matches = nullptr) const;
  [[nodiscard]] int evaluations() const { return shared_->evaluations; }

  // Pairs. `failure` says why there are none.
  [[nodiscard]] UpdateMatches match(const Eigen::VectorXd& q, double common_factor_range,
                                    std::string& failure, int only = -1) const;
  /// The assignment of the largest likelihood (mode_assignment.h), all frequencies times `factor`.
  /// Tests see modes as the scene's sensors and loads do, or, where these were elsewhere, those of
  /// one parity of order only (`one_parity` each, of a single member); `parity` 0, 1: even or odd
  /// orders from 1.
  [[nodiscard]] UpdateMatches assign(const Eigen::VectorXd& q, std::string& failure) const;
  [[nodiscard]] UpdateMatches assign_state(int state, const UpdateStateModes& modelled,
                                           double factor = 1, int parity = -1) const;
  [[nodiscard]] std::vector<UpdatedPair> pairs(const Eigen::VectorXd& q,
                                               const std::vector<UpdateMatch>& matches) const;

  // Residuals. False when some state has no modes or a pair's mode is gone.
  [[nodiscard]] bool residuals(const Eigen::VectorXd& q, const std::vector<UpdateMatch>& matches,
                               UpdateStage stage, Eigen::VectorXd& residuals,
                               Eigen::MatrixXd* jacobian) const;
  [[nodiscard]] Eigen::Index residual_count(const std::vector<UpdateMatch>& matches,
                                            UpdateStage stage) const;
  [[nodiscard]] double relative_std(int state, int measured) const;
  [[nodiscard]] double damping_relative_std(int state, int measured) const;
  /// Rows of the residuals that are frequencies of fitted pairs, with their match.
  struct FrequencyRow {
    Eigen::Index row = 0, damping = -1;  ///< its damping ratio's row, where it is fitted
    std::size_t match = 0;
  };
  [[nodiscard]] std::vector<FrequencyRow> frequency_rows(const std::vector<UpdateMatch>& matches,
                                                         UpdateStage stage) const;
  /// Residuals of an FRF in the order of their rows.
  struct FrfRows {
    Eigen::Index first = 0;
    std::vector<double> relative_std;
    std::size_t frf = 0;  ///< of the state
    int state = 0;
    std::size_t load = 0;
    [[nodiscard]] Eigen::Index lines() const {
      return static_cast<Eigen::Index>(relative_std.size());
    }
  };
  [[nodiscard]] std::vector<FrfRows> frf_rows(const std::vector<UpdateMatch>& matches) const;
  [[nodiscard]] Eigen::Index frf_lines() const;
  /// Residuals of FRF lines that share their noise with others, and say nothing of their own.
  [[nodiscard]] double shared_residuals() const;
  /// Rms of |ln(H_model / H_measured)| over the fitted lines of the states that take part (or
  /// `only` that one); NaN without any or without a model.
  [[nodiscard]] double rms_log_frf_error(const Eigen::VectorXd& q, int only = -1) const;
  /// Draws every FRF anew about the model's at q, by its own relative uncertainty times `spread`.
  [[nodiscard]] bool redraw_frfs(const Eigen::VectorXd& q, double spread,
                                 const std::function<double()>& normal);

 private:
  // Lines of one FRF that are fitted, with their relative uncertainty.
  struct FrfLines {
    std::vector<Eigen::Index> line;
    std::vector<double> relative_std;
    std::vector<char> difference;  // 1: residual H / H_measured - 1, else their logarithm
  };
  // A scene parameter that coordinate j moves.
  struct Move {
    Eigen::Index coordinate;
    std::string target;
    double factor;   // of the coordinate's value
    bool is_change;  // added to the scene's own, else it takes that value
  };
  // Noise of the force of a load: of every FRF by exp(-i omega delay), relative.
  struct Force {
    Eigen::Index coordinate;
    int state;
    std::size_t load;
    double std, delay_s;
  };
  // Asked of the model for fixed pairs; `plane` empty and count 0: everything.
  struct ModeNeed {
    std::optional<model::ModePlane> plane;
    int count = 0;
  };
  void add_coordinates(std::size_t parameter);
  void add_nuisance(const std::string& name);
  void add_force(int state, std::size_t load);
  [[nodiscard]] ModeNeed need_of(int state, const std::vector<UpdateMatch>* matches) const;
  [[nodiscard]] UpdateStateModes modes_asked(int state, const Eigen::VectorXd& q, bool derivatives,
                                             const ModeNeed& need) const;
  [[nodiscard]] bool damping_fitted(const MeasuredMode& mode) const;
  [[nodiscard]] bool shape_fitted(const MeasuredMode& mode) const;
  [[nodiscard]] bool counts(int state, UpdateStage stage) const;
  [[nodiscard]] std::vector<Move> moves_of(int state) const;
  [[nodiscard]] std::vector<std::string> targets_of(const std::vector<Move>& moves) const;
  [[nodiscard]] double slope(const Move& move, const Eigen::VectorXd& q) const;
  [[nodiscard]] bool fixed_scene(int state, const Eigen::VectorXd& q, model::Scene& scene,
                                 std::string& failure) const;
  /// What the state's measured frequencies are multiplied by, clocks off as q says.
  [[nodiscard]] double clock_factor(int state, const Eigen::VectorXd& q) const;
  [[nodiscard]] FrfLines lines_of(const MeasuredFrf& frf) const;
  [[nodiscard]] std::vector<FrfRows> frf_rows_of(int state) const;  // `first` left 0
  [[nodiscard]] bool frf_residuals(int state, const Eigen::VectorXd& q, Eigen::Index& row,
                                   Eigen::VectorXd& r, Eigen::MatrixXd* jacobian) const;

  std::vector<UpdateState> states_;
  std::vector<FreeParameter> free_;
  UpdateOptions options_;
  int held_out_;
  std::vector<UpdateCoordinate> coordinates_;
  Eigen::Index parameters_ = 0;
  std::vector<std::string> nuisances_;  // names, of the coordinates after the parameters'
  std::vector<std::vector<Move>> changes_, clocks_;  // by state, of the inputs
  std::vector<Force> forces_;
  bool hits_added_ = false;
  std::vector<std::set<std::string>> present_;  // parameters of each state's scene
  std::vector<bool> joint_dampers_;             // by state: in its scene, or to be found
  bool stated_ = true, damping_ = false;
  struct Shared {  // by copies too
    std::atomic<int> evaluations{0};
    std::atomic<bool> narrow{true};  // asking for the paired modes alone has not failed yet
  };
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

/// Root mean square of the relative errors of pairs that are no leakage; NaN without any.
[[nodiscard]] double rms_of_pairs(const std::vector<UpdatedPair>& pairs);

}  // namespace rigfit::ident

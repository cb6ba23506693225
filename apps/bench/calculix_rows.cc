#include "apps/bench/calculix_rows.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include "model/export/write_calculix.h"
#include "model/linear/modal_analysis.h"
#include "model/scene/scene_error.h"

namespace rigfit::apps {
namespace {
namespace fs = std::filesystem;

constexpr int kRuns = 3;        // of each deck, the quickest counts
constexpr double kNear = 0.05;  // of a frequency: farther apart they are not the same mode

bool installed(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

double child_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// A folder of its own, gone at the end.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "rigfit-ccx-XXXXXX").string();
    if (const char* made = ::mkdtemp(name.data())) path_ = made;
  }
  ~Folder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

struct Run {
  std::vector<double> hz;
  double seconds = 0;
};

Run run_of(const std::string& deck, bool processor_time) {
  Run out;
  const Folder folder;
  if (folder.path().empty()) return out;
  std::ofstream(folder.path() / "deck.inp") << deck;
  const std::string command =
      "cd '" + folder.path().string() + "' && OMP_NUM_THREADS=1 ccx deck > log 2>&1";
  const double child = child_seconds();
  const auto begin = std::chrono::steady_clock::now();
  if (std::system(command.c_str()) != 0) return out;
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  out.seconds = processor_time ? child_seconds() - child : wall.count();
  std::ifstream dat(folder.path() / "deck.dat");
  out.hz = model::calculix_frequencies({std::istreambuf_iterator<char>(dat), {}});
  return out;
}

/// Of `found`, the one nearest to each of `wanted`, each once; none where one is missing.
std::optional<Eigen::VectorXd> nearest(std::vector<double> found, const Eigen::VectorXd& wanted) {
  Eigen::VectorXd out(wanted.size());
  for (Eigen::Index i = 0; i < wanted.size(); ++i) {
    const auto best = std::min_element(found.begin(), found.end(), [&](double a, double b) {
      return std::abs(a - wanted[i]) < std::abs(b - wanted[i]);
    });
    if (best == found.end() || std::abs(*best / wanted[i] - 1) > kNear) return std::nullopt;
    out[i] = *best;
    found.erase(best);
  }
  return out;
}

double largest_difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a.array() / b.array() - 1).abs().maxCoeff();
}

}  // namespace

CalculixRows calculix_rows(const model::Scene& scene, const Eigen::VectorXd& frequency_hz,
                           const BenchBudget& budget) {
  CalculixRows out;
  if (!installed("ccx")) {
    out.note = "not compared with CalculiX: no program \"ccx\" is installed";
    return out;
  }
  const model::ModalAnalysis analysis = model::analyse_modes(scene);
  const auto hz_of = [&](int elements, double& seconds) -> std::optional<Eigen::VectorXd> {
    model::CalculixOptions options;
    options.elements_per_member = elements;
    options.frequencies = static_cast<int>(frequency_hz.size()) + 4;
    const std::string deck = model::calculix_deck(scene, analysis.equilibrium, options).text;
    Run best = run_of(deck, budget.processor_time);
    for (int run = 1; run < (budget.quick ? 1 : kRuns) && !best.hz.empty(); ++run) {
      best.seconds = std::min(best.seconds, run_of(deck, budget.processor_time).seconds);
    }
    seconds = best.seconds;
    return nearest(std::move(best.hz), frequency_hz);
  };
  try {
    std::vector<int> counts{5, 10, 20};
    if (!budget.quick) counts.push_back(40);
    double seconds = 0;
    const auto limit = hz_of(2 * counts.back(), seconds);
    if (!limit) {
      out.note = "not compared with CalculiX: it finds no such modes, or fails";
      return out;
    }
    for (const int elements : counts) {
      BenchRow row;
      row.method = "CalculiX, elements a member";
      row.segments = elements;
      const auto hz = hz_of(elements, row.wall_s);
      if (!hz) continue;
      row.relative_error = std::min(1.0, largest_difference(*hz, *limit));
      out.rows.push_back(std::move(row));
    }
    out.note = fmt::format(
        "CalculiX: errors against its own {} elements, which are {:.1e} from the limit of the "
        "segment model: its deck has rectangular sections with shear, rotary inertia and an axial "
        "stiffness that follows Green's strain",
        2 * counts.back(), largest_difference(*limit, frequency_hz));
  } catch (const model::SceneError& error) {
    out.rows.clear();
    out.note = std::string("not compared with CalculiX: ") + error.what();
  }
  return out;
}

}  // namespace rigfit::apps
